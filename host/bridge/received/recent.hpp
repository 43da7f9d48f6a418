// What counters gained lately: a problem is what happens now, not what happened once.
#pragma once

#include <cstdint>
#include <deque>
#include <utility>

#include "common/time.hpp"

namespace octoskin::bridge {

template <class Counts>
class Recent {
  public:
    static constexpr Nanoseconds kWindow{5'000'000'000};

    /// Call it about twice a second.
    void note(const Counts& counts, HostTime now) {
        kept_.emplace_back(now, counts);
        while (kept_.size() > 2 && now - kept_[1].first >= kWindow) kept_.pop_front();
    }
    /// How much a counter gained within the window, up to the newest note.
    [[nodiscard]] std::uint64_t gained(std::uint64_t Counts::*counter) const {
        return kept_.empty() ? 0 : kept_.back().second.*counter - kept_.front().second.*counter;
    }
    /// True once there are notes of a whole window.
    [[nodiscard]] bool is_full() const {
        return !kept_.empty() && kept_.back().first - kept_.front().first >= kWindow;
    }

  private:
    std::deque<std::pair<HostTime, Counts>> kept_;
};

}  // namespace octoskin::bridge
