// Checks that a source of joint states is not faster than the rig's rate.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// Samples are distinguished by a sequence number of three bits. At twice the rig's rate, the number wraps
/// while frames of the round before are still expected, and four frames of two rounds can look like one
/// sample. Each complete sample contains its own time. Two of them give the rate, whatever was lost or late
/// between them.
class JointPace {
  public:
    explicit JointPace(double rate_hz) noexcept : rate_hz_(rate_hz) {}

    /// Takes complete samples in the order of completion.
    void observe(std::uint8_t sequence, const wire::TimeResidue& sampled) noexcept;

    /// False until five consecutive pairs kept the rate: at the start, and after two pairs that were more
    /// than 1 / kPeriodMin times too fast.
    [[nodiscard]] bool is_kept() const noexcept { return evidence_ < 2 * kQuick; }

    /// Fraction of a period that jitter may leave between two samples.
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
    int evidence_ = kEvidenceMax;  ///< evidence against the rate
};

}  // namespace octoskin
