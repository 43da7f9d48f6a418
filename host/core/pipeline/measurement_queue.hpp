// The pipeline's first part: what was measured, from its arrival until all that was measured before it has
// had time to arrive. It decides which measurement is next, and refuses what comes too late or twice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "common/time.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/reorder_buffer.hpp"

namespace octoskin {

/// When a measurement that waits enters the map.
enum class Release : std::uint8_t {
    /// `lag` after it was captured, in the order (capture time, source): whatever order frames came in, the
    /// map is the same.
    by_capture_time,
    /// As soon as it is known where the robot was: a live map. Its bytes depend on the order of the calls.
    once_placed,
};

/// Bounds of what may wait; beyond, it is counted and dropped: the oldest, but the newest of depth frames:
/// those that wait have their joints.
struct QueueLimits {
    std::size_t readings = 4096;
    std::size_t depth_frames = 16;
    std::size_t joint_samples = 256;
};

class MeasurementQueue {
  public:
    MeasurementQueue(Release release, const QueueLimits& limits);

    /// Each returns why the measurement does not wait; empty: it does. O(log waiting). Of `queue_overflow` of
    /// readings and joint samples it was an older one that gave way.
    [[nodiscard]] std::optional<ReadingReason> put(const RangeMeasurement& measurement);
    [[nodiscard]] std::optional<JointReason> put(const JointMeasurement& joints);
    [[nodiscard]] std::optional<DepthReason> put(DepthFrame frame);
    /// Why a depth frame that arrives cannot wait, even if there is room; `now`: on the host's clock, if it
    /// is known. To be asked once, in the order of arrival: the next frame has to be newer.
    [[nodiscard]] std::optional<DepthReason> check_arrival(const DepthFrame& frame,
                                                           std::optional<HostTime> now);

    /// The oldest joint sample, if it was taken until then.
    [[nodiscard]] std::optional<JointMeasurement> take_joints(HostTime until);
    struct Next {
        ReleaseKey key;
        bool is_depth = false;
    };
    /// The oldest reading or, if depth frames are `wanted`, depth frame.
    [[nodiscard]] std::optional<Next> next(bool depth_wanted) const;
    /// The oldest, which must be there.
    [[nodiscard]] RangeMeasurement take_reading() { return readings_.pop(); }
    [[nodiscard]] DepthFrame take_depth() { return depth_frames_.pop(); }
    [[nodiscard]] std::optional<ReleaseKey> oldest_depth() const { return depth_frames_.front(); }

    /// It is in the maps: by capture time, what is older is late from now on.
    void on_used(const ReleaseKey& key) { newest_used_ = key; }
    /// The same of a reading: one of its source, captured at about the same time, is a duplicate.
    void on_used_reading(const BeamSource& source, HostTime captured) { used_[source] = captured; }

    /// Time leaps, and nothing waits (asserted): what was used before says nothing of what comes. `begin`:
    /// what was captured before that is late; empty: nothing is for that.
    void forget_time(std::optional<HostTime> begin);
    void begin_at(std::optional<HostTime> begin) { begin_ = begin; }
    [[nodiscard]] std::optional<HostTime> begin() const noexcept { return begin_; }

    [[nodiscard]] std::size_t readings() const noexcept { return readings_.size(); }
    [[nodiscard]] std::size_t depth_frames() const noexcept { return depth_frames_.size(); }
    [[nodiscard]] std::size_t joint_samples() const noexcept { return joint_samples_.size(); }
    [[nodiscard]] std::optional<HostTime> newest_depth() const noexcept { return newest_depth_; }

  private:
    [[nodiscard]] bool is_late(const ReleaseKey& key) const;
    [[nodiscard]] bool is_repeated(const ReleaseKey& key) const;

    Release release_;
    ReorderBuffer<JointMeasurement> joint_samples_;
    ReorderBuffer<RangeMeasurement> readings_;
    ReorderBuffer<DepthFrame> depth_frames_;
    std::optional<ReleaseKey> newest_used_;
    std::map<BeamSource, HostTime> used_;   ///< the newest reading of each source in the maps
    std::optional<HostTime> newest_depth_;  ///< that arrived
    std::optional<HostTime> begin_;         ///< after a leap ahead: what is earlier is of the time before
};

}  // namespace octoskin
