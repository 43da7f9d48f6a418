// What a counter of the account means.
#pragma once

#include <span>

#include "host/apps/monitor/meaning.hpp"

namespace octoskin {

/// Of every unit, each a group; units and names are as AccountTable has them. docs/account.md has the same
/// table.
[[nodiscard]] std::span<const Meaning> counter_meanings() noexcept;

}  // namespace octoskin
