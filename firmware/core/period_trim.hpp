// Decides when a sensor's inter-measurement register is worth trimming, and to which value. A trim costs the
// sensor two or three readings (stop, write, start), so trims are rare.
//
// A period is judged after the ranges of one second, 9 to 32 of them, not once it is known well enough: so
// two nodes with the same part poll at the same times and trim to the same register value.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ready_tracker.hpp"

namespace octoskin::node {

class PeriodTrim {
  public:
    /// `configured`: the wanted period on the node's clock.
    PeriodTrim(Microseconds configured, const Policy& policy) noexcept;

    /// Sets another wanted period. What is known of the part's oscillator is kept.
    void set_configured(Microseconds configured) noexcept;

    [[nodiscard]] Microseconds configured() const noexcept { return configured_; }
    /// The period to request from the driver so that the real one comes out as configured.
    [[nodiscard]] Microseconds commanded() const noexcept;
    /// How far the real period may differ from the configured one before it is measured (again).
    [[nodiscard]] std::int32_t uncertainty_permille() const noexcept;

    /// Whether the period is judged after this many ranges since the start. This depends on no measurement,
    /// so that two nodes with the same part decide alike.
    [[nodiscard]] bool is_judged_after(std::uint32_t ranges) const noexcept;
    /// Processes a measured period. True if the sensor should now be stopped and given `commanded()`.
    [[nodiscard]] bool wants_trim(const MeasuredPeriod& measured, NodeTime now) noexcept;

    /// Whether it was refined twice: the first measurement may be off by some steps.
    [[nodiscard]] bool is_refined() const noexcept { return refinements_ > 1; }
    /// The period is too long by `walk`, and the register has steps of `step`: chooses the closest register
    /// value. Returns by how much the period will then be too long.
    [[nodiscard]] Nanoseconds refine(Nanoseconds walk, Nanoseconds step) noexcept;

    /// The deviation of `measured` from the configured period.
    [[nodiscard]] std::int32_t error_permille(Microseconds measured) const noexcept;

  private:
    const Policy& policy_;
    Microseconds configured_;
    std::int64_t scale_ppm_ = 1'000'000;  ///< commanded / configured
    bool is_oscillator_known_ = false;
    std::uint8_t trims_left_;
    std::uint8_t refinements_ = 0;  ///< saturates
    std::optional<NodeTime> last_trim_;
};

}  // namespace octoskin::node
