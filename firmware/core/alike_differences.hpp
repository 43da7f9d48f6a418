// What several parts of a node read back alike, though something else was written, is how this type of part
// is, and no reason to withhold a reading. What one part alone reads is that part's fault.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware/core/sensor.hpp"
#include "firmware/drivers/vl53l1x/verification.hpp"

namespace octoskin::node {

class AlikeDifferences {
  public:
    /// Three parts that are wrong alike by accident, each at three attempts in a row, are not to be expected.
    static constexpr std::uint8_t kPartsMin = 3;

    struct Told {
        vl53l1x::RegisterDifference difference;  ///< as the first of the parts has it
        std::uint8_t parts = 0;                  ///< that had shown it when it was learnt
    };

    /// Both outlive it.
    AlikeDifferences(vl53l1x::Verification& verification,
                     std::span<const std::optional<Sensor>> sensors) noexcept
        : verification_(verification), sensors_(sensors) {}

    /// Looks for what `kPartsMin` parts show: at once if none has anything new, else O(parts * parts) with at
    /// most 16 differences of each. True if the verification overlooks more than before: each sensor is to be
    /// told.
    [[nodiscard]] bool update() noexcept;
    [[nodiscard]] std::span<const Told> learnt() const noexcept {
        return std::span(learnt_).first(learnt_count_);
    }

  private:
    [[nodiscard]] bool learn_any(std::span<const vl53l1x::RegisterDifference> differences) noexcept;
    [[nodiscard]] std::uint8_t parts_with(const vl53l1x::RegisterDifference& difference) const noexcept;

    vl53l1x::Verification& verification_;
    std::span<const std::optional<Sensor>> sensors_;
    std::uint32_t seen_ = 0;  ///< lasting differences, of all parts, when last looked at
    std::array<Told, vl53l1x::Verification::kAlikeMax> learnt_{};
    std::uint8_t learnt_count_ = 0;
};

}  // namespace octoskin::node
