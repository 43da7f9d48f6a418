// Differences that the read-back of a node's sensors ignores: registers that the rig excludes, and values
// that several of its sensors read alike although another value was written.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/config/verified_registers.hpp"
#include "firmware/drivers/vl53l1x/registers.hpp"

namespace octoskin::vl53l1x {

/// The compared bits of a register. Excluded: the VHV start value, which the sensor changes during its search
/// (0x0B bits 6:0), and unused bits of the pad registers (full API, register_structs.h).
[[nodiscard]] constexpr std::uint8_t compared_bits(reg::Index index) noexcept {
    switch (index) {
        case reg::VHV_CONFIG_INIT:
            return 0x80;
        case reg::PAD_I2C_HV_EXTSUP_CONFIG:
            return 0x01;
        case reg::GPIO_HV_PAD_CTRL:
            return 0x03;
        case reg::GPIO_HV_MUX_CTRL:
            return 0x1F;
        default:
            return 0xFF;
    }
}

struct RegisterDifference {
    reg::Index index = 0;
    std::uint8_t expected = 0;
    std::uint8_t found = 0;
    friend constexpr bool operator==(const RegisterDifference&, const RegisterDifference&) = default;
};

/// True if the same register reads the same value in its compared bits, whatever was written.
[[nodiscard]] constexpr bool is_alike(const RegisterDifference& a, const RegisterDifference& b) noexcept {
    return a.index == b.index && ((a.found ^ b.found) & compared_bits(a.index)) == 0;
}

/// One object for all sensors of a node.
class Verification {
  public:
    static constexpr std::size_t kAlikeMax = 32;

    /// Disables the read-back.
    constexpr void switch_off() noexcept { is_on_ = false; }
    [[nodiscard]] constexpr bool is_on() const noexcept { return is_on_; }
    /// Ignores any difference of this register. No effect on a register that is not read back.
    void leave_out(reg::Index index) noexcept {
        if (index < is_left_out_.size()) is_left_out_.set(index);
    }
    /// Records a difference that several sensors share: it is a property of this type of sensor. False if it
    /// is already known, or if there is no room.
    bool learn(const RegisterDifference& difference) noexcept {
        if (is_known_alike(difference) || alike_count_ == kAlikeMax) return false;
        alike_[alike_count_++] = difference;
        return true;
    }
    [[nodiscard]] std::span<const RegisterDifference> alike() const noexcept {
        return std::span(alike_).first(alike_count_);
    }
    [[nodiscard]] bool overlooks(const RegisterDifference& difference) const noexcept {
        const bool is_left_out = difference.index < is_left_out_.size() && is_left_out_[difference.index];
        return is_left_out || is_known_alike(difference);
    }

  private:
    [[nodiscard]] bool is_known_alike(const RegisterDifference& difference) const noexcept {
        return std::ranges::any_of(
            alike(), [&](const RegisterDifference& known) { return vl53l1x::is_alike(known, difference); });
    }

    bool is_on_ = true;
    std::bitset<kVerifiedRegisterMax + 1> is_left_out_;
    std::array<RegisterDifference, kAlikeMax> alike_{};
    std::uint8_t alike_count_ = 0;
};

/// Ignores no difference.
inline const Verification kWholeVerification{};

}  // namespace octoskin::vl53l1x
