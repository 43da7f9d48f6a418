// The configurations and seeds of a study, as its command names them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// In this order. Errors: those of named_mapping(); a name that occurs twice, or voxels of different sizes,
/// whose figures cannot be compared (usage, key --configurations).
[[nodiscard]] Result<std::vector<NamedMapping>, AppError> find_configurations(
    const std::vector<std::string>& names);

/// Error: a seed occurs twice (usage, key --seeds).
[[nodiscard]] Status<AppError> check_seeds(const std::vector<std::uint64_t>& seeds);

}  // namespace octoskin
