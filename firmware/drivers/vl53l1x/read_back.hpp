// Checks that the sensor still holds the written configuration: expected register values, the compared bits,
// and the registers exempt from comparison. I2C has no checksum: a byte may be lost or altered during a
// transfer or later.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/config/verified_registers.hpp"
#include "firmware/drivers/vl53l1x/registers.hpp"
#include "firmware/drivers/vl53l1x/verification.hpp"

namespace octoskin::vl53l1x {

using octoskin::kRegisterRuns;
using octoskin::RegisterRun;
/// The first `kSteeringGroups` of `kRegisterRuns` steer the range.
inline constexpr std::size_t kSteeringGroups = 3;
/// The steering group that contains the period.
inline constexpr std::size_t kTimingGroup = 1;
/// The steering group with the factory's values, unless the configuration has an offset.
inline constexpr std::size_t kFactoryGroup = 0;
inline constexpr std::size_t kRunBytesMax = 18;  ///< per transfer
/// Centre and size of the region of interest: the registers that a zone's write changes.
inline constexpr RegisterRun kZoneRun{reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, 2};
inline constexpr RegisterRun kFactoryRun = kRegisterRuns[kFactoryGroup];
inline constexpr std::size_t kRegistersReadBack = 103;

/// Registers outside the steering groups that affect distance mode, SPAD selection and range scale: pulse
/// width offset, smallest reported range, pulse position and width, phase calibration time-out, SPAD
/// selection mode, fraction of the range, crosstalk per quadrant.
inline constexpr std::array<reg::Index, 8> kOthersThatDecideRange{0x34, 0x3F, 0x47, 0x4A,
                                                                  0x4B, 0x4F, 0x70, 0x76};

/// Whether a register decides where or when the sensor measures, or how its range is scaled. With a wrong
/// value in such a register, every range is wrong. These are the steering groups, the crosstalk, and the
/// registers above.
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

/// The persistent differences of one sensor. A sensor with more than `kMax` is broken.
class LastingDifferences {
  public:
    static constexpr std::uint8_t kMax = 8;

    [[nodiscard]] bool is_full() const noexcept { return count_ == kMax; }
    [[nodiscard]] std::span<const RegisterDifference> all() const noexcept {
        return std::span(all_).first(count_);
    }
    /// Replaces an earlier difference of the same register. A new register is ignored if the list is full.
    void note(const RegisterDifference& difference) noexcept;
    void forget_overlooked(const Verification& verification) noexcept;
    void clear() noexcept { count_ = 0; }

  private:
    std::array<RegisterDifference, kMax> all_{};
    std::uint8_t count_ = 0;
};

/// Every difference makes the node initialise the sensor again. A difference that returns unchanged after two
/// such attempts is persistent, and is reported. If the register decides the range, the sensor is
/// *distrusted*: the difference still counts, and its readings must not be used until the register has been
/// right for a long time. Any other register is exempted from comparison, at most `LastingDifferences::kMax`
/// per sensor: a sensor with more is broken. A difference that the verification ignores is not counted at
/// all.
class ReadBack {
  public:
    static constexpr std::uint8_t kSightingsUntilFixed = 3;
    static constexpr std::uint8_t kExemptMax = LastingDifferences::kMax;
    /// After this many checks of the steering registers without a difference, earlier differences count as
    /// accidents and the sensor is trusted again.
    static constexpr std::uint8_t kCleanChecksUntilForgotten = 100;

    /// `verification` must outlive this object.
    explicit ReadBack(const Verification& verification = kWholeVerification) noexcept
        : verification_(verification) {}

    /// The sensor was reset: no register value is known. Recorded differences are kept.
    void forget() noexcept { is_known_.reset(); }
    /// Records a write that was acknowledged. Registers that are not read back are ignored.
    void note(reg::Index first, std::span<const std::uint8_t> bytes) noexcept;
    /// Records values read from a run, for registers never written: the factory's values.
    void learn(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;

    /// True if no compared register differs.
    [[nodiscard]] bool agrees(const RegisterRun& run, std::span<const std::uint8_t> bytes) const noexcept;
    /// Records each difference. Returns whether any of them still counts.
    [[nodiscard]] bool record(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;
    /// As `record`, for a write that was just made. A lost write is no property of the sensor, so it is not
    /// counted towards a persistent difference.
    [[nodiscard]] bool record_of_write(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;
    /// A group of steering registers had its expected values.
    void on_clean_check() noexcept;
    /// The verification was extended: removes the differences that it now ignores. A sensor without other
    /// differences is trusted again at once.
    void forget_overlooked() noexcept;

    /// The last recorded difference; empty if there was none.
    [[nodiscard]] const std::optional<RegisterDifference>& last_difference() const noexcept { return last_; }
    /// Number of exempt registers.
    [[nodiscard]] std::uint8_t exempt_count() const noexcept {
        return static_cast<std::uint8_t>(exempt_.all().size());
    }
    /// A register that decides the range does not take its value.
    [[nodiscard]] bool is_distrusted() const noexcept { return !deciding_.all().empty(); }
    /// Persistent differences of registers that decide the range, and of the others.
    [[nodiscard]] std::span<const RegisterDifference> deciding_differences() const noexcept {
        return deciding_.all();
    }
    [[nodiscard]] std::span<const RegisterDifference> exempt_differences() const noexcept {
        return exempt_.all();
    }
    /// Number of persistent differences found so far: a change means a new one.
    [[nodiscard]] std::uint8_t lasting_count() const noexcept { return lasting_count_; }
    /// A register that does not take its value: the first one that the sensor is distrusted for, else the one
    /// exempted last; empty if there is none.
    [[nodiscard]] std::optional<RegisterDifference> fixed_register() const noexcept;

  private:
    struct Sighting {
        RegisterDifference difference;
        std::uint8_t count = 0;  ///< 0: free
    };

    [[nodiscard]] bool differs(std::size_t slot, reg::Index index, std::uint8_t found) const noexcept;
    [[nodiscard]] bool is_third_sighting(const RegisterDifference& difference) noexcept;
    [[nodiscard]] bool is_exempted(std::size_t slot, const RegisterDifference& difference) noexcept;

    const Verification& verification_;
    std::array<std::uint8_t, kRegistersReadBack> expected_{};
    std::bitset<kRegistersReadBack> is_known_;
    std::bitset<kRegistersReadBack> is_exempt_;
    std::array<Sighting, kExemptMax> sightings_{};
    std::uint8_t clean_checks_ = 0;
    std::uint8_t lasting_count_ = 0;
    std::optional<RegisterDifference> last_;
    LastingDifferences deciding_;
    LastingDifferences exempt_;
};

}  // namespace octoskin::vl53l1x
