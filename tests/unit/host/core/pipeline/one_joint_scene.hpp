// A robot of one joint, small enough to know by heart, and ten seconds of its life on the bus.
//
// Base: a column of radius 0.05 m on the z axis. Joint about z, at pi/2 (sensor looks along +y), except
// from 3.405 to 3.605 s: it turns at 8 rad/s and passes pi/2 at 3.505 s. The arm is a capsule about x
// 0.08..0.14 m; sensors sit at x = 0.12 m and look along the arm's +x. The map's origin is at (-0.02, -0.02,
// -0.02) in the base frame, so that the axes run through the middle of voxels of 0.04 m.
//
// On the bus: SYNC at 0.1, 1.1, ... 8.1 s; joints at 100 Hz from 0.5 to 9 s, none between 7.0 and 7.3 s; node
// 1 is well and its sensor 0 gives ten good readings, the first captured at 3.505 s. Nodes 2 and 3 are in the
// rig and silent.
#pragma once

#include <string>
#include <vector>

#include "host/core/depth/depth_source.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/pipeline/replay.hpp"
#include "host/core/rig/host_rig.hpp"
#include "tests/support/bus/scripted_bus.hpp"

namespace octoskin::test {

inline constexpr wire::NodeId kLeft = 1;   ///< well
inline constexpr wire::NodeId kRight = 2;  ///< hears SYNC; sends nothing else; the rig pins build 77
inline constexpr wire::NodeId kThird = 3;  ///< does not even hear SYNC
inline constexpr wire::NodeId kJoints = 10;

// Sensors of kLeft.
inline constexpr std::uint8_t kGood = 0;
inline constexpr std::uint8_t kInward = 1;    ///< looks at the column
inline constexpr std::uint8_t kLostPose = 2;  ///< extrinsics are NaN
inline constexpr std::uint8_t kFar = 3;       ///< 2 km away: outside the octree
inline constexpr std::uint8_t kNoOffset = 4;  ///< its zone offset is NaN
inline constexpr std::uint8_t kSpare = 5;     ///< as kGood, silent

[[nodiscard]] HostRig one_joint_rig();
[[nodiscard]] RobotModel one_joint_robot();
[[nodiscard]] double angle_at(double t_s);

/// Paper's equations, no filter: every term is known in advance.
[[nodiscard]] MappingConfig plain_mapping();

/// A depth frame of the rig's camera, the same value everywhere.
[[nodiscard]] DepthFrame flat_frame(double captured_s, std::uint16_t depth_mm = 1500);

class ScriptedDepth final : public DepthSource {
  public:
    explicit ScriptedDepth(std::vector<DepthFrame> frames) : frames_(std::move(frames)) {}
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override {
        return next_ < frames_.size() ? std::optional(frames_[next_++]) : std::nullopt;
    }

  private:
    std::vector<DepthFrame> frames_;
    std::size_t next_ = 0;
};

/// 520 mm, valid.
[[nodiscard]] wire::RangeReading good_reading(std::uint8_t sensor = kGood);

struct Scene {
    HostRig rig = one_joint_rig();
    ScriptedBus bus;
    std::vector<DepthFrame> depth;
    MappingConfig mapping = plain_mapping();
    PipelineConfig config;
};
/// As described at the top, and depth frames at 4.0, 4.1, ... 4.5 s.
[[nodiscard]] Scene good_scene();
/// Heartbeats, NODE_INFO and SENSOR_HEALTH of a node, from `from_s` to 9 s.
void keep_alive(Scene& scene, wire::NodeId node, double from_s = 0.0);
[[nodiscard]] const HostNode& node_of(const Scene& scene, wire::NodeId node);

/// What came out, and the maps as .ot files.
struct RunResult {
    PipelineInputs inputs;
    std::string depth_ot;
    std::string proximity_ot;
    std::string fused_ot;
    ReplayOutcome outcome;
    std::string inputs_text;
    [[nodiscard]] bool has_equal_maps(const RunResult& other) const {
        return depth_ot == other.depth_ot && proximity_ot == other.proximity_ot && fused_ot == other.fused_ot;
    }
};
[[nodiscard]] Pipeline make_pipeline(const Scene& scene);
/// Replays the scene; expects the accounts to balance at every 1000th frame and at the end.
[[nodiscard]] RunResult run(const Scene& scene);
[[nodiscard]] RunResult run(const Scene& scene, std::vector<StampedFrame> frames);

}  // namespace octoskin::test
