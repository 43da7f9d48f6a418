#include "host/lab/study/configurations.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

namespace octoskin {
namespace {

/// Checks that a configuration's name is unique and that its figures can be compared with those before it.
Status<AppError> check_next(const std::vector<NamedMapping>& before, const NamedMapping& next) {
    for (const NamedMapping& one : before) {
        if (one.name == next.name)
            return fail(ExitCode::usage, {.code = ErrorCode::duplicate,
                                          .what = "expected each configuration once",
                                          .value = fmt::format("'{}' again", next.name),
                                          .key = "--configurations"});
        if (one.mapping.map.resolution_m != next.mapping.map.resolution_m) {
            return fail(ExitCode::usage,
                        {.code = ErrorCode::conflict,
                         .what = fmt::format(
                             "the figures of '{}' and '{}' cannot be compared: expected voxels of one "
                             "size",
                             one.name, next.name),
                         .value = fmt::format("{} m and {} m", one.mapping.map.resolution_m,
                                              next.mapping.map.resolution_m),
                         .remedy = "run one at a time",
                         .key = "--configurations"});
        }
    }
    return Done{};
}

}  // namespace

Result<std::vector<NamedMapping>, AppError> find_configurations(const std::vector<std::string>& names) {
    std::vector<NamedMapping> found;
    for (const std::string& name : names) {
        auto configuration = named_mapping(name);
        if (!configuration) return unexpected(configuration.error());
        if (const auto checked = check_next(found, *configuration); !checked)
            return unexpected(checked.error());
        found.push_back(std::move(*configuration));
    }
    return found;
}

Status<AppError> check_seeds(const std::vector<std::uint64_t>& seeds) {
    std::set<std::uint64_t> seen;
    for (const std::uint64_t seed : seeds) {
        if (!seen.insert(seed).second)
            return fail(ExitCode::usage, {.code = ErrorCode::duplicate,
                                          .what = "expected each seed once",
                                          .value = fmt::format("{} again", seed),
                                          .key = "--seeds"});
    }
    return Done{};
}

}  // namespace octoskin
