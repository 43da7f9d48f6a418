#include "host/apps/daemon/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/io/socketcan/our_filters.hpp"

namespace octoskin {
namespace {

/// Datagrams of the CAN interface taken in one go before other inputs have their turn.
constexpr int kFramesPerTurn = 256;
// As many as wait for a loop that was held up. A flood must not delay the bus for longer.
constexpr int kDatagramsPerTurn = DatagramFeed::kWaitingMax;

CanLink::Opener opener(const DaemonRequest& request, const HostRig& rig) {
    if (request.can_descriptor) {
        return [descriptor = *request.can_descriptor, name = request.interface,
                is_open = false]() mutable -> Result<socketcan::CanSocket, socketcan::SocketFault> {
            if (std::exchange(is_open, true))
                return unexpected(socketcan::SocketFault{name, ENODEV, "closed by the other end"});
            return socketcan::CanSocket(name, descriptor, true);
        };
    }
    return [interface = request.interface, filters = socketcan::our_filters(rig)] {
        return socketcan::CanSocket::open(interface, {.filters = filters, .hears_itself = true});
    };
}

CanLink::StateReader state_reader(const DaemonRequest& request) {
    if (request.can_descriptor) return {};
    return [interface = request.interface] { return socketcan::read_interface_state(interface); };
}

Nanoseconds time_on_bus(const wire::CanFrame& frame, const wire::BitRates& rates) {
    return Nanoseconds{std::llround(1e9 * wire::worst_case_seconds(frame, rates))};
}

}  // namespace

Inputs::Inputs(const DaemonRequest& request, const HostRig& rig, EventLoop& loop, Pipeline& pipeline,
               RecordRequests& recordings)
    : request_(request),
      loop_(loop),
      pipeline_(pipeline),
      recordings_(recordings),
      can_(
          opener(request, rig), [this] { can_ready_ = EventSource(); }, state_reader(request)),
      local_sources_(local_sources_of(rig)),
      cameras_(loop, [this](DepthFrame frame) { return take_depth(std::move(frame)); }),
      bit_rates_(rig.bit_rates) {}

Status<AppError> Inputs::take_sockets(const HostRig& rig) {
    if (request_.joint_socket.empty()) return Done{};
    auto socket = JointSocket::open(request_.joint_socket, local_joints_of(rig));
    if (!socket) return unexpected(socket.error());
    joints_ = std::move(socket).value();
    return Done{};
}

void Inputs::watch(const HostRig& rig) {
    if (joints_) joints_ready_ = loop_.on_readable(joints_->descriptor(), [this] { catch_up(); });
    cameras_.want(cameras_of(rig));
    attend();
}

std::vector<HostCamera> Inputs::cameras_of(const HostRig& rig) const {
    return request_.has_camera ? rig.cameras : std::vector<HostCamera>{};
}

void Inputs::prepare_for(const HostRig& rig) {
    catch_up();  // waiting joint states are in the order of the former rig
    feed_joints(WallTime{std::numeric_limits<std::int64_t>::max()});
    cameras_.release_others(cameras_of(rig));
}

void Inputs::change_rig(const HostRig& rig) {
    if (!request_.can_descriptor) can_.change_filters(opener(request_, rig), socketcan::our_filters(rig));
    bit_rates_ = rig.bit_rates;
    change_local_sources(local_sources_of(rig));
    rig_changed_ = wall_now();
    if (joints_) joints_->expect(local_joints_of(rig));
    cameras_.want(cameras_of(rig));
}

void Inputs::attend() {
    const HostTime now = monotonic_now();
    note_displaced(now);
    if (can_.attend(now)) {
        can_ready_ = loop_.on_readable(can_.descriptor(), [this] {
            int datagrams_left = kDatagramsPerTurn;
            (void)drain_can(datagrams_left);
        });
    }
    if (!request_.is_listen_only) {
        const bool is_time_unknown = !bus_time_.at(now);  // active nodes wait for the time only
        if (is_time_unknown || pipeline_.intake().wants_exchange()) sync_.hasten();
        if (const auto due = sync_.poll(now)) (void)can_.send(wire::encode(*due, wire::kHostId));
    }
    cameras_.attend();
    catch_up();  // without a kernel, the echoes of this host's frames wake no one
    exchange_alone();
    const auto bus_now = bus_time_.at(now);
    if (bus_now && now - reported_ > BusTime::kSilent) pipeline_.on_silence(*bus_now);
}

/// Joint states of this machine have times of its own clock, so they need no working bus. For the pipeline
/// and a recording it looks as if SYNC and FOLLOW_UP had been on one.
void Inputs::exchange_alone() {
    if (request_.is_listen_only || !joints_ || joints_->samples() == 0) return;
    const WallTime stamp = wall_now();
    const auto at = monotonic_of(stamp);
    const auto sync = at ? sync_.poll_alone(*at) : std::nullopt;
    if (!sync) return;
    feed(wire::encode(*sync, wire::kHostId), stamp);
    report_local_joints(sync->sequence, *at, stamp);
    const wire::FollowUp follow_up{sync->sequence, static_cast<std::uint64_t>(at->ns / 1000)};
    feed(wire::encode(follow_up, wire::kHostId), stamp);
    newest_stamp_ = stamp;
}

std::uint64_t Inputs::joints_displaced() const {
    return joints_late_ + (joints_ ? joints_->displaced() : 0);
}

void Inputs::note_displaced(HostTime now) {
    const std::uint64_t displaced = joints_displaced() + (joints_ ? joints_->surplus() : 0);
    if (displaced > displaced_noted_) displaced_at_ = now;
    displaced_noted_ = displaced;
}

bool Inputs::is_flooded(HostTime now) const {
    constexpr Nanoseconds kHold{2'000'000'000};
    return displaced_at_ && now - *displaced_at_ < kHold;
}

void Inputs::catch_up() {
    constexpr int kTurnsMax = 64;  // as many as the receive buffer holds
    const WallTime begun = wall_now();
    int datagrams_left = kDatagramsPerTurn;
    for (int i = 0; i < kTurnsMax && !drain_can(datagrams_left); ++i) {
        if (can_.newest() > begun) return;  // the rest arrived meanwhile: in a flood there is always more
    }
}

/// The order of time stamps defines the bus time, so the samples of the socket are sorted in.
bool Inputs::drain_can(int& datagrams_left) {
    for (int frames_left = kFramesPerTurn; frames_left > 0;) {
        collect_joints(datagrams_left);  // first: samples not found now arrive after the frame
        const auto received = can_.receive(frames_left);
        if (!received && frames_left <= 0) return false;
        feed_joints(received ? std::optional(received->entry.stamp) : std::nullopt);
        if (!received) return true;
        take_frame(*received);
    }
    return false;
}

/// Samples of the socket replace those of their source's node: frames of two arms, or of two clocks, under
/// one node id would give poses that never were.
void Inputs::take_frame(const socketcan::Received& received) {
    bus_busy_ += time_on_bus(received.entry.frame, bit_rates_);
    if (is_of_local_joints(received.entry.frame)) {
        ++joint_node_ignored_;
        return;
    }
    if (is_foreign_follow_up(received)) {
        ++foreign_follow_ups_;
        foreign_sync_ = monotonic_now();
        return;
    }
    feed(received.entry.frame, received.entry.stamp);
    newest_stamp_ = received.entry.stamp;
    if (is_of_node(received.entry.frame)) bus_time_.on_frame(monotonic_now(), pipeline_.now());
    if (const auto at = monotonic_of(received.entry.stamp)) {
        answer_sync(received, *at);
        hear_host(received, *at);
    }
}

/// This host knows when its own SYNC was on the bus: another host's time for it can only be wrong.
bool Inputs::is_foreign_follow_up(const socketcan::Received& received) const {
    const bool is_follow_up =
        received.entry.frame.can_id == wire::can_id(wire::FrameType::follow_up, wire::kHostId);
    return is_follow_up && !received.is_own && !request_.is_listen_only &&
           wire::decode(received.entry.frame).has_value();
}

bool Inputs::is_of_node(const wire::CanFrame& frame) const {
    const wire::FrameSpec* const spec = wire::frame_spec(wire::type_of(frame.can_id));
    return spec != nullptr && spec->party == wire::Party::from_node &&
           pipeline_.intake().nodes().knows(wire::node_of(frame.can_id));
}

/// A host that only listens uses the clock of the host that sends SYNC, and converts its own measurements to
/// it.
void Inputs::hear_host(const socketcan::Received& received, HostTime at) {
    if (!request_.is_listen_only || wire::node_of(received.entry.frame.can_id) != wire::kHostId) return;
    const auto decoded = wire::decode(received.entry.frame);
    if (!decoded) return;
    if (const auto* sync = std::get_if<wire::Sync>(&decoded->message))
        foreign_clock_.on_sync(sync->sequence, at);
    if (const auto* follow_up = std::get_if<wire::FollowUp>(&decoded->message))
        foreign_clock_.on_follow_up(*follow_up);
}

/// The answer to a SYNC: of its local joints, and the FOLLOW_UP if the SYNC was its own.
void Inputs::answer_sync(const socketcan::Received& received, HostTime at) {
    if (received.entry.frame.can_id != wire::can_id(wire::FrameType::sync, wire::kHostId)) return;
    const auto decoded = wire::decode(received.entry.frame);
    const auto* const message = decoded ? std::get_if<wire::Sync>(&decoded->message) : nullptr;
    if (message == nullptr) return;
    report_local_joints(message->sequence, at, received.entry.stamp);
    if (!received.is_own) {
        foreign_sync_ = at;
        return;
    }
    if (const auto follow_up = sync_.on_sent(message->sequence, at))
        (void)can_.send(wire::encode(*follow_up, wire::kHostId));
}

/// Passes the frame to the pipeline, and notes the time since its arrival and the age of the readings.
void Inputs::feed(const wire::CanFrame& frame, WallTime stamp) {
    if (is_of_node(frame)) reported_ = monotonic_now();
    recordings_.on_can(frame, stamp);
    pipeline_.on_can(frame, stamp);
    note_host_frame(frame, stamp);
    const auto here = pipeline_.now();
    if (pipeline_.just_used().empty() || !here) return;
    const Nanoseconds took{wall_now().ns - stamp.ns};
    for (const HostTime captured : pipeline_.just_used()) {
        latency_.add(took);
        age_.add(*here - captured + took);
    }
}

/// The pipeline's "now" is at this frame only if it accepted it: a refused one must not stop the time.
void Inputs::note_host_frame(const wire::CanFrame& frame, WallTime stamp) {
    const bool is_taken = pipeline_.intake().host_clock().newest_stamp() == stamp;
    if (is_taken && wire::node_of(frame.can_id) == wire::kHostId)
        bus_time_.on_host_frame(monotonic_now(), pipeline_.now());
}

void Inputs::collect_joints(int& datagrams_left) {
    if (!joints_) return;
    std::optional<JointSample> sample;
    for (; datagrams_left > 0 && !are_waiting_full(); --datagrams_left) {
        if (!joints_->receive(sample)) {
            has_joints_left_ = false;
            return;
        }
        if (!sample) continue;        // counted by the socket
        if (sample->is_of_several) {  // which of them is the arm's cannot be decided
            ++joints_of_several_;
        } else if (has_lost_its_place(*sample)) {
            ++joints_late_;
        } else {
            local_sources_.at(sample->source).waiting.push_back(std::move(*sample));
        }
    }
    if (datagrams_left == 0) has_joints_left_ = true;
}

/// In a flood: later frames are in the pipeline already, for which it would be a clock set back. Or it
/// arrived before a reload: joints of another rig, or in another order, would give a pose that never was.
bool Inputs::has_lost_its_place(const JointSample& sample) const {
    constexpr std::int64_t kClockSetNs = 1'000'000'000;  // more than a delayed turn
    const auto is_before = [&sample](const std::optional<WallTime>& other) {
        return other && sample.came < *other && other->ns - sample.came.ns < kClockSetNs;
    };
    return is_before(rig_changed_) || (has_joints_left_ && is_before(newest_stamp_));
}

/// Frames of the bus may overtake a sample that waited for the end of a burst, but the order of time stamps
/// defines the bus time. Only a clock that was set back differs by more than a sample, and this loop with it,
/// can have waited.
WallTime Inputs::place_of(const JointSample& sample) const {
    constexpr Nanoseconds kOvertakenMax = 2 * JointBurst::kWaitMax;
    const bool is_overtaken = newest_stamp_ && *newest_stamp_ > sample.came &&
                              newest_stamp_->ns - sample.came.ns < kOvertakenMax.count();
    return is_overtaken ? *newest_stamp_ : sample.came;
}

LineJoints Inputs::local_joints_of(const HostRig& rig) const {
    return LineJoints::local(rig, pipeline_.builder().robot().robot().limits());
}

std::vector<Inputs::LocalSource> Inputs::local_sources_of(const HostRig& rig) const {
    std::vector<LocalSource> sources;
    for (const LineJoints::Source& source : local_joints_of(rig).sources) {
        const wire::NodeId node = rig.joint_sources[source.index].node_id;
        sources.push_back({.node = node,
                           .rate_hz = source.rate_hz,
                           .joints = LocalJoints(node, source.names.size(), source.rate_hz),
                           .burst = JointBurst(source.rate_hz)});
    }
    return sources;
}

/// A source that continues keeps its time of the newest sample: a reload is no gap.
void Inputs::change_local_sources(std::vector<LocalSource> sources) {
    for (LocalSource& source : sources) {
        const auto before = std::ranges::find(local_sources_, source.node, &LocalSource::node);
        if (before == local_sources_.end()) continue;
        before->burst.expect(source.rate_hz);
        source.burst = before->burst;
    }
    local_sources_ = std::move(sources);
}

bool Inputs::is_of_local_joints(const wire::CanFrame& frame) const {
    const wire::NodeId node = wire::node_of(frame.can_id);
    return std::ranges::any_of(local_sources_,
                               [node](const LocalSource& source) { return source.node == node; });
}

/// The answer of each source that has sent.
void Inputs::report_local_joints(std::uint8_t sequence, HostTime at, WallTime stamp) {
    for (std::size_t i = 0; i < local_sources_.size(); ++i) {
        if (joints_ && joints_->samples(i) > 0) feed(local_sources_[i].joints.report(sequence, at), stamp);
    }
}

bool Inputs::are_waiting_full() const {
    constexpr std::size_t kWaitingMax = 256;
    return std::ranges::any_of(
        local_sources_, [](const LocalSource& source) { return source.waiting.size() >= kWaitingMax; });
}

/// Those that arrived by `until`; empty: all, except possible parts of a burst that is not over.
void Inputs::feed_joints(std::optional<WallTime> until) {
    const WallTime now = until.value_or(wall_now());
    std::vector<const LocalSource*> held_back;  // their oldest sample may be part of a burst
    while (LocalSource* const source =
               next_due(until.value_or(WallTime{std::numeric_limits<std::int64_t>::max()}), held_back)) {
        const JointBurst::Turn turn = source->burst.turn_of_oldest(source->waiting, now);
        if (turn == JointBurst::Turn::wait) {
            held_back.push_back(source);
        } else {
            feed_oldest(*source, turn);
        }
    }
}

/// The source with the oldest waiting sample, if that arrived by `until`; null if there is none.
Inputs::LocalSource* Inputs::next_due(WallTime until, const std::vector<const LocalSource*>& held_back) {
    LocalSource* next = nullptr;
    for (LocalSource& source : local_sources_) {
        const bool is_due = !source.waiting.empty() && source.waiting.front().came <= until &&
                            std::ranges::find(held_back, &source) == held_back.end();
        if (is_due && (next == nullptr || source.waiting.front().came < next->waiting.front().came))
            next = &source;
    }
    return next;
}

void Inputs::feed_oldest(LocalSource& source, JointBurst::Turn turn) {
    const JointSample sample = std::move(source.waiting.front());
    source.waiting.pop_front();
    const auto frames = turn == JointBurst::Turn::use ? source.joints.frames(sample.sampled, sample.position)
                                                      : unexpected(LocalJointFault::too_soon);
    if (!frames) {  // the socket refuses and counts all other faults
        ++joints_thinned_;
        return;
    }
    const WallTime place = place_of(sample);
    for (const wire::CanFrame& frame : *frames) feed(frame, place);
}

bool Inputs::take_depth(DepthFrame frame) {
    // Not earlier: relative to the input read so far it would be a frame of the future.
    catch_up();
    if (request_.is_listen_only) {
        const auto ahead = foreign_clock_.ahead(monotonic_now());
        if (!ahead) return false;
        frame.captured = frame.captured + *ahead;
    }
    pipeline_.on_depth(std::move(frame));
    return true;
}

}  // namespace octoskin
