// The inputs beside a robot: CAN frames, joint states of this machine, depth frames. Each goes into the
// pipeline on arrival; requests of the bus to its host are answered.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/bus_load.hpp"
#include "host/apps/daemon/camera_inputs.hpp"
#include "host/apps/daemon/can_link.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/latency.hpp"
#include "host/apps/daemon/record_requests.hpp"
#include "host/apps/daemon/settings.hpp"
#include "host/core/ingest/joint_burst.hpp"
#include "host/core/ingest/local_joints.hpp"
#include "host/core/time/bus_time.hpp"
#include "host/core/time/foreign_clock.hpp"
#include "host/core/time/sync_master.hpp"

namespace octoskin {

class Inputs {
  public:
    /// All arguments must outlive it; `pipeline` may be replaced by another in the same place.
    Inputs(const DaemonRequest& request, const HostRig& rig, EventLoop& loop, Pipeline& pipeline,
           RecordRequests& recordings);
    Inputs(const Inputs&) = delete;
    Inputs& operator=(const Inputs&) = delete;

    /// Creates the joint socket, if one is requested.
    [[nodiscard]] Status<AppError> take_sockets(const HostRig& rig);
    /// From now on the loop delivers the inputs.
    void watch(const HostRig& rig);
    /// Switches to another rig: its filters, joints and cameras. First call `prepare_for`, with the pipeline
    /// of the former rig. Call this with the pipeline of the new rig.
    void change_rig(const HostRig& rig);
    /// Prepares for the next rig: waiting inputs go into the pipeline, joint states first. Cameras that the
    /// rig uses in another mode, or not at all, are released, and their waiting frames go into the pipeline,
    /// too.
    void prepare_for(const HostRig& rig);

    /// Called twenty times a second: opens what is closed, and sends SYNC when it is due.
    void attend();
    /// Takes every frame that has arrived, so that no sender seems silent because its frames were not read.
    void catch_up();

    [[nodiscard]] const CanLink& can() const noexcept { return can_; }
    /// How long the frames of this rig, received or sent, have kept the bus busy, with the maximum of stuff
    /// bits. The kernel filters out frames of others.
    [[nodiscard]] Nanoseconds bus_busy() const noexcept { return bus_busy_; }
    /// Null without a socket.
    [[nodiscard]] const JointSocket* joints() const noexcept { return joints_ ? &*joints_ : nullptr; }
    /// Samples of the socket that were left out because they followed the one before too soon.
    [[nodiscard]] std::uint64_t joints_thinned() const noexcept { return joints_thinned_; }
    /// Samples of the socket that came while several programs were sending samples.
    [[nodiscard]] std::uint64_t joints_of_several() const noexcept { return joints_of_several_; }
    /// Datagrams of the socket that newer ones displaced: the loop was delayed, or too many arrived.
    [[nodiscard]] std::uint64_t joints_displaced() const;
    /// Datagrams were displaced within the last 2 s, or exceeded the share of one program.
    [[nodiscard]] bool is_flooded(HostTime now) const;
    /// Frames on the bus of joint nodes whose joint states come through the socket.
    [[nodiscard]] std::uint64_t joint_node_ignored() const noexcept { return joint_node_ignored_; }
    /// Of each camera in the rig's order; empty without one. `untimed` includes the frames that came while
    /// another host's clock was not known.
    [[nodiscard]] std::vector<CameraRecord> cameras() const { return cameras_.records(); }
    /// The cameras, for the programs that feed some of them.
    [[nodiscard]] CameraInputs& camera_inputs() noexcept { return cameras_; }
    /// For readings that reached the map with a frame: the time since the arrival of that frame.
    [[nodiscard]] const LatencyHistogram& latency() const noexcept { return latency_; }
    /// For the same readings: the time since their capture.
    [[nodiscard]] const LatencyHistogram& age() const noexcept { return age_; }
    /// FOLLOW_UP frames of other hosts, ignored while this one sends its own.
    [[nodiscard]] std::uint64_t foreign_follow_ups() const noexcept { return foreign_follow_ups_; }
    /// Another host's newest SYNC or FOLLOW_UP, on this machine's clock.
    [[nodiscard]] std::optional<HostTime> foreign_sync() const noexcept { return foreign_sync_; }
    /// The bus time at `now`, on the clock that SYNC distributes; empty while it is not known.
    [[nodiscard]] std::optional<HostTime> bus_now(HostTime now) const { return bus_time_.at(now); }
    /// The same; while it is not known, continued by this machine's clock since it was last known.
    [[nodiscard]] HostTime reckoned_bus_now(HostTime now) const { return bus_time_.reckoned_at(now); }
    /// Nodes of the rig were active, and no longer are.
    [[nodiscard]] bool has_bus_fallen_silent(HostTime now) const { return bus_time_.has_fallen_silent(now); }
    /// The clock of the host that sends SYNC, while this one only listens.
    [[nodiscard]] const ForeignClock& foreign_clock() const noexcept { return foreign_clock_; }

