#include "host/bridge/mcap/bag_log.hpp"

#include <algorithm>
#include <utility>

#include "common/wire/codec.hpp"
#include "common/wire/frame_type.hpp"
#include "host/bridge/mcap/bag_time.hpp"

namespace octoskin::bridge {

bool BagLog::add(WallTime stamp, const wire::CanFrame& frame) {
    return push(stamp, frame);
}

bool BagLog::add(WallTime stamp, std::size_t source, std::vector<double> position) {
    return push(stamp, Joints{source, std::move(position)});
}

/// A frame of the bag's own bus has its bus's times in itself; all that is made needs one of the clock.
bool BagLog::can_hold(WallTime stamp, const Content& content) const {
    const bool is_of_bus = !makes_sync_ && std::holds_alternative<wire::CanFrame>(content);
    return is_of_bus ? is_log_time(stamp) : has_bus_time(clock_, stamp);
}

bool BagLog::push(WallTime stamp, Content content) {
    if (!can_hold(stamp, content)) return false;
    waiting_.push({stamp, number_++, std::move(content)});
    if (waiting_.size() > kWaitingMax) write_oldest();
    return true;
}

void BagLog::advance(WallTime now) {
    if (!is_log_time(now)) return;
    while (!waiting_.empty() && now.ns - waiting_.top().stamp.ns > kWindow.count()) write_oldest();
}

void BagLog::write_oldest() {
    const Entry entry = waiting_.top();
    waiting_.pop();
    // Behind one that waited too briefly: the order of the log is that of arrival.
    const WallTime stamp = std::max(entry.stamp, last_.value_or(entry.stamp));
    if (makes_sync_) exchange_until(stamp);
    if (const auto* frame = std::get_if<wire::CanFrame>(&entry.content))
        write(stamp, *frame);
    else if (const auto* joints = std::get_if<Joints>(&entry.content))
        write_joints(stamp, *joints);
}

void BagLog::write(WallTime stamp, const wire::CanFrame& frame) {
    if (!first_) first_ = stamp;
    last_ = stamp;
    ++frames_;
    const auto written = log_.write(stamp, frame);
    if (!written && !error_) error_ = written.error();
    if (makes_sync_ || frame.can_id != wire::can_id(wire::FrameType::sync, wire::kHostId)) return;
    const auto decoded = wire::decode(frame);
    const auto* const sync = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
    if (sync != nullptr) write_reports(stamp, sync->sequence);
}

/// As a bus would carry them, one after the other: equal stamps would look like those of a coarse clock.
WallTime BagLog::write_made(WallTime stamp, const wire::CanFrame& frame) {
    constexpr std::int64_t kFrame_ns = 130'000;  // 8 bytes at 1 Mbit/s
    const WallTime at = last_ ? std::max(stamp, WallTime{last_->ns + kFrame_ns}) : stamp;
    write(at, frame);
    return at;
}

void BagLog::write_joints(WallTime stamp, const Joints& joints) {
    // A frame of the bag's own bus, long after its clock's times, may have moved it.
    if (!has_bus_time(clock_, stamp)) {
        ++thinned_;
        return;
    }
    const auto frames = sources_.at(joints.source)->frames(clock_.bus_of(stamp), joints.position);
    if (!frames) {
        ++thinned_;
        return;
    }
    for (const wire::CanFrame& frame : *frames) (void)write_made(stamp, frame);
}

/// What the daemon answers for joint states of its machine.
void BagLog::write_reports(WallTime stamp, std::uint8_t sequence) {
    if (!has_bus_time(clock_, stamp)) return;
    for (const auto& source : sources_)
        if (source) (void)write_made(stamp, source->report(sequence, clock_.bus_of(stamp)));
}

/// Exchanges at their times, so that no silence of the log looks like a clock that was set. A hole in the bag
/// stays one: what is written is bounded by what is read.
void BagLog::exchange_until(WallTime stamp) {
    constexpr std::int64_t kHole_ns = 2'000'000'000;
    const bool begins = !exchanged_ || stamp.ns - exchanged_->ns > kHole_ns;
    WallTime next = begins ? stamp : WallTime{exchanged_->ns + kSyncPeriod.count()};
    for (; next <= stamp; next.ns += kSyncPeriod.count()) {
        exchanged_ = next;
        const auto sync = sync_.poll(clock_.bus_of(next));
        if (!sync) continue;
        const WallTime sent = write_made(next, wire::encode(*sync, wire::kHostId));
        write_reports(sent, sync->sequence);
        if (const auto follow_up = sync_.on_sent(sync->sequence, clock_.bus_of(sent)))
            (void)write_made(sent, wire::encode(*follow_up, wire::kHostId));
    }
}

Status<Error> BagLog::close() {
    while (!waiting_.empty()) write_oldest();
    if (error_) return unexpected(*error_);
    return log_.close();
}

}  // namespace octoskin::bridge
