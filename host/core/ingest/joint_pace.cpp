#include "host/core/ingest/joint_pace.hpp"

#include <algorithm>

namespace octoskin {

void JointPace::observe(std::uint8_t sequence, const wire::TimeResidue& sampled) noexcept {
    if (newest_) {
        const std::uint32_t passed_us = (sampled.value_us - newest_->sampled_us) % sampled.span_us;
        if (passed_us >= sampled.span_us / 2) return;  // an older sample that arrived late
        // 1..8; the true number may be larger by whole rounds
        const unsigned sent = (sequence - newest_->sequence + kRound - 1U) % kRound + 1U;
        const bool is_quick = 1e-6 * passed_us * rate_hz_ < kPeriodMin * sent;
        evidence_ = is_quick ? std::min(evidence_ + kQuick, kEvidenceMax) : std::max(evidence_ - 1, 0);
    }
    newest_ = {sequence, sampled.value_us};
}

}  // namespace octoskin