  private:
    [[nodiscard]] std::vector<HostCamera> cameras_of(const HostRig& rig) const;
    /// False: its time on the bus clock is not known.
    bool take_depth(DepthFrame frame);
    /// False if there may be more frames.
    bool drain_can(int& datagrams_left);
    [[nodiscard]] bool is_of_node(const wire::CanFrame& frame) const;
    void take_frame(const socketcan::Received& received);
    [[nodiscard]] bool is_foreign_follow_up(const socketcan::Received& received) const;
    void exchange_alone();
    void answer_sync(const socketcan::Received& received, HostTime at);
    void hear_host(const socketcan::Received& received, HostTime at);
    void feed(const wire::CanFrame& frame, WallTime stamp);
    void note_host_frame(const wire::CanFrame& frame, WallTime stamp);
    void collect_joints(int& datagrams_left);
    [[nodiscard]] bool has_lost_its_place(const JointSample& sample) const;
    void note_displaced(HostTime now);
    [[nodiscard]] WallTime place_of(const JointSample& sample) const;
    void feed_joints(std::optional<WallTime> until);

    /// A source of joint states whose samples come through the socket.
    struct LocalSource {
        wire::NodeId node;
        double rate_hz;
        LocalJoints joints;
        JointBurst burst;
        std::deque<JointSample> waiting = {};  ///< until the CAN frames that arrived before them are taken
    };
    [[nodiscard]] LineJoints local_joints_of(const HostRig& rig) const;
    [[nodiscard]] std::vector<LocalSource> local_sources_of(const HostRig& rig) const;
    void change_local_sources(std::vector<LocalSource> sources);
    void report_local_joints(std::uint8_t sequence, HostTime at, WallTime stamp);
    [[nodiscard]] bool is_of_local_joints(const wire::CanFrame& frame) const;
    [[nodiscard]] bool are_waiting_full() const;
    [[nodiscard]] LocalSource* next_due(WallTime until, const std::vector<const LocalSource*>& held_back);
    void feed_oldest(LocalSource& source, JointBurst::Turn turn);

    const DaemonRequest& request_;
    EventLoop& loop_;
    Pipeline& pipeline_;
    RecordRequests& recordings_;
    EventSource can_ready_;  ///< declared before the link, which resets it before it closes a descriptor
    CanLink can_;
    SyncMaster sync_;
    std::vector<LocalSource> local_sources_;  ///< in the order of LineJoints::local
    std::optional<JointSocket> joints_;
    EventSource joints_ready_;
    bool has_joints_left_ = false;         ///< more arrived than one turn takes
    std::uint64_t joints_late_ = 0;        ///< left out: later frames are already used, or the rig changed
    std::optional<WallTime> rig_changed_;  ///< by a reload
    std::uint64_t displaced_noted_ = 0;
    std::optional<HostTime> displaced_at_;  ///< when displaced samples were noted last
    std::optional<WallTime> newest_stamp_;  ///< of the frames in the pipeline that are no joint samples
    CameraInputs cameras_;
    LatencyHistogram latency_;
    LatencyHistogram age_;
    wire::BitRates bit_rates_;
    Nanoseconds bus_busy_{0};
    std::uint64_t joints_thinned_ = 0;
    std::uint64_t joints_of_several_ = 0;
    std::uint64_t joint_node_ignored_ = 0;
    std::uint64_t foreign_follow_ups_ = 0;
    HostTime reported_;  ///< arrival of the newest frame of a node, which gives the pipeline the time
    std::optional<HostTime> foreign_sync_;
    ForeignClock foreign_clock_;
    BusTime bus_time_;
};

}  // namespace octoskin
