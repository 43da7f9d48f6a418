// How many frames a node may send: in any second at most twice its nominal rate, the limit above which a host
// treats a node as babbling. The REFLEX frames have a share of their own: they do not wait for a token of
// other frames, and the heartbeat does not wait because of them.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"

namespace octoskin::node {

struct FrameBudget {
    std::uint32_t per_second = 0;
    std::uint32_t burst = 0;
    friend constexpr bool operator==(const FrameBudget&, const FrameBudget&) = default;
};

/// `burst + per_second` of both budgets is twice the nominal rate.
struct FrameBudgets {
    FrameBudget reflex;
    FrameBudget others;
};

/// A reading counts as one frame, even if it shares one.
[[nodiscard]] FrameBudgets frame_budgets(const NodeConfig& config) noexcept;

}  // namespace octoskin::node
