// How many frames a node may send: at most twice its nominal rate in any second, the limit above which a host
// takes a node for a babbling one. What its REFLEXes may need of that is theirs alone: neither do they wait
// for a token of the rest, nor the heartbeat for one that they took.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"

namespace octoskin::node {

struct FrameBudget {
    std::uint32_t per_second = 0;
    std::uint32_t burst = 0;
    friend constexpr bool operator==(const FrameBudget&, const FrameBudget&) = default;
};

/// `burst + per_second` of both is twice the nominal rate.
struct FrameBudgets {
    FrameBudget reflex;
    FrameBudget others;
};

/// A reading counts as one frame, shared or not.
[[nodiscard]] FrameBudgets frame_budgets(const NodeConfig& config) noexcept;

}  // namespace octoskin::node
