#include "host/core/ingest/joint_assembler.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin {
namespace {

std::uint8_t sequence_of(const wire::JointState& frame) {
    return std::visit([](const auto& part) { return part.sequence; }, frame);
}

std::uint8_t part_of(const wire::JointState& frame) {
    const auto* pair = std::get_if<wire::JointPair>(&frame);
    return pair ? pair->index : std::uint8_t{3};
}

JointReading join(const std::array<std::optional<wire::JointState>, 4>& parts) {
    JointReading reading;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& pair = std::get<wire::JointPair>(*parts[i]);
        reading.position_rad[2 * i] = 1e-6 * pair.position_urad[0];
        reading.position_rad[2 * i + 1] = 1e-6 * pair.position_urad[1];
    }
    const auto& last = std::get<wire::JointLast>(*parts[3]);
    reading.position_rad[6] = 1e-6 * last.position_urad;
    reading.sampled = last.sampled;
    return reading;
}

}  // namespace

JointAssembler::JointAssembler(double rate_hz)
    : patience_(std::llround(1e9 * wire::kJointSequenceCount / 2 / rate_hz)),
      pace_(rate_hz),
      rounds_(Nanoseconds{std::llround(1e9 / rate_hz)}) {
    assert(rate_hz > 0.0);
}

void JointAssembler::give_up_stale(HostTime now, Outcome& outcome) {
    for (auto& sample : samples_) {
        if (!sample || (now >= sample->opened && now - sample->opened <= patience_)) {
            continue;
        }
        if (!sample->is_complete) {
            outcome.given_up.push_back(JointReason::incomplete);
        }
        sample.reset();
    }
}

/// Delayed frames arrive in a burst, the next round before this one is stale. For an arm at rest, they look
/// like repeats of this round. But a repeated frame follows its original, never a frame of a newer sample.
void JointAssembler::begin_round(std::uint8_t sequence, Outcome& outcome) {
    const int ahead = (sequence - newest_ + wire::kJointSequenceCount) % wire::kJointSequenceCount;
    if (ahead == 0 || ahead > wire::kJointSequenceCount / 2) return;
    newest_ = sequence;
    auto& sample = samples_[sequence];
    if (sample && !sample->is_complete) outcome.given_up.push_back(JointReason::incomplete);
    sample.reset();
}

bool JointAssembler::are_of_one_round(const wire::JointState& a, const wire::JointState& b) const {
    const auto* const one = std::get_if<wire::JointLast>(&a);
    const auto* const other = std::get_if<wire::JointLast>(&b);
    if (one == nullptr || other == nullptr) return false;
    const std::uint32_t span_us = one->sampled.span_us;
    const std::uint32_t after_us = (other->sampled.value_us + span_us - one->sampled.value_us) % span_us;
    return Nanoseconds{1'000LL * std::min(after_us, span_us - after_us)} < patience_;
}

JointAssembler::Outcome JointAssembler::on_frame(const wire::JointState& frame, HostTime now) {
    Outcome outcome;
    const bool is_of_no_round = rounds_.is_of_no_round(frame, now);
    give_up_stale(now, outcome);
    begin_round(sequence_of(frame), outcome);
    auto& sample = samples_[sequence_of(frame)];
    const std::uint8_t part = part_of(frame);
    bool is_contested = false;
    if (sample && sample->parts[part]) {
        const bool is_equal = *sample->parts[part] == frame;
        // Equal, but not to the frame before: it is of the next round, and this sample will never be
        // complete.
        if (is_equal && (sample->is_complete || sample->newest_part == part)) {
            outcome.is_repeated = true;
            return outcome;
        }
        outcome.is_contradiction = !is_equal;
        outcome.is_of_no_round = !is_equal && is_of_no_round;
        outcome.is_of_one_round = !is_equal && are_of_one_round(*sample->parts[part], frame);
        if (!sample->is_complete) {
            outcome.given_up.push_back(is_equal ? JointReason::incomplete : JointReason::contradictory);
            is_contested = !is_equal;
        }
        sample.reset();
    }
    if (!sample) {
        sample = Sample{.opened = now, .is_contested = is_contested, .parts = {}};
        outcome.opened = true;
    } else {
        sample->is_in_order = sample->is_in_order && part > sample->newest_part;
    }
    sample->parts[part] = frame;
    sample->newest_part = part;
    const auto is_here = [](const auto& entry) { return entry.has_value(); };
    if (std::ranges::all_of(sample->parts, is_here)) {
        sample->is_complete = true;
        if (sample->is_contested) {
            outcome.given_up.push_back(JointReason::contradictory);
            return outcome;
        }
        outcome.complete = join(sample->parts);
        outcome.complete->sequence = sequence_of(frame);
        outcome.complete->begun = sample->opened;
        outcome.complete->is_in_order = sample->is_in_order;
        pace_.observe(sequence_of(frame), outcome.complete->sampled);
        outcome.complete->has_pace = pace_.is_kept();
    }
    return outcome;
}

std::uint64_t JointAssembler::pending() const {
    const auto is_pending = [](const auto& sample) { return sample && !sample->is_complete; };
    return static_cast<std::uint64_t>(std::ranges::count_if(samples_, is_pending));
}

}  // namespace octoskin
