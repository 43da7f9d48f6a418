// The inputs of the maps, in the order in which they are applied.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/beams/range_measurement.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/pipeline/fed_map.hpp"

namespace octoskin {

/// A depth frame without its pixels, which are in a recording of its camera's depth frames.
struct DepthCommit {
    std::optional<std::uint64_t> index;  ///< its index in that recording, from 0; empty: not recorded
    HostTime captured;
    std::uint8_t camera = 0;  ///< index in HostRig::cameras
    friend bool operator==(const DepthCommit&, const DepthCommit&) = default;
};

/// Total time, in whole seconds, that has passed while a saved map waits for its first measurement.
struct WaitCommit {
    std::int64_t seconds = 0;
    friend bool operator==(const WaitCommit&, const WaitCommit&) = default;
};

/// A joint sample added to the history, a reading or frame that was integrated, or time that aged the map
/// without an input.
using Commit = std::variant<JointMeasurement, RangeMeasurement, DepthCommit, WaitCommit>;

/// Called for each input after it was applied, except `on_time`. References are valid during the call only.
class CommitListener {
  public:
    virtual ~CommitListener() = default;
    /// In a replay: the fused map continues from this one, before any input. Not called if it is empty.
    virtual void on_begin(const FusedMap&) {}
    /// The maps' time has advanced to that of the next reading or frame, which is not applied yet: old voxels
    /// have expired. Empty: after a wait, following `on_wait`.
    virtual void on_time(std::optional<HostTime>, std::span<const FedMap>) {}
    virtual void on_joints(const JointMeasurement& joints) = 0;
    virtual void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                            std::span<const VoxelUpdate> updates) = 0;
    virtual void on_depth(const DepthFrame& frame, const Evidence& terms) = 0;
    /// The map of all sensors has aged: MapBuilder::wait.
    virtual void on_wait(const WaitCommit&) {}
    /// Called after each reading and frame, and after the calls about it.
    virtual void on_maps(std::span<const FedMap>) {}
    /// An exception has left an input while it was applied, or before the listener was notified of it: the
    /// maps may have a part of it or all of it. No other call about this input follows.
    virtual void on_broken_off() noexcept {}
    /// Time jump: later inputs are from before the earlier ones or far ahead of them, or the machine slept. A
    /// replay in this order ends here.
    virtual void on_time_jump() {}
};

}  // namespace octoskin
