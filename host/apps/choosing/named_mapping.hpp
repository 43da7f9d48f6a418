// How measurements become voxels, as a person names it: one that ships, or a file.
#pragma once

#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// What metrics.json has beside the configurations.
inline constexpr std::string_view kReservedName = "run";

struct NamedMapping {
    std::string name;  ///< of a file: its name without folder and extension
    MappingConfig mapping;
    bool is_depth_noise_free = false;  ///< which of the two recordings the experiment makes it from
};

/// One of kBuiltInMappings (host/io/mapping), or the path of a YAML file. Errors: neither (no_input, with the
/// name that was meant, if one is like it); a file with a mistake (bad_config); a file
/// called as metrics.json calls something else (usage).
[[nodiscard]] Result<NamedMapping, AppError> named_mapping(const std::string& name_or_file);
/// A file, as a recording has one, named after it.
[[nodiscard]] Result<NamedMapping, AppError> mapping_of_file(const FilePlace& file);

}  // namespace octoskin
