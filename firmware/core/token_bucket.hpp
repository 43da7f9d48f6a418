// Limits a node's own frames, so that a defect cannot make it flood the bus.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/time.hpp"
#include "firmware/core/frame_budget.hpp"

namespace octoskin::node {

class TokenBucket {
  public:
    /// At most `per_second` frames a second in the long run, and `burst` at once. Starts full.
    TokenBucket(const FrameBudget& budget, NodeTime now) noexcept
        : per_second_(budget.per_second), capacity_(budget.burst * kToken), level_(capacity_), filled_(now) {}

    /// Call at least every 35 minutes.
    void refill(NodeTime now) noexcept {
        const std::int64_t us = elapsed(filled_, now).count();
        if (us <= 0) return;
        level_ = std::min<std::int64_t>(capacity_, level_ + us * per_second_);
        filled_ = now;
    }
    [[nodiscard]] bool has_token() const noexcept { return level_ >= kToken; }
    /// Whether a token would be left for the heartbeat, which goes first and must not wait for one.
    [[nodiscard]] bool has_spare_token() const noexcept { return level_ >= 2 * kToken; }
    /// Only while `has_token()`.
    void take() noexcept { level_ -= kToken; }
    /// The time until there is a spare token.
    [[nodiscard]] Microseconds wait() const noexcept {
        if (has_spare_token()) return Microseconds{0};
        return Microseconds{(2 * kToken - level_ + per_second_ - 1) / per_second_};
    }

  private:
    static constexpr std::int64_t kToken = 1'000'000;  ///< per_second tokens a second = 1 unit a us each

    std::int64_t per_second_;
    std::int64_t capacity_;
    std::int64_t level_;
    NodeTime filled_;
};

}  // namespace octoskin::node
