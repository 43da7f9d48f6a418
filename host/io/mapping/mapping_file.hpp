// The mapping profile from a YAML file or by name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The built-in configurations. `paper`: the paper's equations on noisy depth. `paper_noise_free_robot_seen`:
/// the same with the robot left in the image; on depth without noise this matches what the paper's figures
/// suggest. `fast`: depth filtered, each voxel looked up in the image. `robust`: depth filtered, each voxel
/// decided by a vote of all beams that reach it. `denoised`: depth averaged over time, any end is a hit.
inline constexpr std::array<std::string_view, 5> kBuiltInMappings{"paper", "paper_noise_free_robot_seen",
                                                                  "robust", "fast", "denoised"};

/// The configuration used if none is named.
inline constexpr const char* kDefaultMapping = "denoised";

/// `name_or_file`: a built-in name (write ./paper for a file of that name), or the path of a YAML file. A
/// file starts from the configuration in its key `base` (default: kDefaultMapping) and overrides the keys it
/// contains; host/config/ has all of them in full. Errors: an unknown key, a value of a wrong type or out of
/// range.
[[nodiscard]] Result<MappingConfig, Error> read_mapping(const std::string& name_or_file);

/// As above for a file, without built-in names.
[[nodiscard]] Result<MappingConfig, Error> read_mapping_file(const FilePlace& file);

/// The whole configuration as YAML. Reading it back gives an equal one, and equal ones give equal text.
[[nodiscard]] std::string mapping_text(const MappingConfig& config);

}  // namespace octoskin
