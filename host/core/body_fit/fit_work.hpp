// A bound of the work of one fit, the same on each machine.
#pragma once

#include <cstdint>

namespace octoskin {

/// Counts steps: a node of the tree or a triangle that a distance looks at, a point that is tried, a piece of
/// the proof. One takes about 40 ns.
class FitWork {
  public:
    static constexpr std::uint64_t kMost = 200'000'000;

    /// False once there were too many: the caller ends early, and its result is of no use.
    bool spend(std::uint64_t steps) noexcept {
        used_ += steps;
        return used_ <= kMost;
    }
    void spend_all() noexcept { used_ = kMost + 1; }
    [[nodiscard]] bool is_spent() const noexcept { return used_ > kMost; }
    [[nodiscard]] std::uint64_t used() const noexcept { return used_; }

  private:
    std::uint64_t used_ = 0;
};

}  // namespace octoskin
