#include "tests/support/live/endless_log.hpp"

#include <cmath>
#include <optional>
#include <variant>

#include "common/wire/codec.hpp"

namespace octoskin::test {
namespace {

using wire::FrameType;

bool is_left_out(FrameType type) {
    return type == FrameType::sync || type == FrameType::follow_up || type == FrameType::mark ||
           type == FrameType::command || type == FrameType::sync_report;
}

std::optional<wire::MarkKind> mark_of(const wire::CanFrame& frame) {
    const auto decoded = wire::decode(frame);
    const auto* const mark = decoded ? std::get_if<wire::Mark>(&decoded->message) : nullptr;
    return mark != nullptr ? std::optional(mark->kind) : std::nullopt;
}

/// Offset of times and sequence numbers of one node relative to the log.
class Advance {
  public:
    Advance(std::int64_t us, unsigned rounds) : us_(us), rounds_(rounds) {}

    [[nodiscard]] wire::TimeResidue operator()(wire::TimeResidue time) const {
        const auto us = static_cast<std::uint32_t>((time.value_us + us_) % time.span_us);
        const NodeTime low{us};
        return time.span_us == wire::kClassicalTimeSpanUs ? wire::classical_residue(low)
                                                          : wire::fd_residue(low);
    }
    [[nodiscard]] std::uint8_t operator()(std::uint8_t number, unsigned per_round, unsigned modulus) const {
        return static_cast<std::uint8_t>((number + rounds_ * per_round) % modulus);
    }

  private:
    std::int64_t us_;
    unsigned rounds_;
};

}  // namespace

EndlessLog::EndlessLog(const std::vector<StampedFrame>& log, std::map<wire::NodeId, double> us_per_us)
    : us_per_us_(std::move(us_per_us)) {
    std::optional<WallTime> start;
    std::optional<WallTime> stop;
    for (const StampedFrame& entry : log) {
        if (const auto mark = mark_of(entry.frame)) {
            (*mark == wire::MarkKind::start ? start : stop) = entry.stamp;
            if (*mark == wire::MarkKind::start) round_begin_ = frames_.size();
        }
        if (stop) break;
        if (is_left_out(wire::type_of(entry.frame.can_id))) continue;
        frames_.push_back(entry);
        if (start) count(entry.frame);
    }
    round_ns_ = stop.value().ns - start.value().ns;
}

void EndlessLog::count(const wire::CanFrame& frame) {
    const wire::Decoded decoded = wire::decode(frame).value();
    const wire::NodeId node = decoded.node_id;
    if (const auto* range = std::get_if<wire::Range>(&decoded.message))
        ++per_round_.readings[{node, range->reading.sensor}];
    if (const auto* range = std::get_if<wire::RangeFd>(&decoded.message))
        for (std::size_t i = 0; i < range->count; ++i)
            ++per_round_.readings[{node, range->entries[i].reading.sensor}];
    if (const auto* joints = std::get_if<wire::JointState>(&decoded.message))
        per_round_.joint_samples[node] += std::holds_alternative<wire::JointLast>(*joints) ? 1U : 0U;
    if (std::holds_alternative<wire::Reflex>(decoded.message)) ++per_round_.reflexes[node];
}

StampedFrame EndlessLog::next() {
    if (next_ == frames_.size()) {
        next_ = round_begin_;
        ++round_;
    }
    const StampedFrame& entry = frames_[next_++];
    if (round_ == 0) return entry;
    return {{entry.stamp.ns + round_ * round_ns_}, in_this_round(entry.frame)};
}

wire::CanFrame EndlessLog::in_this_round(const wire::CanFrame& frame) const {
    wire::Decoded decoded = wire::decode(frame).value();
    const wire::NodeId node = decoded.node_id;
    const auto rate = us_per_us_.find(node);
    const double us = 1e-3 * static_cast<double>(round_ns_) * round_;
    const Advance advance(std::llround(us * (rate != us_per_us_.end() ? rate->second : 1.0)), round_);
    const auto of = [](const auto& counts, const auto& key) {
        const auto found = counts.find(key);
        return found != counts.end() ? found->second : 0U;
    };
    const auto readings = [&](std::uint8_t sensor) { return of(per_round_.readings, Sensor{node, sensor}); };
    const auto advance_time = [&](wire::RangeReading& reading) {
        reading.sequence = advance(reading.sequence, readings(reading.sensor), wire::kSequenceCount);
        reading.capture = advance(reading.capture);
    };
    if (auto* range = std::get_if<wire::Range>(&decoded.message)) advance_time(range->reading);
    if (auto* range = std::get_if<wire::RangeFd>(&decoded.message))
        for (std::size_t i = 0; i < range->count; ++i) advance_time(range->entries[i].reading);
    if (auto* aux = std::get_if<wire::RangeAux>(&decoded.message))
        aux->sequence = advance(aux->sequence, readings(aux->sensor), wire::kSequenceCount);
    if (auto* health = std::get_if<wire::SensorHealth>(&decoded.message))
        health->sent = static_cast<std::uint16_t>(health->sent + round_ * readings(health->sensor));
    if (auto* reflex = std::get_if<wire::Reflex>(&decoded.message)) {
        reflex->sequence = advance(reflex->sequence, of(per_round_.reflexes, node), wire::kSequenceCount);
        reflex->capture = advance(reflex->capture);
    }
    if (auto* joints = std::get_if<wire::JointState>(&decoded.message)) {
        const unsigned samples = of(per_round_.joint_samples, node);
        std::visit(
            [&](auto& part) { part.sequence = advance(part.sequence, samples, wire::kJointSequenceCount); },
            *joints);
        if (auto* last = std::get_if<wire::JointLast>(joints)) last->sampled = advance(last->sampled);
    }
    return wire::encode(decoded.message, node);
}

}  // namespace octoskin::test
