// The one declaration of each key of a rig file and of a board's file. Some tables have a header of their
// own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "common/wire/messages.hpp"
#include "hw/rigfile/camera_keys.hpp"
#include "hw/rigfile/key.hpp"
#include "hw/rigfile/node_keys.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_keys.hpp"
#include "hw/rigfile/sensor_keys.hpp"

namespace octoskin::rig {

/// All tables of a rig in the order of docs/rig.md. Each declared key is in one of them; the poses of a
/// sensor lack the last key of those of a camera.
[[nodiscard]] std::span<const KeyTable> rig_key_tables() noexcept;

namespace keys {

/// The keys of each table; the namespace with its name has their declarations.
extern const KeyTable kTop;
extern const KeyTable kRobot;
extern const KeyTable kAttachedCapsule;
extern const KeyTable kPose;
extern const KeyTable kCameraPose;
extern const KeyTable kBus;
extern const KeyTable kRangeLimits;
extern const KeyTable kJoints;
extern const KeyTable kCamera;
extern const KeyTable kCameraNoise;
extern const KeyTable kDataSet;
extern const KeyTable kDistortion;
extern const KeyTable kNode;
extern const KeyTable kVerification;
extern const KeyTable kSensor;
extern const KeyTable kZone;
extern const KeyTable kCone;
extern const KeyTable kBoard;

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
                                       .expected = "a table, or a list of up to 32 tables",
                                       .meaning = "[the senders of joint positions](#joints)"};
inline constexpr TableKey kCameraTable{.path = "camera",
                                       .fallback = {.text = "none"},
                                       .meaning =
                                           "[the depth camera](#camera); without one the map is made "
                                           "from ranges alone"};
inline constexpr ListKey kCameras{.path = "cameras",
                                  .items = "cameras",
                                  .count = {1, kCamerasMax},
                                  .fallback = {.text = "none"},
                                  .meaning =
                                      "in place of `camera`: several [depth cameras](#camera), each with a "
                                      "`name`"};
inline constexpr TableKey kSensorDefaults{
    .path = "sensor_defaults",
    .fallback = {.text = "none"},
    .meaning =
        "any keys of a [sensor](#sensors-and-sensor_defaults), defaults for every sensor of every "
        "node"};
inline constexpr ListKey kNodes{
    .path = "nodes", .items = "nodes", .count = {1, 61}, .meaning = "[the boards](#nodes)"};

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
inline constexpr std::array<std::pair<std::string_view, JointWay>, 2> kWays{
    {{"can", JointWay::can}, {"socket", JointWay::socket}}};
inline constexpr Range<std::int64_t> kSources{1, 32};
/// Of all sources together.
inline constexpr std::size_t kNamesMax = 32;
inline constexpr IntegerKey kNodeId{.path = "joints.node_id",
                                    .range = keys::kNodeId,
                                    .meaning = "an id of its own: the sender of joint states"};
inline constexpr ListKey kNames{.path = "joints.names",
                                .items = "joints",
                                .count = {1, wire::kJointsPerSample},
                                .meaning =
                                    "URDF joints in the order on the wire; every moving joint below the "
                                    "base link is in one source, up to 32 in all"};
inline constexpr NumberKey kRate{
    .path = "joints.rate_hz", .unit = "Hz", .range = {1.0, 1000.0}, .meaning = "samples a second"};
inline constexpr WordKey<JointWay> kWay{.path = "joints.via",
                                        .words = kWays,
                                        .fallback = {.value = JointWay::can},
                                        .meaning =
                                            "`socket`: they come through `octoskin run --joints`, not over "
                                            "CAN. If no source has this, `--joints` "
                                            "replaces all of them"};
}  // namespace joints

}  // namespace keys
}  // namespace octoskin::rig
