// What a key of `octoskin status --json` means.
#pragma once

#include <span>

#include "host/apps/monitor/meaning.hpp"

namespace octoskin {

/// Of every key; a group is the path of the object that has it ("nodes.sensors": of each sensor of each
/// node), empty at the top. docs/status.md has the same tables.
[[nodiscard]] std::span<const Meaning> status_meanings() noexcept;

}  // namespace octoskin
