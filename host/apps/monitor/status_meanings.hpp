// The type, the unit and the meaning of each key of `octoskin status --json`.
#pragma once

#include <span>

#include "host/apps/monitor/meaning.hpp"

namespace octoskin {

/// All keys. The group is the path of the table with the key ("nodes.sensors": each sensor of each node),
/// empty at the top level. docs/status.md has the same tables.
[[nodiscard]] std::span<const Meaning> status_meanings() noexcept;

}  // namespace octoskin
