// The address 0x29, at which a sensor answers after reset, and which sensor may use it. Two sensors there at
// once would both take the same new address. So one at a time uses it, and all others wait.
//
// A device found there unexpectedly, because its XSHUT line does not put it in reset or is not driven, is
// *parked*: it is given an address that no sensor of the bus has, where it disturbs none.
#pragma once

#include <array>
#include <cstdint>

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

    /// For checking that no device answers where none should, and for parking; only for the holder.
    [[nodiscard]] vl53l1x::Device& watcher() noexcept { return watcher_; }

    /// Reserves `address` for a sensor of this bus. Call for all sensors before the first bring-up.
    void reserve(i2c::Address address) noexcept { is_taken_[address] = true; }
    /// The highest device address of I2C that is reserved for no sensor of this bus.
    [[nodiscard]] i2c::Address parking() const noexcept {
        i2c::Address address = kAddressLast;
        while (is_taken_[address]) --address;  // a bus has fewer sensors than addresses
        return address;
    }

    /// An unidentified device was parked from 0x29. The count shows which sensors have answered since, and so
    /// are not that device.
    void note_parked() noexcept { ++parkings_, is_parked_ = true; }
    /// No device answers at the parking address any more.
    void forget_parked() noexcept { is_parked_ = false; }
    [[nodiscard]] bool is_any_parked() const noexcept { return is_parked_; }
    [[nodiscard]] std::uint32_t parkings() const noexcept { return parkings_; }

  private:
    static constexpr i2c::Address kAddressLast = 0x77;

    vl53l1x::Device watcher_;
    const void* holder_ = nullptr;
    std::array<bool, kAddressLast + 1> is_taken_{};
    std::uint32_t parkings_ = 0;
    bool is_parked_ = false;
};

}  // namespace octoskin::node
