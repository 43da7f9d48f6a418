// The one declaration of each key of a rig file and of a board's file.
#pragma once

#include <array>
#include <span>

#include "common/config/node_config.hpp"
#include "common/config/verified_registers.hpp"
#include "common/wire/messages.hpp"
#include "hw/rigfile/key.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// All tables of a rig in the order of docs/rig.md. Each declared key is in one of them; the poses of a
/// sensor lack the last key of those of a camera.
[[nodiscard]] std::span<const KeyTable> rig_key_tables() noexcept;

namespace keys {

/// The keys of each table; the namespace below with its name has their declarations.
extern const KeyTable kTop;
extern const KeyTable kRobot;
extern const KeyTable kAttachedCapsule;
extern const KeyTable kPose;
extern const KeyTable kCameraPose;
extern const KeyTable kBus;
extern const KeyTable kRangeLimits;
extern const KeyTable kJoints;
extern const KeyTable kCamera;
extern const KeyTable kDataSet;
extern const KeyTable kDistortion;
extern const KeyTable kNode;
extern const KeyTable kVerification;
extern const KeyTable kSensor;
extern const KeyTable kZone;
extern const KeyTable kCone;
extern const KeyTable kBoard;

inline constexpr Range<std::int64_t> kNodeId{1, kUnconfiguredNodeId - 1};
/// Greatest distance of a part of the rig from its base, per coordinate.
inline constexpr double kRoomReach_m = 100.0;
inline constexpr Range<double> kSelfMargin_m{0.0, 1.0};
inline constexpr Range<double> kPadding_m{0.0, 0.5};

inline constexpr TextKey kName{
    .path = "name", .kind = TextKind::folder_name, .meaning = "the rig's name, for messages and recordings"};
inline constexpr TextKey kExtends{
    .path = "extends",
    .kind = TextKind::path,
    .fallback = {.text = "none"},
    .meaning = "another rig file, taken first; this file's keys are laid over it ([below](#extends))"};
inline constexpr TableKey kRobotTable{.path = "robot", .meaning = "[the robot and its self-filter](#robot)"};
inline constexpr TableKey kMapBase{.path = "T_map_base",
                                   .expected = "a [pose](#poses)",
                                   .fallback = {.text = "identity"},
                                   .meaning = "pose of the robot's base link in the map"};
inline constexpr TableKey kBusTable{.path = "bus", .meaning = "[the CAN bus](#bus)"};
inline constexpr TableKey kRangeLimitsTable{.path = "range_limits",
                                            .fallback = {.text = "its defaults"},
                                            .meaning = "[limits](#range_limits) that every range must keep"};
inline constexpr TableKey kJointsTable{.path = "joints",
                                       .meaning = "[the sender of joint positions](#joints)"};
inline constexpr TableKey kCameraTable{.path = "camera",
                                       .fallback = {.text = "none"},
                                       .meaning =
                                           "[the external depth camera](#camera); without it the map "
                                           "is made from ranges alone"};
inline constexpr TableKey kSensorDefaults{
    .path = "sensor_defaults",
    .fallback = {.text = "none"},
    .meaning =
        "any keys of a [sensor](#sensors-and-sensor_defaults), defaults for every sensor of every "
        "node"};
inline constexpr ListKey kNodes{
    .path = "nodes", .items = "nodes", .count = {1, 61}, .meaning = "[the boards](#nodes)"};

namespace robot {
inline constexpr TextKey kUrdf{.path = "robot.urdf",
                               .kind = TextKind::path,
                               .meaning = "the robot's URDF: links, joints, collision bodies"};
inline constexpr TextKey kBaseLink{
    .path = "robot.base_link",
    .kind = TextKind::element_name,
    .meaning = "frame of `T_map_base` and the camera's pose; only links at or below it count"};
inline constexpr NumberKey kLinkPadding{
    .path = "robot.link_padding_m{}",
    .unit = "m",
    .range = kPadding_m,
    .fallback = {.text = "none"},
    .meaning = "by the name of a link: added to the radius of that link's capsules"};
inline constexpr FlagKey kFitsCapsules{
    .path = "robot.fits_capsules",
    .fallback = {false},
    .meaning =
        "a `<collision>` box becomes the capsule about its longest side through its corners; else it "
        "is refused"};
inline constexpr ListKey kAttachedCapsules{
    .path = "robot.attached_capsules",
    .items = "capsules",
    .count = {0, 64},
    .fallback = {.text = "none"},
    .meaning = "[attached bodies](#attached-capsules): tool, grasped object, cable"};
inline constexpr ListKey kLinksWithoutBody{
    .path = "robot.links_without_body",
    .items = "links",
    .fallback = {.text = "none"},
    .meaning =
        "[links without a body](#links-without-a-body) on purpose; no name twice, none with a body "
        "that counts"};
inline constexpr ListKey kLinksIgnoredBySensors{
    .path = "robot.links_ignored_by_sensors",
    .items = "links",
    .fallback = {.text = "none"},
    .meaning = "links left out of the prediction that a beam meets the robot: the sensor's mount"};
inline constexpr NumberKey kDepthSelfMargin{
    .path = "robot.depth_self_margin_m",
    .unit = "m",
    .range = kSelfMargin_m,
    .fallback = {kDepthSelfMarginDefault_m},
    .meaning = "depth points this close to a capsule's surface, or inside it, are the robot"};
inline constexpr NumberKey kRangeSelfMargin{
    .path = "robot.range_self_margin_m",
    .unit = "m",
    .range = kSelfMargin_m,
    .fallback = {kRangeSelfMarginDefault_m},
    .meaning = "ranges longer than the predicted distance to the robot less this are dropped"};
}  // namespace robot

namespace capsule {
/// A larger coordinate is probably in millimetres.
inline constexpr Range<double> kReach_m{-2.0, 2.0};
inline constexpr TextKey kName{.path = "robot.attached_capsules[].name", .meaning = "unique"};
inline constexpr TextKey kLink{
    .path = "robot.attached_capsules[].link",
    .kind = TextKind::element_name,
    .meaning =
        "link that carries it, at or below `base_link`; if sensors ignore that link, they ignore this "
        "too"};
inline constexpr NumbersKey kFrom{.path = "robot.attached_capsules[].from_m",
                                  .unit = "m",
                                  .range = kReach_m,
                                  .meaning = "one end of its axis in the link's frame"};
inline constexpr NumbersKey kTo{.path = "robot.attached_capsules[].to_m",
                                .unit = "m",
                                .range = kReach_m,
                                .fallback = {.text = "`from_m`"},
                                .meaning = "the other end; without it the capsule is a ball"};
inline constexpr NumberKey kRadius{.path = "robot.attached_capsules[].radius_m",
                                   .unit = "m",
                                   .range = {0.001, 1.0},
                                   .meaning = "its radius"};
inline constexpr NumberKey kPadding{
    .path = "robot.attached_capsules[].padding_m",
    .unit = "m",
    .range = kPadding_m,
    .fallback = {0.0},
    .meaning = "added by the host, beside the link's padding; the simulator uses the real radius"};
}  // namespace capsule

/// Of `T_map_base`, `camera.pose` and `nodes[].sensors[].pose`.
namespace pose {
/// Of a sensor in its link. A larger coordinate is probably in millimetres.
inline constexpr double kSensorReach_m = 2.0;
inline constexpr double kQuaternionTolerance = 1e-6;
inline constexpr double kMatrixTolerance = 1e-9;
inline constexpr NumbersKey kPosition{.path = "pose.xyz_m",
                                      .unit = "m",
                                      .range = {-kRoomReach_m, kRoomReach_m},
                                      .meaning = "`[x, y, z]`; of a sensor from -2 to 2"};
inline constexpr NumbersKey kRollPitchYaw{
    .path = "pose.rpy_deg",
    .unit = "deg",
    .range = {-360.0, 360.0},
    .fallback = {.text = "one of these four"},
    .meaning = "`[roll, pitch, yaw]` about the parent's fixed x, then y, then z, as in URDF"};
inline constexpr NumbersKey kQuaternion{.path = "pose.quaternion_wxyz",
                                        .count = 4,
                                        .range = {-2.0, 2.0},
                                        .fallback = {.text = "one of these four"},
                                        .meaning = "of length 1 within 1e-6"};
inline constexpr TableKey kRotationRows{
    .path = "pose.rotation_rows",
    .expected = "3 rows of 3 numbers",
    .fallback = {.text = "one of these four"},
    .meaning = "the rotation matrix, orthonormal within 1e-9. Exact to the last bit; recordings use it"};
inline constexpr NumbersKey kLookingAt{
    .path = "pose.looking_at_m",
    .unit = "m",
    .range = {-kRoomReach_m, kRoomReach_m},
    .fallback = {.text = "one of these four"},
    .meaning = "cameras only: a point on the optical axis; the picture is upright (base +z is up)"};
}  // namespace pose

namespace bus {
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kProtocols{
    {{"can", false}, {"can_fd", true}}};
inline constexpr Range<std::int64_t> kBitrate_bps{1, 8'000'000};
inline constexpr std::array<std::int64_t, 4> kNominalBitrates_bps{125'000, 250'000, 500'000, 1'000'000};
inline constexpr std::array<std::int64_t, 5> kDataBitrates_bps{1'000'000, 2'000'000, 4'000'000, 5'000'000,
                                                               8'000'000};
/// The meaning of its words: uses CAN FD.
inline constexpr WordKey<bool> kProtocol{.path = "bus.protocol",
                                         .words = kProtocols,
                                         .meaning = "classical CAN or CAN FD",
                                         .is_in_node_block = true};
inline constexpr IntegerKey kNominalBitrate{.path = "bus.nominal_bitrate_bps",
                                            .unit = "bit/s",
                                            .range = kBitrate_bps,
                                            .values = kNominalBitrates_bps,
                                            .meaning = "bit rate",
                                            .is_in_node_block = true};
inline constexpr IntegerKey kDataBitrate{
    .path = "bus.data_bitrate_bps",
    .unit = "bit/s",
    .range = kBitrate_bps,
    .values = kDataBitrates_bps,
    .fallback = {.text = "none"},
    .meaning = "bit rate of the data phase; required with `can_fd`, refused with `can`",
    .is_in_node_block = true};
}  // namespace bus

namespace range_limits {
inline constexpr Range<double> kRange_m{0.0, 8.0};
inline constexpr NumberKey kMin{.path = "range_limits.min_m",
                                .unit = "m",
                                .range = kRange_m,
                                .fallback = {RangeLimits{}.min_m},
                                .meaning = "shorter ranges are rejected"};
inline constexpr NumberKey kMax{.path = "range_limits.max_m",
                                .unit = "m",
                                .range = kRange_m,
                                .fallback = {RangeLimits{}.max_m},
                                .meaning = "longer ranges are rejected; more than `min_m`"};
inline constexpr NumberKey kSigmaMax{.path = "range_limits.sigma_max_m",
                                     .unit = "m",
                                     .range = {0.001, 1.0},
                                     .fallback = {RangeLimits{}.sigma_max_m},
                                     .meaning = "ranges with a larger sigma from the sensor are rejected"};
/// SENSOR_HEALTH reports a bound of up to 16.32 ms, which also stands for all greater values. The limit must
/// be below it.
inline constexpr NumberKey kTimeUncertaintyMax{
    .path = "range_limits.time_uncertainty_max_ms",
    .unit = "ms",
    .range = {0.1, 16.0},
    .fallback = {RangeLimits{}.time_uncertainty_max_ms},
    .meaning = "readings whose capture time may be further off are rejected (`time_uncertain`)"};
}  // namespace range_limits

namespace joints {
inline constexpr IntegerKey kNodeId{.path = "joints.node_id",
                                    .range = keys::kNodeId,
                                    .meaning = "an id of its own: the sender of joint states"};
inline constexpr ListKey kNames{
    .path = "joints.names",
    .items = "joints",
    .count = {1, wire::kJointsPerSample},
    .meaning = "URDF joints in the order on the wire, every moving joint below the base link"};
inline constexpr NumberKey kRate{
    .path = "joints.rate_hz", .unit = "Hz", .range = {1.0, 1000.0}, .meaning = "samples a second"};
}  // namespace joints

namespace camera {
inline constexpr std::int64_t kSideMax_px = 4096;
inline constexpr Range<double> kFocalLength_px{1.0, 100'000.0};
inline constexpr Range<double> kDepth_m{0.0, kDepthLargest_m};
inline constexpr IntegerKey kWidth{.path = "camera.width_px",
                                   .unit = "px",
                                   .range = {1, kSideMax_px},
                                   .meaning =
                                       "of a live camera, width and height of one of its modes "
                                       "(`octoskin cameras`), which is then set"};
inline constexpr IntegerKey kHeight{
    .path = "camera.height_px", .unit = "px", .range = {1, kSideMax_px}, .meaning = "as above"};
inline constexpr NumberKey kFx{
    .path = "camera.fx_px", .unit = "px", .range = kFocalLength_px, .meaning = "focal length"};
inline constexpr NumberKey kFy{
    .path = "camera.fy_px", .unit = "px", .range = kFocalLength_px, .meaning = "focal length"};
inline constexpr NumberKey kCx{
    .path = "camera.cx_px",
    .unit = "px",
    .range = {0.0, kSideMax_px},
    .meaning = "principal point, at most the width; a pixel's centre is at its index plus 0.5"};
inline constexpr NumberKey kCy{.path = "camera.cy_px",
                               .unit = "px",
                               .range = {0.0, kSideMax_px},
                               .meaning = "principal point, at most the height"};
inline constexpr TableKey kDistortion{
    .path = "camera.distortion",
    .fallback = {.text = "none"},
    .meaning = "[lens distortion](#distortion), model of Brown and Conrady"};
inline constexpr NumberKey kRate{
    .path = "camera.rate_hz", .unit = "Hz", .range = {0.1, 1000.0}, .meaning = "frames a second"};
inline constexpr NumberKey kDepthMin{.path = "camera.depth_min_m",
                                     .unit = "m",
                                     .range = kDepth_m,
                                     .fallback = {kDepthMinDefault_m},
                                     .meaning = "smaller depths, along the optical axis, are no value"};
inline constexpr NumberKey kDepthMax{
    .path = "camera.depth_max_m",
    .unit = "m",
    .range = kDepth_m,
    .fallback = {kDepthMaxDefault_m},
    .meaning = "larger depths are no value; more than `depth_min_m`. Images have 16 bits, millimetres"};
inline constexpr TableKey kDataSet{
    .path = "camera.data_set",
    .fallback = {.text = "as its layout has it"},
    .meaning = "of a [data set](how-to/record-and-replay.md#replay-a-public-data-set): keys below"};
inline constexpr TableKey kPose{.path = "camera.pose",
                                .expected = "a [pose](#poses)",
                                .meaning =
                                    "T_base_camera of the optical frame: z forward, x right, y down. "
                                    "Images are never mirrored"};
}  // namespace camera

namespace data_set {
inline constexpr NumberKey kDepthUnits{.path = "camera.data_set.depth_units_per_m",
                                       .unit = "1/m",
                                       .range = {1.0, 1e6},
                                       .fallback = {.text = "as the layout has it"},
                                       .meaning = "units per 1 m along the optical axis in its images"};
inline constexpr IntegerKey kDepthNoValue{.path = "camera.data_set.depth_no_value",
                                          .range = {0, 65'535},
                                          .fallback = {.text = "as the layout has it"},
                                          .meaning = "number of a pixel without depth"};
inline constexpr NumberKey kPoseGapMax{.path = "camera.data_set.pose_gap_max_ms",
                                       .unit = "ms",
                                       .range = {1.0, 10'000.0},
                                       .fallback = {DataSetKeys{}.pose_gap_max_ms},
                                       .meaning = "no pose between two poses farther apart than this"};
}  // namespace data_set

/// For cameras with a view of 60 degrees |k| is below 4 and |p| below 0.02; a long lens has larger values.
namespace distortion {
inline constexpr Range<double> kRadial{-1000.0, 1000.0};
inline constexpr Range<double> kTangential{-1.0, 1.0};
inline constexpr NumberKey kK1{
    .path = "camera.distortion.k1", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
inline constexpr NumberKey kK2{
    .path = "camera.distortion.k2", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
inline constexpr NumberKey kP1{
    .path = "camera.distortion.p1", .range = kTangential, .fallback = {0.0}, .meaning = "tangential"};
inline constexpr NumberKey kP2{
    .path = "camera.distortion.p2", .range = kTangential, .fallback = {0.0}, .meaning = "tangential"};
inline constexpr NumberKey kK3{
    .path = "camera.distortion.k3", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
}  // namespace distortion

namespace node {
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kIoLevels{{{"2v8", true}, {"1v8", false}}};
inline constexpr std::array<std::pair<std::string_view, StreamGate>, 3> kStreamGates{
    {{"off", StreamGate::off}, {"differs", StreamGate::differs}, {"advanced", StreamGate::advanced}}};
inline constexpr TextKey kName{.path = "nodes[].name", .kind = TextKind::folder_name, .meaning = "unique"};
inline constexpr IntegerKey kNodeId{.path = "nodes[].node_id",
                                    .range = keys::kNodeId,
                                    .meaning = "unique, not that of `joints`",
                                    .is_in_node_block = true};
inline constexpr TableKey kBoard{.path = "nodes[].board",
                                 .expected = "a path or a table",
                                 .meaning =
                                     "a file in `hw/boards/`, or that file's [table](#boards) written "
                                     "out"};
inline constexpr IntegerKey kI2cHz{.path = "nodes[].i2c_hz",
                                   .unit = "Hz",
                                   .range = {10'000, 400'000},
                                   .fallback = {NodeConfig{}.i2c_hz},
                                   .meaning = "clock of all its I2C buses",
                                   .is_in_node_block = true};
/// The meaning of its words: pulled up to AVDD.
inline constexpr WordKey<bool> kIoLevel{
    .path = "nodes[].io_level",
    .words = kIoLevels,
    .fallback = {true},
    .meaning = "pull-up voltage of the sensors' I/O: `2v8` (AVDD, 2.6..3.5 V) or `1v8`",
    .is_in_node_block = true};
inline constexpr FlagKey kReadsTwice{
    .path = "nodes[].reads_twice",
    .fallback = {NodeConfig{}.reads_twice},
    .meaning = "the result block is read twice and must agree: I2C has no checksum",
    .is_in_node_block = true};
inline constexpr WordKey<StreamGate> kStreamGate{.path = "nodes[].stream_gate",
                                                 .words = kStreamGates,
                                                 .fallback = {NodeConfig{}.stream_gate},
                                                 .meaning = "check of the sensor's stream count (below)",
                                                 .is_in_node_block = true};
inline constexpr IntegerKey kAuxEvery{
    .path = "nodes[].aux_every",
    .range = {0, 255},
    .fallback = {NodeConfig{}.aux_every},
    .meaning = "classical CAN: signal and ambient with every n-th reading; 0 is never",
    .is_in_node_block = true};
inline constexpr IntegerKey kZoneGuard{.path = "nodes[].zone_guard_us",
                                       .unit = "us",
                                       .range = {0, 20'000},
                                       .fallback = {NodeConfig{}.zone_guard_us},
                                       .meaning = "guard time of a zone write (below)",
                                       .is_in_node_block = true};
inline constexpr FlagKey kHoldsPhases{
    .path = "nodes[].holds_phases",
    .fallback = {NodeConfig{}.holds_phases},
    .meaning = "restarts sensors that leave their [phase](#phases); costs about 3 readings of 100",
    .is_in_node_block = true};
inline constexpr IntegerKey kDataReadyBuses{
    .path = "nodes[].data_ready_buses[]",
    .range = {0, kNodeBusesMax - 1},
    .fallback = {.text = "none"},
    .meaning = "buses with a wired [data-ready line](hardware/wiring.md#data-ready), as `[0, 2]`",
    .is_in_node_block = true};
inline constexpr IntegerKey kReadyJitter{
    .path = "nodes[].ready_jitter_us",
    .unit = "us",
    .range = {kReadyJitterMinUs, kReadyJitterMaxUs},
    .fallback = {NodeConfig{}.ready_jitter_us},
    .meaning = "by how much the length of a sensor's ranges may differ ([below](#ranges-of-any-length))",
    .is_in_node_block = true};
inline constexpr TableKey kVerification{.path = "nodes[].verification",
                                        .fallback = {.text = "all registers"},
                                        .meaning = "registers that are read back and compared (below)",
                                        .is_in_node_block = true};
inline constexpr FlagKey kRefusesCommands{.path = "nodes[].refuses_commands",
                                          .fallback = {NodeConfig{}.refuses_commands},
                                          .meaning = "the node refuses each COMMAND, from any sender (below)",
                                          .is_in_node_block = true};
inline constexpr IntegerKey kPinnedBuildId{
    .path = "nodes[].pinned_build_id",
    .range = {0, 0xFFFF'FFFF},
    .fallback = {.text = "none"},
    .meaning = "the only firmware build that the host accepts: the first 32 bits of its commit"};
inline constexpr ListKey kSensors{
    .path = "nodes[].sensors",
    .items = "sensors",
    .count = {1, kNodeSensorsMax},
    .meaning =
        "[the sensors](#sensors-and-sensor_defaults), at most as many as the board has; their order "
        "is the sensor index on the wire",
    .is_in_node_block = true};
}  // namespace node

namespace verification {
inline constexpr FlagKey kEnabled{.path = "nodes[].verification.enabled",
                                  .fallback = {NodeConfig{}.verifies_registers},
                                  .meaning = "false: no register is compared",
                                  .is_in_node_block = true};
inline constexpr IntegerKey kLeaveOut{
    .path = "nodes[].verification.leave_out[]",
    .range = {0, kVerifiedRegisterMax},
    .fallback = {.text = "none"},
    .meaning = "up to 32 registers that are not compared, by their index, each once",
    .is_in_node_block = true};
static_assert(kRegistersLeftOutMax == 32);
}  // namespace verification

/// `sensor_defaults` has the same keys.
namespace sensor {
inline constexpr std::array<std::pair<std::string_view, DistanceMode>, 3> kDistanceModes{
    {{"short", DistanceMode::short_range},
     {"medium", DistanceMode::medium_range},
     {"long", DistanceMode::long_range}}};
/// ST ULD 3.5.2, VL53L1X_SetTimingBudgetInMs; medium mode, which it does not have, needs 33 ms (datasheet
/// DS12385 rev 7, 2.5.2). ST has 500 ms as well, which the wire's time field, of 262 ms, cannot carry.
inline constexpr std::array<std::int64_t, 6> kShortBudgets_ms{15, 20, 33, 50, 100, 200};
inline constexpr std::array<std::int64_t, 4> kMediumBudgets_ms{33, 50, 100, 200};
inline constexpr std::array<std::int64_t, 5> kLongBudgets_ms{20, 33, 50, 100, 200};
/// The device's fixed point.
inline constexpr double kQuartersPer_mm = 4.0;
inline constexpr double kCrosstalkStepsPer_kcps = 512.0;
inline constexpr double kSignalStepsPer_mcps = 128.0;

inline constexpr TextKey kName{.path = "nodes[].sensors[].name", .meaning = "unique on its node"};
inline constexpr TextKey kLink{.path = "nodes[].sensors[].link",
                               .kind = TextKind::element_name,
                               .meaning = "the URDF link that carries it"};
inline constexpr TableKey kPose{.path = "nodes[].sensors[].pose",
                                .expected = "a [pose](#poses)",
                                .meaning = "T_link_sensor; ranges are along the sensor's own +z"};
inline constexpr IntegerKey kBus{.path = "nodes[].sensors[].bus",
                                 .range = {0, kNodeBusesMax - 1},
                                 .meaning = "index of the node's I2C bus, of those that the board has",
                                 .is_in_node_block = true};
inline constexpr IntegerKey kXshutLine{
    .path = "nodes[].sensors[].xshut_line",
    .range = {0, kNodeXshutLinesMax - 1},
    .meaning = "index of the node's XSHUT output, of those that the board has; unique on the node (below)",
    .is_in_node_block = true};
inline constexpr IntegerKey kAddress{
    .path = "nodes[].sensors[].address",
    .range = {0x08, 0x77},
    .meaning = "7-bit I2C address after bring-up, 0x08..0x77, unique on its bus, not 0x29",
    .is_in_node_block = true};
inline constexpr WordKey<DistanceMode> kDistanceMode{
    .path = "nodes[].sensors[].distance_mode",
    .words = kDistanceModes,
    .meaning = "`short` (to 1.36 m), `medium` (to 2.9 m) or `long` (to 3.6 m); below",
    .is_in_node_block = true};
inline constexpr IntegerKey kTimingBudget{.path = "nodes[].sensors[].timing_budget_ms",
                                          .unit = "ms",
                                          .range = {1, 1000},
                                          .values = kShortBudgets_ms,
                                          .meaning =
                                              "length of one ranging; 15 with `short` only, 20 not "
                                              "with `medium`",
                                          .is_in_node_block = true};
inline constexpr IntegerKey kInterMeasurement{
    .path = "nodes[].sensors[].inter_measurement_ms",
    .unit = "ms",
    .range = {1, 10'000},
    .meaning = "from start to start; at least the budget and 5 ms, or the device halves the rate",
    .is_in_node_block = true};
inline constexpr IntegerKey kPhase{.path = "nodes[].sensors[].phase_us",
                                   .unit = "us",
                                   .range = {0, 65'535},
                                   .fallback = {SensorConfig{}.phase_us},
                                   .meaning =
                                       "start within the period ([phases](#phases)); less than the "
                                       "period",
                                   .is_in_node_block = true};
inline constexpr NumberKey kDeviceOffset{.path = "nodes[].sensors[].device_offset_mm",
                                         .unit = "mm",
                                         .range = {-1024.0, 1023.75},
                                         .fallback = {.text = "the part's own"},
                                         .meaning = "added by the device, in steps of 0.25",
                                         .is_in_node_block = true};
inline constexpr NumberKey kCrosstalk{.path = "nodes[].sensors[].crosstalk_kcps",
                                      .unit = "kcps",
                                      .range = {0.0, 127.0},
                                      .fallback = {SensorConfig{}.crosstalk_raw / kCrosstalkStepsPer_kcps},
                                      .meaning = "crosstalk compensation per SPAD, in steps of 1/512",
                                      .is_in_node_block = true};
inline constexpr NumberKey kSigmaLimit{
    .path = "nodes[].sensors[].sigma_limit_mm",
    .unit = "mm",
    .range = {0.25, 16'000.0},
    .fallback = {SensorConfig{}.sigma_limit_quarter_mm / kQuartersPer_mm},
    .meaning = "the device flags ranges with a larger sigma, in steps of 0.25",
    .is_in_node_block = true};
inline constexpr NumberKey kSignalLimit{.path = "nodes[].sensors[].signal_limit_mcps",
                                        .unit = "Mcps",
                                        .range = {0.0, 511.0},
                                        .fallback = {SensorConfig{}.signal_limit_raw / kSignalStepsPer_mcps},
                                        .meaning = "the device flags weaker returns, in steps of 1/128",
                                        .is_in_node_block = true};
inline constexpr NumberKey kReflexBelow{
    .path = "nodes[].sensors[].reflex_below_m",
    .unit = "m",
    .range = {0.0, kReflexLimitMaxMm / 1000.0},
    .fallback = {0.0},
    .meaning = "a closer hit makes the node send REFLEX, in whole millimetres; 0 is never",
    .is_in_node_block = true};
inline constexpr FlagKey kAppliesGainFactor{
    .path = "nodes[].sensors[].applies_gain_factor",
    .fallback = {SensorConfig{}.applies_gain_factor},
    .meaning = "multiplies ranges by 2011/2048, as ST's full driver does and its light one does not",
    .is_in_node_block = true};
inline constexpr ListKey kZones{.path = "nodes[].sensors[].zones",
                                .items = "zones",
                                .count = {1, kSensorZonesMax},
                                .fallback = {.text = "the whole array"},
                                .meaning = "regions of interest, ranged in turn",
                                .is_in_node_block = true};
inline constexpr TableKey kCone{.path = "nodes[].sensors[].cone",
                                .fallback = {.text = "none: one ideal ray"},
                                .meaning = "the optics of a sensor with a [cone](#cone)"};
}  // namespace sensor

namespace zone {
inline constexpr Range<std::int64_t> kSide_spads{4, 16};
inline constexpr IntegerKey kCentre{
    .path = "nodes[].sensors[].zones[].centre_spad",
    .range = {0, 255},
    .meaning = "number of its centre SPAD in ST's table (UM2555); 199 is the centre of the array",
    .is_in_node_block = true};
inline constexpr IntegerKey kWidth{.path = "nodes[].sensors[].zones[].width_spads",
                                   .unit = "SPADs",
                                   .range = kSide_spads,
                                   .meaning = "the zone must lie on the 16 x 16 array",
                                   .is_in_node_block = true};
inline constexpr IntegerKey kHeight{.path = "nodes[].sensors[].zones[].height_spads",
                                    .unit = "SPADs",
                                    .range = kSide_spads,
                                    .meaning = "as above",
                                    .is_in_node_block = true};
inline constexpr NumberKey kOffset{.path = "nodes[].sensors[].zones[].offset_m",
                                   .unit = "m",
                                   .range = {-0.5, 0.5},
                                   .fallback = {0.0},
                                   .meaning = "added by the host to every valid range of this zone"};
}  // namespace zone

namespace cone {
inline constexpr IntegerKey kSubRays{
    .path = "nodes[].sensors[].cone.sub_rays",
    .range = {1, 64},
    .fallback = {Cone{}.sub_rays},
    .meaning = "the simulator's rays across the cone, a grid of this many by this many"};
inline constexpr NumberKey kHalfAngle{
    .path = "nodes[].sensors[].cone.half_angle_deg",
    .unit = "deg",
    .range = {0.1, 45.0},
    .fallback = {Cone{}.half_angle_deg},
    .meaning = "from the axis to the cone's edge; 27 degrees in all, by DS12385"};
inline constexpr NumberKey kSigma{
    .path = "nodes[].sensors[].cone.sigma_deg",
    .unit = "deg",
    .range = {0.1, 90.0},
    .fallback = {Cone{}.sigma_deg},
    .meaning = "standard deviation of the Gaussian by which the signal falls off from the axis"};
inline constexpr NumberKey kBlur{
    .path = "nodes[].sensors[].cone.blur_deg",
    .unit = "deg",
    .range = {0.1, 20.0},
    .fallback = {Cone{}.blur_deg},
    .meaning = "standard deviation of the lens's blur: how far a zone sees beyond its SPADs"};
}  // namespace cone

/// The same in a file in hw/boards/, at its top.
namespace board {
inline constexpr Range<std::int64_t> kSensors{1, kNodeSensorsMax};
inline constexpr TextKey kName{.path = "nodes[].board.name",
                               .kind = TextKind::folder_name,
                               .meaning = "its name; of a shipped board also that of its file"};
inline constexpr IntegerKey kBoardType{.path = "nodes[].board.board_type",
                                       .range = {0, 255},
                                       .meaning = "its number in NODE_INFO and in the configuration block",
                                       .is_in_node_block = true};
inline constexpr IntegerKey kI2cBusCount{
    .path = "nodes[].board.i2c_bus_count", .range = {1, kNodeBusesMax}, .meaning = "I2C buses"};
inline constexpr IntegerKey kXshutLineCount{
    .path = "nodes[].board.xshut_line_count", .range = {1, kNodeXshutLinesMax}, .meaning = "XSHUT outputs"};
inline constexpr IntegerKey kSensorsMax{
    .path = "nodes[].board.sensors_max", .range = kSensors, .meaning = "sensors of a node"};
inline constexpr IntegerKey kSensorsPerBusMax{
    .path = "nodes[].board.sensors_per_bus_max", .range = kSensors, .meaning = "sensors of one bus"};
inline constexpr FlagKey kSupportsCanFd{.path = "nodes[].board.supports_can_fd",
                                        .meaning = "whether `protocol: can_fd` is possible"};
inline constexpr FlagKey kHasDataReadyLines{
    .path = "nodes[].board.has_data_ready_lines",
    .fallback = {false},
    .meaning = "whether each bus has an input for its sensors' GPIO1"};
}  // namespace board

}  // namespace keys
}  // namespace octoskin::rig
