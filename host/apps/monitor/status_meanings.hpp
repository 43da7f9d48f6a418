// What a key of `octoskin status --json` means.
#pragma once

#include <span>
#include <string_view>

#include "host/apps/monitor/meaning.hpp"

namespace octoskin {

/// Of every key; a group is the path of the object that has it ("nodes.sensors": of each sensor of each
/// node), empty at the top. docs/status.md has the same tables.
[[nodiscard]] std::span<const Meaning> status_meanings() noexcept;

/// Empty for one that is not known.
[[nodiscard]] std::string_view status_meaning_of(std::string_view group, std::string_view name) noexcept;

}  // namespace octoskin
