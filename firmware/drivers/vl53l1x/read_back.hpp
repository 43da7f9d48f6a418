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

#include "common/config/verified_registers.hpp"
#include "firmware/drivers/vl53l1x/registers.hpp"
#include "firmware/drivers/vl53l1x/verification.hpp"

namespace octoskin::vl53l1x {

using octoskin::kRegisterRuns;
using octoskin::RegisterRun;
/// The first so many of `kRegisterRuns` steer the range.
inline constexpr std::size_t kSteeringGroups = 3;
/// The one of them with the period in it.
inline constexpr std::size_t kTimingGroup = 1;
/// The one whose values are the factory's, unless the configuration has an offset.
inline constexpr std::size_t kFactoryGroup = 0;
inline constexpr std::size_t kRunBytesMax = 18;  ///< of one transfer
/// Centre and size of the region of interest: what a zone's write alters.
inline constexpr RegisterRun kZoneRun{reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, 2};
inline constexpr RegisterRun kFactoryRun = kRegisterRuns[kFactoryGroup];
inline constexpr std::size_t kRegistersReadBack = 103;

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

/// The differences of a part that are there to stay; few, or the part is broken.
class LastingDifferences {
  public:
    static constexpr std::uint8_t kMax = 8;

    [[nodiscard]] bool is_full() const noexcept { return count_ == kMax; }
    [[nodiscard]] std::span<const RegisterDifference> all() const noexcept {
        return std::span(all_).first(count_);
    }
    /// In place of what was there of that register. Not if it is full.
    void note(const RegisterDifference& difference) noexcept;
    void forget_overlooked(const Verification& verification) noexcept;
    void clear() noexcept { count_ = 0; }

  private:
    std::array<RegisterDifference, kMax> all_{};
    std::uint8_t count_ = 0;
};

/// Every difference has the sensor initialised again. One that is there again, the same, after two such
/// attempts is how this part is, and is named. If the register decides the range, the part is *distrusted*:
/// each difference goes on counting, and no reading of it may be used until it has been right for long. Any
/// other register counts no more: at most `LastingDifferences::kMax` of a part, for one that would need more
/// is broken. What the verification overlooks is no difference at all.
class ReadBack {
  public:
    static constexpr std::uint8_t kSightingsUntilFixed = 3;
    static constexpr std::uint8_t kExemptMax = LastingDifferences::kMax;
    /// So many checks of the steering registers without any difference, and those seen before were accidents:
    /// the part is trusted again.
    static constexpr std::uint8_t kCleanChecksUntilForgotten = 100;

    /// `verification` must outlive it.
    explicit ReadBack(const Verification& verification = kWholeVerification) noexcept
        : verification_(verification) {}

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
    /// The same of a write that was only just made: one that was lost says nothing about the part, so it is
    /// no sighting.
    [[nodiscard]] bool record_of_write(const RegisterRun& run, std::span<const std::uint8_t> bytes) noexcept;
    /// A group of steering registers was as it should be.
    void on_clean_check() noexcept;
    /// The verification overlooks more than before: what of it was a difference of this part is none any
    /// more. A part that was distrusted for nothing else is trusted at once.
    void forget_overlooked() noexcept;

    /// The last one recorded; empty if there was none ever.
    [[nodiscard]] const std::optional<RegisterDifference>& last_difference() const noexcept { return last_; }
    /// Registers that count no more.
    [[nodiscard]] std::uint8_t exempt_count() const noexcept {
        return static_cast<std::uint8_t>(exempt_.all().size());
    }
    /// A register that decides the range would not take its value.
    [[nodiscard]] bool is_distrusted() const noexcept { return !deciding_.all().empty(); }
    /// Of registers that decide the range, and of the others.
    [[nodiscard]] std::span<const RegisterDifference> deciding_differences() const noexcept {
        return deciding_.all();
    }
    [[nodiscard]] std::span<const RegisterDifference> exempt_differences() const noexcept {
        return exempt_.all();
    }
    /// How often a difference turned out to be there to stay: another number, and there is news.
    [[nodiscard]] std::uint8_t lasting_count() const noexcept { return lasting_count_; }
    /// A register that will not take its value: the first that the part is distrusted for, else the one that
    /// was exempted last; empty if there is none.
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
