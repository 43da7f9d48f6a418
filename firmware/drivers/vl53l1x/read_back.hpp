// Whether the configuration in the sensor is still the one that was written: what each register should hold,
// which of its bits count, and which registers count no more. I2C has no checksum: a byte may be lost or
// altered on its way, or later.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/drivers/vl53l1x/registers.hpp"

namespace octoskin::vl53l1x {

/// Registers that are read back in one transfer.
struct RegisterRun {
    reg::Index first = 0;
    std::uint8_t count = 0;  ///< at most `kRunBytesMax`
};
/// All that the driver configures. Not in it: 0x31 and 0x32 (levels of pins), 0x86 and 0x87 (orders). The
/// first three scale, steer or time the range: offset; time-outs, VCSEL periods, limits, valid phase and
/// inter-measurement period; windows, initial phases, region of interest, sequence.
inline constexpr std::size_t kSteeringGroups = 3;
/// The one of them with the period in it.
inline constexpr std::size_t kTimingGroup = 1;
/// The one whose values are the factory's, unless the configuration has an offset.
inline constexpr std::size_t kFactoryGroup = 0;
inline constexpr std::size_t kRunBytesMax = 18;
inline constexpr std::array<RegisterRun, 10> kRegisterRuns{{{0x1E, 6},
                                                            {0x5E, 18},
                                                            {0x78, 14},
                                                            {0x08, 4},
                                                            {0x16, 6},
                                                            {0x2D, 4},
                                                            {0x33, 16},
                                                            {0x43, 16},
                                                            {0x53, 11},
                                                            {0x70, 8}}};
inline constexpr RegisterRun kFactoryRun = kRegisterRuns[kFactoryGroup];
inline constexpr std::size_t kRegistersReadBack = 103;

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

/// What of the distance mode, the choice of SPADs and the range's scale lies outside the steering groups:
/// the pulse width's offset, the least range that is told, where and how wide the pulse is, the phase
/// calibration's time-out, how SPADs are chosen, the range's fraction, the crosstalk of each quadrant.
inline constexpr std::array<reg::Index, 8> kOthersThatDecideRange{0x34, 0x3F, 0x47, 0x4A,
                                                                  0x4B, 0x4F, 0x70, 0x76};

/// Whether a register decides where or when the sensor looks, or what its range means: a reading under a
/// wrong one is a wrong range. The steering groups, the crosstalk, and the others above.
[[nodiscard]] constexpr bool decides_range(reg::Index index) noexcept {
    for (std::size_t group = 0; group < kSteeringGroups; ++group) {
        const RegisterRun& run = kRegisterRuns[group];
        if (index >= run.first && index < run.first + run.count) return true;
    }
    const bool is_crosstalk = index >= reg::ALGO_CROSSTALK_COMPENSATION_PLANE_OFFSET_KCPS &&
                              index <= reg::ALGO_CROSSTALK_COMPENSATION_Y_PLANE_GRADIENT_KCPS + 1;
    return is_crosstalk || std::find(kOthersThatDecideRange.begin(), kOthersThatDecideRange.end(), index) !=
                               kOthersThatDecideRange.end();
}

struct RegisterDifference {
    reg::Index index = 0;
    std::uint8_t expected = 0;
    std::uint8_t found = 0;
    friend constexpr bool operator==(const RegisterDifference&, const RegisterDifference&) = default;
};

/// Every difference has the sensor initialised again. One that is there again, the same, after two such
/// attempts is how this part is, and is named. If the register decides the range, the part is *distrusted*:
/// each difference goes on counting, and no reading of it may be used until it has been right for long. Any
/// other register counts no more: at most `kExemptMax` of a part, for one that would need more is broken.
class ReadBack {
  public:
    static constexpr std::uint8_t kSightingsUntilFixed = 3;
    static constexpr std::uint8_t kExemptMax = 8;
    /// So many checks of the steering registers without any difference, and those seen before were accidents:
    /// the part is trusted again.
    static constexpr std::uint8_t kCleanChecksUntilForgotten = 100;

    /// The sensor starts afresh: nothing is known of its registers. Differences seen are remembered.
    void forget() noexcept { is_known_.reset(); }
    /// Written, and acknowledged. Registers that are not read back are passed over.
    void note(reg::Index first, std::span<const std::uint8_t> bytes) noexcept;
    /// What was read of a run, for registers never written: the factory's values.
    void learn(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;

    /// No register that counts differs.
    [[nodiscard]] bool agrees(const RegisterRun& run, std::span<const std::uint8_t> bytes) const noexcept;
    /// Records each difference. Returns whether any of them still counts.
    [[nodiscard]] bool record(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;
    /// A group of steering registers was as it should be.
    void on_clean_check() noexcept;

    /// The last one recorded; empty if there was none ever.
    [[nodiscard]] const std::optional<RegisterDifference>& last_difference() const noexcept { return last_; }
    /// Registers that count no more.
    [[nodiscard]] std::uint8_t exempt_count() const noexcept {
        return static_cast<std::uint8_t>(is_exempt_.count());
    }
    /// A register that decides the range would not take its value.
    [[nodiscard]] bool is_distrusted() const noexcept { return distrusted_.has_value(); }
    /// A register that will not take its value: the one that the part is distrusted for, else the one that
    /// was exempted last.
    [[nodiscard]] const std::optional<RegisterDifference>& fixed_register() const noexcept {
        return distrusted_ ? distrusted_ : last_exempt_;
    }

  private:
    struct Sighting {
        RegisterDifference difference;
        std::uint8_t count = 0;  ///< 0: free
    };

    [[nodiscard]] bool differs(std::size_t slot, reg::Index index, std::uint8_t found) const noexcept;
    [[nodiscard]] bool is_third_sighting(const RegisterDifference& difference) noexcept;

    std::array<std::uint8_t, kRegistersReadBack> expected_{};
    std::bitset<kRegistersReadBack> is_known_;
    std::bitset<kRegistersReadBack> is_exempt_;
    std::array<Sighting, kExemptMax> sightings_{};
    std::uint8_t clean_checks_ = 0;
    std::optional<RegisterDifference> last_;
    std::optional<RegisterDifference> last_exempt_;
    std::optional<RegisterDifference> distrusted_;
};

}  // namespace octoskin::vl53l1x
