// What a counter of the account means.
#pragma once

#include <span>
#include <string_view>

#include "host/apps/monitor/meaning.hpp"

namespace octoskin {

/// Of every unit, each a group: docs/account.md has the same table.
[[nodiscard]] std::span<const Meaning> counter_meanings() noexcept;

/// `unit` and `name` as AccountTable has them; empty for one that is not known.
[[nodiscard]] std::string_view meaning_of(std::string_view unit, std::string_view name) noexcept;

}  // namespace octoskin
