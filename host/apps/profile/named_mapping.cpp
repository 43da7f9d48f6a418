#include "host/apps/profile/named_mapping.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "host/apps/recording/permission.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/key_hint.hpp"

namespace octoskin {
namespace {

AppError absent(const std::string& name) {
    const std::vector<std::string> built_in(kBuiltInMappings.begin(), kBuiltInMappings.end());
    const auto near = rig::nearest_word(name, built_in);
    return {ExitCode::no_input,
            {.code = ErrorCode::not_found,
             .what = "expected a file or a built-in configuration, one of " + rig::joined(built_in),
             .value = "'" + name + "'",
             .remedy = near ? "did you mean " + *near + "?" : std::string(),
             .key = "configuration"}};
}

}  // namespace

Result<NamedMapping, AppError> named_mapping(const std::string& name_or_file) {
    const bool is_built_in =
        std::find(kBuiltInMappings.begin(), kBuiltInMappings.end(), name_or_file) != kBuiltInMappings.end();
    std::error_code error;
    if (auto refused = refused_to_read(name_or_file); refused && !is_built_in)
        return unexpected(std::move(*refused));
    if (!is_built_in && !std::filesystem::exists(name_or_file, error))
        return unexpected(absent(name_or_file));
    const auto mapping = read_mapping(name_or_file);
    if (!mapping) return unexpected(reading_error(ExitCode::bad_config, mapping.error()));
    const std::string name = is_built_in ? name_or_file : std::filesystem::path(name_or_file).stem().string();
    if (name == kReservedName) {
        return fail(ExitCode::usage, {.code = ErrorCode::bad_name,
                                      .what = "a configuration cannot have this name",
                                      .value = "'" + name + "'",
                                      .remedy = "rename the file",
                                      .file = name_or_file});
    }
    return NamedMapping{name, *mapping, is_built_in && name == "paper_noise_free_robot_seen"};
}

Result<NamedMapping, AppError> mapping_of_file(const FilePlace& file) {
    if (auto refused = refused_to_read(file)) return unexpected(std::move(*refused));
    auto mapping = read_mapping_file(file);
    if (!mapping) return unexpected(reading_error(ExitCode::bad_config, mapping.error()));
    return NamedMapping{std::filesystem::path(file.filename()).stem().string(), std::move(*mapping), false};
}

}  // namespace octoskin
