// First part of the pipeline: holds measurements until everything measured before them has had time to
// arrive. Decides which measurement is next, and refuses late and repeated ones.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/reorder_buffer.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// When a waiting measurement enters the map.
enum class Release : std::uint8_t {
    /// `lag` after its capture, in the order (capture time, source): the map does not depend on the order of
    /// arrival.
    by_capture_time,
    /// As soon as the robot's pose is known: a live map. Its bytes depend on the order of the calls.
    once_placed,
};

/// Maximum number of waiting inputs; of depth frames, of each camera. Beyond it, the oldest input is dropped
/// and counted. Of depth frames, the newest is dropped, because those that wait already have their joint
/// samples.
struct QueueLimits {
    std::size_t readings = 4096;
    std::size_t depth_frames = 16;
    std::size_t joint_samples = 256;
};

/// Some cameras of a rig, by their indices.
using CameraSet = std::bitset<kCamerasMax>;

class MeasurementQueue {
  public:
    /// `cameras`: their names. Frames of one capture time are in the order of these: the order of the rig
    /// does not matter.
    MeasurementQueue(Release release, const QueueLimits& limits, std::span<const std::string> cameras);

    /// Each returns why the measurement does not wait; empty: it waits. O(log waiting). For readings and
    /// joint samples, `queue_overflow` means that an older one was dropped.
    [[nodiscard]] std::optional<ReadingReason> put(const RangeMeasurement& measurement);
    [[nodiscard]] std::optional<JointReason> put(const JointMeasurement& joints);
    [[nodiscard]] std::optional<DepthReason> put(DepthFrame frame);
    /// Why an arriving depth frame cannot wait, even if there is room. `now`: host time, if known. Call once
    /// for each frame, in order of arrival: the next frame of that camera must be newer. The camera must
    /// exist (asserted, as for `put`).
    [[nodiscard]] std::optional<DepthReason> check_arrival(const DepthFrame& frame,
                                                           std::optional<HostTime> now);

    /// The oldest joint sample, if it was taken at or before `until`.
    [[nodiscard]] std::optional<JointMeasurement> take_joints(HostTime until);
    struct Next {
        ReleaseKey key;
        std::optional<std::size_t> camera = {};  ///< of a depth frame; empty: a reading
    };
    /// The oldest reading or depth frame of the cameras in `wanted`. O(cameras).
    [[nodiscard]] std::optional<Next> next(CameraSet wanted) const;
    /// The oldest one, which must exist.
    [[nodiscard]] RangeMeasurement take_reading() { return readings_.pop(); }
    [[nodiscard]] DepthFrame take_depth(std::size_t camera) { return cameras_.at(camera).frames.pop(); }
    [[nodiscard]] std::optional<Next> oldest_depth(std::size_t camera) const;

    /// This measurement is in the maps. With release by capture time, older ones are late from now on.
    void on_used(const ReleaseKey& key) { newest_used_ = key; }
    /// This reading is in the maps: another one of its source with about the same capture time is a
    /// duplicate.
    void on_used_reading(const BeamSource& source, HostTime captured) { used_[source] = captured; }

    /// Time jump while nothing waits (asserted): clears what was used before. `begin`: earlier captures are
    /// late; empty: none is.
    void forget_time(std::optional<HostTime> begin);
    void begin_at(std::optional<HostTime> begin) { begin_ = begin; }
    [[nodiscard]] std::optional<HostTime> begin() const noexcept { return begin_; }

    [[nodiscard]] std::size_t readings() const noexcept { return readings_.size(); }
    [[nodiscard]] std::size_t depth_frames(std::size_t camera) const {
        return cameras_.at(camera).frames.size();
    }
    [[nodiscard]] std::size_t joint_samples() const noexcept { return joint_samples_.size(); }
    [[nodiscard]] std::optional<HostTime> newest_depth(std::size_t camera) const {
        return cameras_.at(camera).newest;
    }

  private:
    [[nodiscard]] ReleaseKey key_of(const DepthFrame& frame) const;

    struct Camera {
        ReorderBuffer<DepthFrame> frames;
        std::uint8_t rank = 0;                ///< by name
        std::optional<HostTime> newest = {};  ///< the newest that arrived
    };
    [[nodiscard]] bool is_late(const ReleaseKey& key) const;
    [[nodiscard]] bool is_repeated(const ReleaseKey& key) const;

    Release release_;
    ReorderBuffer<JointMeasurement> joint_samples_;
    ReorderBuffer<RangeMeasurement> readings_;
    std::vector<Camera> cameras_;
    std::optional<ReleaseKey> newest_used_;
    std::map<BeamSource, HostTime> used_;  ///< the newest reading of each source in the maps
    std::optional<HostTime> begin_;        ///< after a jump ahead: earlier captures are from before the jump
};

}  // namespace octoskin
