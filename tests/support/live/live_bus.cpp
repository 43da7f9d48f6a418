#include "tests/support/live/live_bus.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <utility>

#include "common/wire/codec.hpp"

namespace octoskin::test {
namespace {

std::int64_t steady_ns() {
    return std::chrono::steady_clock::now().time_since_epoch().count();
}

/// Converts a kernel time stamp to the clock of steady_ns(). A delay of the thread between reading the two
/// clocks is an error, so the closest of several pairs is used.
std::int64_t steady_of(WallTime stamp) {
    std::int64_t closest_ns = std::numeric_limits<std::int64_t>::max();
    std::int64_t steady_at_stamp_ns = 0;
    for (int i = 0; i < 8 && closest_ns > 20'000; ++i) {
        const std::int64_t before_ns = steady_ns();
        timespec wall{};
        ::clock_gettime(CLOCK_REALTIME, &wall);
        const std::int64_t apart_ns = steady_ns() - before_ns;
        if (apart_ns >= closest_ns) continue;
        closest_ns = apart_ns;
        const std::int64_t wall_ns = std::int64_t{wall.tv_sec} * 1'000'000'000 + wall.tv_nsec;
        steady_at_stamp_ns = before_ns + apart_ns / 2 - (wall_ns - stamp.ns);
    }
    return steady_at_stamp_ns;
}

}  // namespace

LiveBus::LiveBus(int descriptor, const std::vector<StampedFrame>& log) : socket_("live", descriptor) {
    learn_clocks(log);
    EndlessLog endless(log, clock_rates());
    begin_ns_ = log.front().stamp.ns;
    begin_steady_ns_ = steady_ns();
    thread_ = std::thread([this, frames = std::move(endless)]() mutable { play(frames); });
}

LiveBus::~LiveBus() {
    is_ending_ = true;
    thread_.join();
}

/// Two exchanges determine a clock: its value at the first, and its rate until the last.
void LiveBus::learn_clocks(const std::vector<StampedFrame>& log) {
    std::array<std::int64_t, wire::kSyncSequenceCount> sync_ns{};
    for (const StampedFrame& entry : log) {
        const auto decoded = wire::decode(entry.frame);
        if (!decoded) continue;
        if (const auto* sync = std::get_if<wire::Sync>(&decoded->message))
            sync_ns.at(sync->sequence) = entry.stamp.ns;
        const auto* report = std::get_if<wire::SyncReport>(&decoded->message);
        if (report == nullptr) continue;
        const std::int64_t at_ns = sync_ns.at(report->sequence);
        const auto [known, is_first] =
            clocks_.try_emplace(decoded->node_id, Clock{at_ns, report->heard.us, 1.0});
        if (is_first) continue;
        const double passed_us = static_cast<double>(at_ns - known->second.stamp_ns) * 1e-3;
        const std::uint32_t ran_us = report->heard.us - known->second.heard_us;
        known->second.us_per_us = static_cast<double>(ran_us) / passed_us;
    }
}

std::int64_t LiveBus::log_time_ns(std::int64_t steady_ns) const {
    return begin_ns_ + steady_ns - begin_steady_ns_;
}

std::int64_t LiveBus::log_now_ns() const {
    return log_time_ns(steady_ns());
}

std::map<wire::NodeId, double> LiveBus::clock_rates() const {
    std::map<wire::NodeId, double> rates;
    for (const auto& [node, clock] : clocks_) rates[node] = clock.us_per_us;
    return rates;
}

void LiveBus::play(EndlessLog& log) {
    while (true) {  // until it is stopped
        const StampedFrame entry = log.next();
        listen_until(entry.stamp.ns);
        if (is_ending_) return;
        be_host();
        if (is_silent(wire::node_of(entry.frame.can_id))) continue;
        put(entry.frame);
        babble_with(entry.frame);
    }
}

void LiveBus::listen_until(std::int64_t due_ns) {
    while (!is_ending_) {
        const std::int64_t left_ns = due_ns - log_now_ns();
        pollfd readable{socket_.descriptor(), POLLIN, 0};
        const timespec patience{0, std::clamp<std::int64_t>(left_ns, 0, 20'000'000)};
        if (::ppoll(&readable, 1, &patience, nullptr) > 0 && !hear_one()) {
            std::this_thread::sleep_for(
                std::chrono::milliseconds(1));  // the other end is gone: time continues
        }
        if (log_now_ns() >= due_ns) return;
    }
}

bool LiveBus::hear_one() {
    auto received = socket_.receive();
    if (!received) return false;
    if (*received && !is_cut_) {
        // A node's hardware has a time stamp of the end of a frame; here the kernel's time stamp of the
        // hand-over is used.
        const StampedFrame& entry = (*received)->entry;
        answer(entry.frame, log_time_ns(steady_of(entry.stamp)));
    }
    return true;
}

void LiveBus::answer(const wire::CanFrame& frame, std::int64_t heard_ns) {
    ++frames_heard_;
    const auto decoded = wire::decode(frame);
    const auto* const sync = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
    if (sync == nullptr) return;
    ++syncs_heard_;
    report(sync->sequence, heard_ns);
}

void LiveBus::report(std::uint8_t sequence, std::int64_t heard_ns) {
    for (const auto& [node, clock] : clocks_) {
        if (is_silent(node)) continue;
        const double passed_us = static_cast<double>(heard_ns - clock.stamp_ns) * 1e-3;
        const auto ran_us = static_cast<std::int64_t>(std::floor(passed_us * clock.us_per_us));
        const NodeTime heard{clock.heard_us + static_cast<std::uint32_t>(ran_us)};
        put(wire::encode(wire::SyncReport{sequence, heard}, node));
    }
}

void LiveBus::speak_as_host(Nanoseconds ahead) {
    const std::lock_guard lock(mutex_);
    host_ahead_ = ahead;
}

void LiveBus::lie_once(Nanoseconds by) {
    const std::lock_guard lock(mutex_);
    lie_ = by;
}

void LiveBus::be_host() {
    std::optional<Nanoseconds> ahead;
    {
        const std::lock_guard lock(mutex_);
        if (!host_ahead_ || log_now_ns() < host_due_ns_) return;
        ahead = *host_ahead_ + std::exchange(lie_, Nanoseconds{0});
    }
    host_due_ns_ = log_now_ns() + 1'000'000'000;
    host_sequence_ = static_cast<std::uint8_t>((host_sequence_ + 1U) % wire::kSyncSequenceCount);
    put(wire::encode(wire::Sync{host_sequence_}, wire::kHostId));
    const std::int64_t sent_ns = log_now_ns();
    const std::int64_t host_ns = steady_ns() + ahead->count();
    put(wire::encode(wire::FollowUp{host_sequence_, static_cast<std::uint64_t>(host_ns / 1000)},
                     wire::kHostId));
    report(host_sequence_, sent_ns);
}

void LiveBus::put(const wire::CanFrame& frame) {
    if (is_cut_) return;
    (void)socket_.send(frame);  // a full receiver loses it, as on a bus
}

void LiveBus::let_babble(std::optional<wire::NodeId> node) {
    const std::lock_guard lock(mutex_);
    babbling_ = node;
}

void LiveBus::babble_with(const wire::CanFrame& frame) {
    const wire::NodeId node = wire::node_of(frame.can_id);
    if (wire::type_of(frame.can_id) == wire::FrameType::heartbeat) heartbeats_[node] = frame;
    const std::lock_guard lock(mutex_);
    const auto heartbeat = heartbeats_.find(node);
    if (babbling_ != node || heartbeat == heartbeats_.end()) return;
    for (int i = 0; i < 12; ++i) put(heartbeat->second);
}

void LiveBus::silence(wire::NodeId node, bool is_silent) {
    const std::lock_guard lock(mutex_);
    silent_[node] = is_silent;
}

bool LiveBus::is_silent(wire::NodeId node) const {
    const std::lock_guard lock(mutex_);
    const auto found = silent_.find(node);
    return found != silent_.end() && found->second;
}

}  // namespace octoskin::test
