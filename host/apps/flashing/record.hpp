// What was flashed to which board, for whoever asks later.
#pragma once

#include <optional>
#include <string>

#include "host/apps/flashing/flashing.hpp"

namespace octoskin::flashing {

inline constexpr const char* kRecordFile = "record.yaml";

/// As YAML. `programmed`: empty if nothing was.
[[nodiscard]] std::string record(const Order& order, const Prepared& prepared,
                                 const std::optional<Programmed>& programmed);

}  // namespace octoskin::flashing
