// How many frames a node may send: at most twice its nominal rate in any second, the limit above which a host
// takes a node for a babbling one.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"

namespace octoskin::node {

struct FrameBudget {
    std::uint32_t per_second = 0;
    std::uint32_t burst = 0;  ///< `burst + per_second` is twice the nominal rate
};

/// A reading counts as one frame, shared or not.
[[nodiscard]] FrameBudget frame_budget(const NodeConfig& config) noexcept;

}  // namespace octoskin::node
