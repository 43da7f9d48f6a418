// What comes in beside a robot: CAN frames, joint states of this machine, depth frames. Each goes into the
// pipeline as it comes; what the bus asks of its host is answered.
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
#include "host/apps/daemon/camera_feed.hpp"
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
    /// All of these must outlive it; `pipeline` may be replaced by another in the same place.
    Inputs(const DaemonRequest& request, const HostRig& rig, EventLoop& loop, Pipeline& pipeline,
           RecordRequests& recordings);
    Inputs(const Inputs&) = delete;
    Inputs& operator=(const Inputs&) = delete;

    /// Makes the joint socket, if one is asked for.
    [[nodiscard]] Status<AppError> take_sockets(const HostRig& rig);
    /// From now on the loop brings what comes.
    void watch(const HostRig& rig);
    /// Another rig: its filters, joints and camera. The pipeline must be that rig's already, and this one
    /// told before, while the pipeline was the former one's.
    void change_rig(const HostRig& rig);
    /// That rig comes next: what waits goes into the pipeline, joint states first of all. A camera that it
    /// wants in another mode, or not at all, is let go of, and what it has shown goes there, too.
    void prepare_for(const HostRig& rig);

    /// Twenty times a second: opens what is closed, sends SYNC when it is due.
    void attend();
    /// Takes every frame that is here, so that nobody seems silent who only was not listened to.
    void catch_up();

    [[nodiscard]] const CanLink& can() const noexcept { return can_; }
    /// So long the frames of this rig that were heard or sent have kept the bus busy, with as many stuff bits
    /// as can be. Those of others the kernel keeps back.
    [[nodiscard]] Nanoseconds bus_busy() const noexcept { return bus_busy_; }
    /// Null without a socket.
    [[nodiscard]] const JointSocket* joints() const noexcept { return joints_ ? &*joints_ : nullptr; }
    /// Samples of the socket that came too soon after the one before.
    [[nodiscard]] std::uint64_t joints_thinned() const noexcept { return joints_thinned_; }
    /// Samples of the socket that came while several programs sent some.
    [[nodiscard]] std::uint64_t joints_of_several() const noexcept { return joints_of_several_; }
    /// Datagrams of the socket that gave way to newer ones: the loop was held up, or they are a flood.
    [[nodiscard]] std::uint64_t joints_displaced() const;
    /// Some have within the last 2 s, or were beyond what one program may send.
    [[nodiscard]] bool is_flooded(HostTime now) const;
    /// Frames of the rig's joint node on the bus, while the socket is the source.
    [[nodiscard]] std::uint64_t joint_node_ignored() const noexcept { return joint_node_ignored_; }
    /// Empty without a camera. Its `untimed` has those that came while another host's clock was not known.
    [[nodiscard]] std::optional<CameraRecord> camera() const;
    /// Of readings that came onto the map with a frame: since that frame was here.
    [[nodiscard]] const LatencyHistogram& latency() const noexcept { return latency_; }
    /// Of the same: since they were captured.
    [[nodiscard]] const LatencyHistogram& age() const noexcept { return age_; }
    /// FOLLOW_UP of other hosts, left out while this one sends its own.
    [[nodiscard]] std::uint64_t foreign_follow_ups() const noexcept { return foreign_follow_ups_; }
    /// Another host's newest SYNC or FOLLOW_UP, on this machine's clock.
    [[nodiscard]] std::optional<HostTime> foreign_sync() const noexcept { return foreign_sync_; }
    /// What time it is on the bus, on the clock that SYNC tells; empty while nobody knows.
    [[nodiscard]] std::optional<HostTime> bus_now(HostTime now) const { return bus_time_.at(now); }
    /// Where that is empty: by this machine's clock since it was last known.
    [[nodiscard]] HostTime reckoned_bus_now(HostTime now) const { return bus_time_.reckoned_at(now); }
    /// Nodes of the rig spoke, and do no more.
    [[nodiscard]] bool has_bus_fallen_silent(HostTime now) const { return bus_time_.has_fallen_silent(now); }
    /// Of the host that sends SYNC, while this one only listens.
    [[nodiscard]] const ForeignClock& foreign_clock() const noexcept { return foreign_clock_; }

  private:
    [[nodiscard]] std::optional<openni2::CameraMode> mode_for(const HostRig& rig) const;
    /// Opens the camera, once the one before is let go of; without a thread to be had, again in a second.
    void attend_camera();
    void take_depth(DepthFrame frame);
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
    void drain_camera();

    const DaemonRequest& request_;
    EventLoop& loop_;
    Pipeline& pipeline_;
    RecordRequests& recordings_;
    EventSource can_ready_;  ///< before the link: it must let go of a descriptor before that is closed
    CanLink can_;
    SyncMaster sync_;
    wire::NodeId joint_node_;
    LocalJoints local_joints_;
    JointBurst joint_burst_;
    std::optional<JointSocket> joints_;
    EventSource joints_ready_;
    std::deque<JointSample> joints_waiting_;  ///< for frames of the bus that came before them
    bool has_joints_left_ = false;            ///< more came than one turn takes
    std::uint64_t joints_late_ = 0;  ///< left out: later frames are in the pipeline, or another rig holds
    std::optional<WallTime> rig_changed_;  ///< by a reload
    std::uint64_t displaced_noted_ = 0;
    std::optional<HostTime> displaced_at_;  ///< when it was noted last that some were too many
    std::optional<WallTime> newest_stamp_;  ///< of frames in the pipeline that are no joint samples
    std::unique_ptr<CameraFeed> camera_;
    std::optional<openni2::CameraMode> camera_mode_;  ///< wanted; empty: no camera is
    std::unique_ptr<CameraFeed> camera_leaving_;      ///< of another mode; has the device a little longer
    CameraRecord camera_missing_;           ///< what there is to tell while one is wanted and none is open
    std::optional<HostTime> camera_tried_;  ///< last, in the mode that is wanted
    EventSource camera_ready_;
    LatencyHistogram latency_;
    LatencyHistogram age_;
    wire::BitRates bit_rates_;
    Nanoseconds bus_busy_{0};
    std::uint64_t joints_thinned_ = 0;
    std::uint64_t joints_of_several_ = 0;
    std::uint64_t joint_node_ignored_ = 0;
    std::uint64_t foreign_follow_ups_ = 0;
    HostTime told_;  ///< when the newest frame that tells the pipeline the time was here
    std::optional<HostTime> foreign_sync_;
    ForeignClock foreign_clock_;
    BusTime bus_time_;
    std::uint64_t depth_untimed_ = 0;  ///< frames that came while the other host's clock was not known
};

}  // namespace octoskin
