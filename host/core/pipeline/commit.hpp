// What the maps are made of, in the order in which it goes in.
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

/// A depth frame, told apart from the pixels, which are in a recording of depth frames.
struct DepthCommit {
    std::optional<std::uint64_t> index;  ///< its place in that recording, from 0; empty: it is not there
    HostTime captured;
    friend bool operator==(const DepthCommit&, const DepthCommit&) = default;
};

/// So many seconds passed, in all, while a map that was saved waits for its first measurement.
struct WaitCommit {
    std::int64_t seconds = 0;
    friend bool operator==(const WaitCommit&, const WaitCommit&) = default;
};

/// A joint sample that was taken into the history, a reading or frame that was integrated, or time by which
/// the map grew older without one.
using Commit = std::variant<JointMeasurement, RangeMeasurement, DepthCommit, WaitCommit>;

/// Learns of each after it went in, but for `on_time`. What it is given is valid during the call only.
class CommitListener {
  public:
    virtual ~CommitListener() = default;
    /// Of a replay: the fused map goes on from this one, before anything went in. Not told if it is empty.
    virtual void on_begin(const FusedMap&) {}
    /// The maps' time has gone on, to that of the reading or frame of which nothing has gone in yet: what was
    /// too old has expired. Empty: by a wait, after `on_wait`.
    virtual void on_time(std::optional<HostTime>, std::span<const FedMap>) {}
    virtual void on_joints(const JointMeasurement& joints) = 0;
    virtual void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                            std::span<const VoxelUpdate> updates) = 0;
    virtual void on_depth(const DepthFrame& frame, const Evidence& terms) = 0;
    /// The map of all sensors grew older: MapBuilder::wait.
    virtual void on_wait(const WaitCommit&) {}
    /// After each reading and frame, and after what was told of it.
    virtual void on_maps(std::span<const FedMap>) {}
    /// What comes next has another time, from before what came so far or far ahead of it, or the
    /// machine slept: a replay in this order ends here.
    virtual void on_time_leap() {}
};

}  // namespace octoskin
