#include "firmware/port/linux/frames_in_flight.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin::linux_port {

void FramesInFlight::add(const wire::CanFrame& frame, NodeTime now) noexcept {
    assert(has_room());
    entries_.at(count_++) = {.frame = frame, .added = now};
}

void FramesInFlight::confirm(const wire::CanFrame& frame) noexcept {
    for (std::size_t i = given_up_; i < count_; ++i) {
        if (!(entries_.at(i).frame == frame)) continue;
        std::move(entries_.begin() + static_cast<std::ptrdiff_t>(i + 1),
                  entries_.begin() + static_cast<std::ptrdiff_t>(count_),
                  entries_.begin() + static_cast<std::ptrdiff_t>(given_up_));
        count_ -= i + 1 - given_up_;
        return;
    }
}

std::optional<NodeTime> FramesInFlight::oldest() const noexcept {
    if (count_ == given_up_) return std::nullopt;
    return entries_.at(given_up_).added;
}

std::optional<wire::CanFrame> FramesInFlight::take_given_up() noexcept {
    if (given_up_ == 0) return std::nullopt;
    const wire::CanFrame frame = entries_[0].frame;
    drop_first(1);
    --given_up_;
    return frame;
}

std::size_t FramesInFlight::forget_all() noexcept {
    const std::size_t forgotten = count_ - given_up_;
    count_ = given_up_;
    return forgotten;
}

void FramesInFlight::drop_first(std::size_t count) noexcept {
    std::move(entries_.begin() + static_cast<std::ptrdiff_t>(count),
              entries_.begin() + static_cast<std::ptrdiff_t>(count_), entries_.begin());
    count_ -= count;
}

}  // namespace octoskin::linux_port
