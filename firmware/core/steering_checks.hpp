// When to read back which of the registers that scale, steer or time a sensor's ranges, and how many readings
// have been accepted since those registers were last correct.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/core/policy.hpp"
#include "firmware/drivers/vl53l1x/read_back.hpp"

namespace octoskin::node {

/// The groups take turns, so that each reading costs about the same: 51 bits on the bus on average.
class SteeringChecks {
  public:
    explicit SteeringChecks(const Policy& policy) noexcept : policy_(policy) {}

    /// The whole configuration was just read back and is correct.
    void restart() noexcept {
        readings_.fill(0);
        readings_since_check_ = 0;
    }
    /// Another result was accepted.
    void on_reading() noexcept {
        for (std::uint8_t& count : readings_) ++count;
        ++readings_since_check_;
    }
    [[nodiscard]] bool is_due() const noexcept {
        return readings_since_check_ >= policy_.readings_per_steering_check;
    }
    /// The group to read back next.
    [[nodiscard]] std::size_t group() const noexcept { return group_; }
    /// It was correct.
    void on_clean() noexcept {
        readings_[group_] = 0;
        readings_since_check_ = 0;
        group_ = (group_ + 1) % readings_.size();
    }
    /// Readings since that group was last correct.
    [[nodiscard]] std::uint32_t suspects() const noexcept { return readings_[group_]; }

  private:
    const Policy& policy_;
    std::size_t group_ = 0;
    std::array<std::uint8_t, vl53l1x::kSteeringGroups> readings_{};
    std::uint8_t readings_since_check_ = 0;
};

}  // namespace octoskin::node
