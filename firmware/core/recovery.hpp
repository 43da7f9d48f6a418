// What to do about a sensor that failed, and when: first a restart if it still answers, then XSHUT cycles, at
// once and then at growing intervals. It never gives up.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"

namespace octoskin::node {

enum class RecoveryStep : std::uint8_t {
    restart,      ///< stop and start ranging
    xshut_cycle,  ///< hold in reset, then bring up from the beginning
};

struct RecoveryPlan {
    RecoveryStep step = RecoveryStep::restart;
    NodeTime at;
};

class Recovery {
  public:
    explicit Recovery(const Policy& policy) noexcept : policy_(policy) {}

    /// The step after a failure at `now`. `can_restart`: the sensor answers and was ranging.
    [[nodiscard]] RecoveryPlan on_failure(bool can_restart, NodeTime now) noexcept;
    /// Whether a failure was not yet followed by enough proven readings.
    [[nodiscard]] bool is_under_way() const noexcept { return failures_ > 0; }
    /// A reading that proves that the sensor measures. After enough of them in a row the next failure counts
    /// as the first.
    void on_proven_reading() noexcept;
    /// An attempt from scratch was commanded.
    void reset() noexcept;

  private:
    [[nodiscard]] Microseconds next_backoff() noexcept;

    const Policy& policy_;
    std::uint8_t failures_ = 0;
    std::uint8_t proven_in_row_ = 0;
    Microseconds backoff_{0};
};

}  // namespace octoskin::node
