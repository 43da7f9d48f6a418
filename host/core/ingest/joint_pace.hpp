// Whether a source of joint states keeps the rate that the rig says.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// Samples are told apart by a sequence of three bits. At twice the rig's rate it comes round while frames of
/// the round before are still waited for, and four frames of two rounds can look like one sample. Each whole
/// sample carries its own time, so two of them tell the pace, whatever was lost or late between them.
class JointPace {
  public:
    explicit JointPace(double rate_hz) noexcept : rate_hz_(rate_hz) {}

    /// Takes whole samples in the order in which they became whole.
    void observe(std::uint8_t sequence, const wire::TimeResidue& sampled) noexcept;

    /// False before five pairs in a row were as they should be: at the start, and after two that were more
    /// than 1 / kPeriodMin times as quick.
    [[nodiscard]] bool is_kept() const noexcept { return evidence_ < 2 * kQuick; }

    /// Of a period: what jitter may leave of the distance between two samples.
    static constexpr double kPeriodMin = 0.6;

  private:
    static constexpr unsigned kRound = wire::kJointSequenceCount;
    static constexpr int kQuick = 4;
    static constexpr int kEvidenceMax = 3 * kQuick;
    struct Newest {
        std::uint8_t sequence = 0;
        std::uint32_t sampled_us = 0;
    };
    double rate_hz_;
    std::optional<Newest> newest_;
    int evidence_ = kEvidenceMax;  ///< against it
};

}  // namespace octoskin
