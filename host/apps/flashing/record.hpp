// The record of what was flashed to which board.
#pragma once

#include <optional>
#include <string>

#include "host/apps/flashing/flashing.hpp"

namespace octoskin::flashing {

inline constexpr const char* kRecordFile = "record.yaml";

/// The record as YAML. `programmed` is empty if the board was not programmed.
[[nodiscard]] std::string record(const Order& order, const Prepared& prepared,
                                 const std::optional<Programmed>& programmed);

}  // namespace octoskin::flashing
