#include "host/core/ingest/joint_rounds.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace octoskin {
namespace {

constexpr int kRound = wire::kJointSequenceCount;

std::uint8_t number_of(const wire::JointState& frame) {
    return std::visit([](const auto& part) { return part.sequence; }, frame);
}

std::size_t part_of_sample(const wire::JointState& frame) {
    const auto* const pair = std::get_if<wire::JointPair>(&frame);
    return pair != nullptr ? pair->index : 3U;
}

}  // namespace

bool JointRounds::is_of_no_round(const wire::JointState& frame, HostTime now) {
    const std::uint8_t number = number_of(frame);
    const std::size_t part = part_of_sample(frame);
    auto& rounds = rounds_.at(number);
    begin_round_if_due(rounds, now);
    Round& current = *rounds.current;
    const bool is_first =
        std::ranges::none_of(current.parts, [](const auto& other) { return other.has_value(); });
    if (newest_number_ != number && !is_first) current.is_in_one_go = false;
    newest_number_ = number;

    const auto& here = current.parts.at(part);
    const bool is_contradiction = here && *here != frame;
    // Delayed frames that arrive at once may be of several rounds; then frames of other numbers are among
    // them.
    const bool is_soon = current.is_in_one_go && now - current.begun <= period_ / 2;
    bool is_foreign = false;
    if (is_contradiction && is_soon && was_whole_in_its_time(rounds.before, now)) {
        const auto& of_before = rounds.before->parts.at(part);
        is_foreign = *of_before != frame && *of_before != *here;
    }
    current.parts.at(part) = frame;
    current.newest = now;
    return is_foreign;
}

void JointRounds::begin_round_if_due(Rounds& rounds, HostTime now) const {
    auto& current = rounds.current;
    const bool is_over = current && (now < current->newest || now - current->begun > period_ * kRound / 2);
    if (is_over) rounds.before = std::exchange(current, std::nullopt);
    if (!current) current = Round{.begun = now, .newest = now, .parts = {}};
}

bool JointRounds::was_whole_in_its_time(const std::optional<Round>& round, HostTime now) const {
    if (!round || !round->is_in_one_go) return false;
    const bool is_whole =
        std::ranges::all_of(round->parts, [](const auto& part) { return part.has_value(); });
    const Nanoseconds ago = now - round->begun;
    return is_whole && round->newest - round->begun <= period_ / 2 && ago > Nanoseconds{0} &&
           ago < period_ * kRound * 3 / 2;
}

}  // namespace octoskin
