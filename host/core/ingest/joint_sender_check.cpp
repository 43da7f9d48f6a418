#include "host/core/ingest/joint_sender_check.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "common/wire/messages.hpp"

namespace octoskin {
namespace {

constexpr unsigned kRound = wire::kJointSequenceCount;
/// In periods: within this time, a second sender's sample meets the first sender's sample of the same number.
constexpr double kWaitMin = 1.25;
/// In periods, if the next sample does not arrive: half a round. At most the gap that poses are interpolated
/// over.
constexpr double kWaitMax = 4.0;
constexpr Nanoseconds kWaitLongest{100'000'000};
/// Limits the stored samples of the last round during a flood.
constexpr std::size_t kRecentMax = 4UL * kRound;

/// Contradictions per second on a bus that delays one frame in twenty by most of a round.
std::size_t late_max(double rate_hz) {
    return static_cast<std::size_t>(std::max(1.0, rate_hz / 4.0));
}

Nanoseconds times(double factor, Nanoseconds period) {
    return Nanoseconds{std::llround(factor * static_cast<double>(period.count()))};
}

}  // namespace

JointSenderCheck::JointSenderCheck(double rate_hz, bool waits)
    : period_(std::llround(1e9 / rate_hz)), waits_(waits), late_(late_max(rate_hz)) {
    assert(rate_hz > 0.0);
}

void JointSenderCheck::on_sample(std::uint8_t sequence, const JointMeasurement& joints, HostTime now,
                                 Ended& ended) {
    if (!waits_) {
        ended.emplace_back(joints);
        return;
    }
    const Sample sample{sequence, now, joints};
    std::erase_if(recent_, [&](const Sample& before) {
        return std::chrono::abs(now - before.came) > times(kRound, period_);
    });
    const bool is_contradicted =
        std::ranges::any_of(recent_, [&](const Sample& before) { return contradict(before, sample); });
    recent_.push_back(sample);
    if (recent_.size() > kRecentMax) recent_.pop_front();
    if (is_contradicted) find_two(now, ended);
    if (hears_two(now)) {
        ended.emplace_back(unexpected(JointReason::second_sender));
        return;
    }
    waiting_.push_back(sample);
    if (waiting_.size() > kRound) {  // delayed, and arrived at once: each has a successor
        ended.emplace_back(waiting_.front().joints);
        waiting_.pop_front();
    }
}

void JointSenderCheck::on_contradiction(std::uint8_t sequence, Rounds rounds, HostTime now, Ended& ended) {
    if (!waits_) return;
    const bool is_waiting =
        std::ranges::any_of(waiting_, [&](const Sample& sample) { return sample.sequence == sequence; });
    const bool are_too_many_late = !late_.keeps_with_event(now);
    const bool are_two_foreign = rounds == Rounds::none && !foreign_.keeps_with_event(now);
    if (is_waiting || rounds == Rounds::one || are_too_many_late || are_two_foreign) find_two(now, ended);
}

void JointSenderCheck::advance(HostTime now, Ended& ended) {
    while (!waiting_.empty() && may_oldest_be_used(now)) {
        ended.emplace_back(waiting_.front().joints);
        waiting_.pop_front();
    }
}

void JointSenderCheck::settle_if_back(HostTime now, Ended& ended) {
    if (!waiting_.empty() && now < waiting_.back().came) settle(ended);
}

void JointSenderCheck::settle(Ended& ended) {
    for (const Sample& sample : waiting_) ended.emplace_back(sample.joints);
    waiting_.clear();
}

bool JointSenderCheck::hears_two(HostTime now) const {
    return found_ && std::chrono::abs(now - *found_) < kHeardFor;
}

/// One sender has no two samples with one number within a round, and no two samples whose numbers are further
/// apart than their times. Tolerance: the jitter that JointPace allows and half a period.
bool JointSenderCheck::contradict(const Sample& a, const Sample& b) const {
    if (a.joints.relocks != b.joints.relocks) return false;  // their distance in time is unknown
    const bool is_ordered = a.joints.sampled <= b.joints.sampled;
    const Sample& first = is_ordered ? a : b;
    const Sample& second = is_ordered ? b : a;
    const unsigned steps = (second.sequence + kRound - first.sequence + kRound - 1U) % kRound + 1U;
    const double passed = static_cast<double>((second.joints.sampled - first.joints.sampled).count()) /
                          static_cast<double>(period_.count());
    return steps - passed > std::max(0.4 * steps, 1.5);
}

bool JointSenderCheck::may_oldest_be_used(HostTime now) const {
    const Nanoseconds waited = now - waiting_.front().came;
    const bool has_successor = waiting_.size() > 1;
    return (has_successor && waited >= times(kWaitMin, period_)) ||
           waited >= std::min(times(kWaitMax, period_), kWaitLongest);
}

void JointSenderCheck::find_two(HostTime now, Ended& ended) {
    found_ = now;
    ++contradictions_;
    for (std::size_t i = 0; i < waiting_.size(); ++i)
        ended.emplace_back(unexpected(JointReason::second_sender));
    waiting_.clear();
    recent_.clear();  // already evaluated
}

}  // namespace octoskin
