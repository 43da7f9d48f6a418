// Reasons why an input was not used: one enumeration per kind of input counter, one name per reason.
//
// A *frame* is one CAN frame as received. A RANGE frame is used once its readings are counted as inputs. Each
// *reading* then has its own result; it is used when its terms went into a map. A *joint sample* consists of
// the four frames of one sequence number; it is used once poses are interpolated from it. A *depth frame* is
// one image.
#pragma once

#include <array>
#include <cstdint>

#include "common/wire/codec.hpp"

namespace octoskin {

enum class FrameReason : std::uint8_t {
    // The first seven are wire::DecodeError, in its order.
    foreign_format,
    unknown_type,
    wrong_length,
    wrong_crc,
    wrong_version,
    nonzero_padding,
    invalid_field,
    unknown_node,       ///< a node id that is not in the rig
    unknown_sensor,     ///< health, signal or reflex of a sensor that the node does not have
    host_command,       ///< a host command: the map does not use it
    sync_unmatched,     ///< FOLLOW_UP or SYNC_REPORT without its SYNC
    sync_repeated,      ///< a second SYNC, FOLLOW_UP or SYNC_REPORT where only one belongs
    sync_contradicted,  ///< a second SYNC_REPORT of one node to one SYNC, with another time
    /// NODE_INFO or joint states of a node that is quarantined, babbling or of another version
    node_refused,
    not_joint_source,    ///< joint states of a node that is not the rig's joint source
    joint_repeated,      ///< a joint frame that the sample already has
    joint_no_host_time,  ///< a joint frame while the host time is unknown
    diagnostic_frame,    ///< a diagnostic frame (black box, answer to a calibration): the map does not use it
    mark_ignored,        ///< a MARK where the map does not wait for one, or over 1 s from the host time
};
[[nodiscard]] constexpr std::array<const char*, 19> names_of(FrameReason) {
    return {"foreign_format",     "unknown_type",     "wrong_length",     "wrong_crc",
            "wrong_version",      "nonzero_padding",  "invalid_field",    "unknown_node",
            "unknown_sensor",     "host_command",     "sync_unmatched",   "sync_repeated",
            "sync_contradicted",  "node_refused",     "not_joint_source", "joint_repeated",
            "joint_no_host_time", "diagnostic_frame", "mark_ignored"};
}
static_assert(static_cast<std::size_t>(FrameReason::invalid_field) + 1 == wire::kDecodeErrors);
[[nodiscard]] constexpr FrameReason reason_of(wire::DecodeError error) noexcept {
    return static_cast<FrameReason>(error);
}

enum class ReadingReason : std::uint8_t {
    // State of its node.
    node_absent,           ///< no heartbeat yet
    node_lost,             ///< no heartbeat for 350 ms
    node_version,          ///< uses another version of the protocol
    node_quarantined,      ///< two boards share the node id
    node_babbling,         ///< over twice the rig's frame rate for it
    node_time_suspect,     ///< the node's clock source failed its own check
    node_info_incomplete,  ///< pages of NODE_INFO are missing
    /// configuration block, number of sensors or unique id differs from the expected one
    node_info_mismatch,
    node_build_refused,  ///< the rig pins another firmware build
    unknown_sensor,      ///< an index that the node does not have
    // Its time.
    no_host_time,     ///< the host time is unknown
    clock_not_ready,  ///< see ClockFault
    /// see ClockFault; or its time does not show that the clock continues, while others contradict the clock
    clock_in_doubt,
    clock_silent,
    time_uncertain,  ///< its error bound exceeds the rig's limit, or its node has not reported one
    // Its place among the sensor's readings.
    duplicate,
    /// another reading of its sensor has its number, or an earlier time and a later number
    contradicts_reading,
    sensor_disputed,  ///< two senders use its sensor's id, now or within the last second
    out_of_window,    ///< older than the last 32 of its sensor, or its number does not fit its time
    too_soon,         ///< its ranging window overlaps that of another reading of the sensor
    too_young,        ///< arrived before its ranging window can have ended
    too_old,          ///< arrived later than budget / 2 + 100 ms after its capture
    // Its contents.
    sensor_misconfigured,  ///< its node reports that the sensor's registers are not as configured
    no_return,             ///< no target, and the map does not use such beams
    status_fault,          ///< any status but "valid" and "no target"
    zone_unknown,          ///< the node does not know which zone was in force
    zone_not_in_rig,       ///< a zone that the sensor does not have
    not_finite,
    below_range_min,
    above_range_max,
    sigma_above_max,
    // On its way into the map.
    queue_overflow,  ///< displaced by newer ones
    outside_marks,   ///< captured before START or after STOP
    late,            ///< arrived after the map had passed its capture time
    joints_missing,  ///< no pose at its capture time
    self_hit,        ///< hits the robot's own body
    beam_not_valid,  ///< its pose or range is not a number
    outside_map,     ///< beyond the octree
    cone_too_large,  ///< its cone has more voxels than one range may have
    /// its sensor contradicts the camera: displaced, turned, exchanged with another, or stuck
    contradicts_camera,
};
[[nodiscard]] constexpr std::array<const char*, 40> names_of(ReadingReason) {
    return {"node_absent",
            "node_lost",
            "node_version",
            "node_quarantined",
            "node_babbling",
            "node_time_suspect",
            "node_info_incomplete",
            "node_info_mismatch",
            "node_build_refused",
            "unknown_sensor",
            "no_host_time",
            "clock_not_ready",
            "clock_in_doubt",
            "clock_silent",
            "time_uncertain",
            "duplicate",
            "contradicts_reading",
            "sensor_disputed",
            "out_of_window",
            "too_soon",
            "too_young",
            "too_old",
            "sensor_misconfigured",
            "no_return",
            "status_fault",
            "zone_unknown",
            "zone_not_in_rig",
            "not_finite",
            "below_range_min",
            "above_range_max",
            "sigma_above_max",
            "queue_overflow",
            "outside_marks",
            "late",
            "joints_missing",
            "self_hit",
            "beam_not_valid",
            "outside_map",
            "cone_too_large",
            "contradicts_camera"};
}

enum class JointReason : std::uint8_t {
    incomplete,       ///< not all four frames arrived in time
    contradictory,    ///< two frames of the sample contradict each other, or one is of another round
    clock_not_ready,  ///< see ClockFault
    clock_in_doubt,
    clock_silent,
    too_old,        ///< arrived more than 50 ms after it was sampled
    out_of_limits,  ///< a joint beyond its limits
    out_of_order,   ///< not later than the sample before it
    queue_overflow,
    too_frequent,   ///< the source is faster than the rig's rate, so that samples cannot be distinguished
    second_sender,  ///< two senders use the joint node, and the true one is unknown
    joint_jump,     ///< further from the sample before it than the arm can move in that time
    wrong_count,    ///< it has a joint beyond those that the source has in the rig
};
[[nodiscard]] constexpr std::array<const char*, 13> names_of(JointReason) {
    return {"incomplete",    "contradictory", "clock_not_ready", "clock_in_doubt", "clock_silent",
            "too_old",       "out_of_limits", "out_of_order",    "queue_overflow", "too_frequent",
            "second_sender", "joint_jump",    "wrong_count"};
}

enum class DepthReason : std::uint8_t {
    no_camera,       ///< the rig has no camera
    wrong_size,      ///< not the camera's width and height
    out_of_order,    ///< not later than the frame before it
    ahead_of_time,   ///< captured in the future
    queue_overflow,  ///< displaced by newer ones
    outside_marks,   ///< captured before START, after STOP, or before the first usable reading
    late,            ///< arrived after the map had passed its capture time
    joints_missing,  ///< no pose at its capture time, so the robot cannot be removed from the image
    outside_map,     ///< the camera is outside the map, or its pose is not a number
    box_too_large,   ///< its rays span more voxels than allowed
    no_memory,       ///< the system had too little memory to process it
};
[[nodiscard]] constexpr std::array<const char*, 11> names_of(DepthReason) {
    return {"no_camera", "wrong_size",     "out_of_order", "ahead_of_time", "queue_overflow", "outside_marks",
            "late",      "joints_missing", "outside_map",  "box_too_large", "no_memory"};
}

}  // namespace octoskin
