// The one place on a bus where a freshly reset sensor answers, 0x29, and who may use it. Two sensors there at
// once would both take the same new address, so one at a time goes through it, and all others watch.
#pragma once

#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

class DefaultAddress {
  public:
    DefaultAddress(i2c::Bus& bus, const vl53l1x::Options& options) noexcept : watcher_(bus, options) {}

    [[nodiscard]] bool is_free() const noexcept { return holder_ == nullptr; }
    [[nodiscard]] bool is_held_by(const void* who) const noexcept { return holder_ == who; }
    /// Only while free.
    void hold(const void* who) noexcept { holder_ = who; }
    void release(const void* who) noexcept {
        if (holder_ == who) holder_ = nullptr;
    }

    /// For asking whether anybody answers at 0x29; only for the holder.
    [[nodiscard]] vl53l1x::Device& watcher() noexcept { return watcher_; }

  private:
    vl53l1x::Device watcher_;
    const void* holder_ = nullptr;
};

}  // namespace octoskin::node
