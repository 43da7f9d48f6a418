// The mapping configuration as a YAML file, or by name.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// What is wrong with a file: "my.yaml:12: depth_filter.window_px: expected an odd number, found 4".
using MappingFileError = rig::RigError;

/// The configurations that ship. `paper`: the paper's equations on noisy depth.
/// `paper_noise_free_robot_seen`: the same with the robot left in the image, which, on depth without noise,
/// is what the paper's own figures suggest it did. `fast`: depth filtered, and asked voxel by voxel;
/// `robust`: depth filtered, and each voxel voted on by all beams that come there.
inline constexpr std::array<std::string_view, 4> kBuiltInMappings{"paper", "paper_noise_free_robot_seen",
                                                                  "robust", "fast"};

/// What holds where nobody names another.
inline constexpr const char* kDefaultMapping = "fast";

/// Those that ship, by name (write ./paper for a file of that name); anything else is the path of a YAML
/// file. A file starts from the one that its key `base` names (kDefaultMapping, if it names none) and
/// overrides what it mentions; host/config/ has them written out in full. An unknown key, a value of the
/// wrong type or out of range is an error.
[[nodiscard]] Result<MappingConfig, MappingFileError> read_mapping(const std::string& name_or_file);

/// The same of a file, whatever it is called.
[[nodiscard]] Result<MappingConfig, MappingFileError> read_mapping_file(const FilePlace& file);

/// The configuration in full as YAML. Reading it back gives an equal one, and equal ones give equal text.
[[nodiscard]] std::string mapping_text(const MappingConfig& config);

}  // namespace octoskin
