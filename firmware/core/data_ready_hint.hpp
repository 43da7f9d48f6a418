// The data-ready line of one bus, used as a hint as far as it is reliable. A fall without data of any sensor
// is spurious; a line with mostly spurious falls is ignored.
//
// A faulty line costs no reading. If it is stuck or not wired, all is as without a line, to the microsecond.
// If it stops working, a poll just after the latest ready time finds each sensor's next data. If it chatters,
// it is checked every 250 us at most, and ignored after 100 falls more than real ones offset (two each). If
// one sensor holds it, its bus ranges as without a line. With a line a change of a sensor's rhythm is noticed
// some readings later. On a core that is 85 % busy hints come too late to save polls (34 sensors on the
// emulated board at three cycles an instruction: 1.9 a reading either way).
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::node {

class DataReadyHint {
  public:
    /// `lines`: null for a bus without a line, which never gives a hint. Both must outlive this object.
    DataReadyHint(DataReadyLines* lines, std::uint8_t bus, const Policy& policy) noexcept
        : lines_(lines), bus_(bus), policy_(policy) {}

    /// Whether the line fell, once for each fall; checked at most every `Policy::hint_interval`.
    [[nodiscard]] bool take(NodeTime now);
    /// A sensor that was polled because of the last hint had data.
    void confirm() noexcept;

    /// The last hint may have come from a sensor that is not read by hints.
    void excuse() noexcept { is_unconfirmed_ = false; }

    /// Too many falls were spurious: ignored until the node's next start.
    [[nodiscard]] bool is_ignored() const noexcept { return doubt_ >= policy_.hint_doubt_max; }
    /// Spurious falls since start.
    [[nodiscard]] std::uint32_t spurious_count() const noexcept { return spurious_count_; }

  private:
    DataReadyLines* lines_;
    std::uint8_t bus_;
    const Policy& policy_;
    std::optional<NodeTime> asked_again_at_;  ///< the next check, after a fall
    bool is_unconfirmed_ = false;
    std::uint16_t doubt_ = 0;  ///< grows with spurious falls, shrinks with confirmed ones
    std::uint32_t spurious_count_ = 0;
};

}  // namespace octoskin::node
