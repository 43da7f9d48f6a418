// What the read-back of a node's sensors overlooks: registers that its rig leaves out, and what its parts
// were seen to read alike although something else was written.
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

/// The bits of a register that are compared. Left out: the VHV start value, which is the sensor's own once it
/// has searched (0x0B bits 6:0), and bits without a function in the pads' registers (full API,
/// register_structs.h).
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

/// The same register reads the same, in the bits that are compared, whatever was written.
[[nodiscard]] constexpr bool is_alike(const RegisterDifference& a, const RegisterDifference& b) noexcept {
    return a.index == b.index && ((a.found ^ b.found) & compared_bits(a.index)) == 0;
}

/// One for all sensors of a node.
class Verification {
  public:
    static constexpr std::size_t kAlikeMax = 32;

    /// Nothing is read back from now on.
    constexpr void switch_off() noexcept { is_on_ = false; }
    [[nodiscard]] constexpr bool is_on() const noexcept { return is_on_; }
    /// The register may read as it likes. One that is not read back makes no difference.
    void leave_out(reg::Index index) noexcept {
        if (index < is_left_out_.size()) is_left_out_.set(index);
    }
    /// Several parts read it so: this type of part does. False if that is known, or if there is no room.
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

/// Overlooks nothing.
inline const Verification kWholeVerification{};

}  // namespace octoskin::vl53l1x
