// A histogram of durations: any percentile at any time, in bounded memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/time.hpp"

namespace octoskin {

class LatencyHistogram {
  public:
    /// Resolution of durations; those of 0.5 s and more count together.
    static constexpr Nanoseconds kStep{20'000};
    static constexpr std::size_t kSteps = 25'000;

    void add(Nanoseconds duration) noexcept {
        const auto step = static_cast<std::size_t>(std::max<std::int64_t>(duration / kStep, 0));
        ++counts_[std::min(step, kSteps - 1)];
        ++total_;
        longest_ = std::max(longest_, duration);
    }

    [[nodiscard]] std::uint64_t count() const noexcept { return total_; }
    [[nodiscard]] Nanoseconds longest() const noexcept { return longest_; }
    /// The duration that this share (0..1) did not exceed, rounded up to a step; 0 without durations. For the
    /// last step it is the longest one. O(steps).
    [[nodiscard]] Nanoseconds within(double share) const noexcept {
        const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(total_) + 0.5);
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < kSteps; ++i) {
            seen += counts_[i];
            if (seen >= wanted && seen > 0)
                return i + 1 == kSteps ? longest_ : static_cast<std::int64_t>(i + 1) * kStep;
        }
        return longest_;
    }

  private:
    std::array<std::uint64_t, kSteps> counts_{};
    std::uint64_t total_ = 0;
    Nanoseconds longest_{0};
};

}  // namespace octoskin
