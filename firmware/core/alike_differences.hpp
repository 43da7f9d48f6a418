// If several parts of a node read back the same value although another was written, this is a property of the
// type of part: no reading is withheld for it. A value that only one part reads back is a fault of that part.
//
// Parts that had failed for such a difference are brought up again at once, and parts that were withheld
// range at once. A fleet whose parts all differ has its first readings 0.65 s after the start instead of 0.32
// s.
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
    /// Three parts with the same accidental difference, each at three attempts in a row, are not to be
    /// expected.
    static constexpr std::uint8_t kPartsMin = 3;

    struct CommonDifference {
        vl53l1x::RegisterDifference difference;  ///< as the first of the parts shows it
        std::uint8_t parts = 0;                  ///< number of parts that had shown it when it was recognised
    };

    /// Both must outlive this object.
    AlikeDifferences(vl53l1x::Verification& verification,
                     std::span<const std::optional<Sensor>> sensors) noexcept
        : verification_(verification), sensors_(sensors) {}

    /// Looks for differences that `kPartsMin` parts share. Returns at once if no part has a new one, else
    /// O(parts * parts) with at most 16 differences of each. True if the verification overlooks more than
    /// before: the caller then notifies each sensor.
    [[nodiscard]] bool update() noexcept;
    [[nodiscard]] std::span<const CommonDifference> learnt() const noexcept {
        return std::span(learnt_).first(learnt_count_);
    }

  private:
    [[nodiscard]] bool learn_any(std::span<const vl53l1x::RegisterDifference> differences) noexcept;
    [[nodiscard]] std::uint8_t parts_with(const vl53l1x::RegisterDifference& difference) const noexcept;

    vl53l1x::Verification& verification_;
    std::span<const std::optional<Sensor>> sensors_;
    std::uint32_t seen_ = 0;  ///< lasting differences of all parts at the last look
    std::array<CommonDifference, vl53l1x::Verification::kAlikeMax> learnt_{};
    std::uint8_t learnt_count_ = 0;
};

}  // namespace octoskin::node
