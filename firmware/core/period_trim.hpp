// Decides when a sensor's inter-measurement register is worth trimming, and to what. A trim costs the sensor
// two or three readings (stop, write, start), so there are few.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ready_tracker.hpp"

namespace octoskin::node {

class PeriodTrim {
  public:
    /// `configured`: the period the sensor shall have on the node's clock.
    PeriodTrim(Microseconds configured, const Policy& policy) noexcept;

    /// Another period is wanted from now on. What is known of the part's oscillator stays.
    void set_configured(Microseconds configured) noexcept;

    [[nodiscard]] Microseconds configured() const noexcept { return configured_; }
    /// What to ask of the driver so that the real period comes out as configured.
    [[nodiscard]] Microseconds commanded() const noexcept;
    /// How far the real period may be from the configured one, before it is measured (again).
    [[nodiscard]] std::int32_t uncertainty_permille() const noexcept;

    /// Whether the period is judged after so many ranges since the start. That depends on nothing that was
    /// measured: two nodes with the same part decide the same.
    [[nodiscard]] bool is_judged_after(std::uint32_t ranges) const noexcept;
    /// Takes a measured period; true if the sensor should now be stopped and given `commanded()`.
    [[nodiscard]] bool wants_trim(const MeasuredPeriod& measured, NodeTime now) noexcept;

    /// Whether it was refined twice: its first measurement may be off by some steps.
    [[nodiscard]] bool is_refined() const noexcept { return refinements_ > 1; }
    /// The period is longer by `walk` than it should be, and the register has steps of `step`: takes the
    /// value that comes closest. Returns by how much the period will then be longer.
    [[nodiscard]] Nanoseconds refine(Nanoseconds walk, Nanoseconds step) noexcept;

    /// `measured` against the configured period.
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
