// A mapping profile by its name or its file: the rules by which measurements change voxels.
#pragma once

#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// metrics.json uses this name for an entry of its own beside the configurations.
inline constexpr std::string_view kReservedName = "run";

struct NamedMapping {
    std::string name;  ///< for a file: the file name without folder and extension
    MappingConfig mapping;
    bool is_depth_noise_free = false;  ///< selects which of the experiment's two recordings is replayed
};

/// `name_or_file`: one of kBuiltInMappings (host/io/mapping), or the path of a YAML file.
/// Errors: neither of them (no_input, with the most similar name if there is one); an invalid file
/// (bad_config); a file with the reserved name (usage).
[[nodiscard]] Result<NamedMapping, AppError> named_mapping(const std::string& name_or_file);
/// Reads a mapping file of a recording; its name is the file's name.
[[nodiscard]] Result<NamedMapping, AppError> mapping_of_file(const FilePlace& file);

}  // namespace octoskin
