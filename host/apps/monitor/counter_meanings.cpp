#include "host/apps/monitor/counter_meanings.hpp"

#include <array>

namespace octoskin {
namespace {

// Word for word as docs/account.md has them; a test holds the two equal and complete.
constexpr std::array kCounterMeanings = {
    Meaning{"log lines", "line_blank", "nothing on the line"},
    Meaning{"log lines", "line_foreign", "does not begin with \"(\": not a line of candump"},
    Meaning{"log lines", "line_timestamp", "not \"(seconds.fraction)\" with 6 or 9 digits of fraction"},
    Meaning{"log lines", "line_interface",
            "the interface is missing, longer than 15 characters, or not printable"},
    Meaning{"log lines", "line_identifier", "not 3 or 8 hexadecimal digits, or out of range"},
    Meaning{"log lines", "line_data",
            "no \"#\", a digit that is not hexadecimal, half a byte, or something behind the frame"},
    Meaning{"log lines", "line_length", "more than 8 bytes, or a length that CAN FD does not have"},
    Meaning{"log lines", "line_too_long", "longer than any line that candump writes (256 bytes)"},
    Meaning{"log lines", "line_truncated", "the file ends within the line"},
    Meaning{"log lines", "other_interface", "a good line of another CAN interface than the one replayed"},
    Meaning{"CAN frames", "foreign_format",
            "extended, remote or error frame, or CAN FD where classical belongs and the reverse"},
    Meaning{"CAN frames", "unknown_type", "an identifier that the protocol does not assign"},
    Meaning{"CAN frames", "wrong_length", "not the length that its type has"},
    Meaning{"CAN frames", "wrong_crc", "the checksum in the frame does not fit its content"},
    Meaning{"CAN frames", "wrong_version", "a sound frame of another version of the protocol"},
    Meaning{"CAN frames", "nonzero_padding", "bytes that must be 0 are not"},
    Meaning{"CAN frames", "invalid_field", "a value outside its enumeration or range"},
    Meaning{"CAN frames", "unknown_node", "a node id that the rig does not have"},
    Meaning{"CAN frames", "unknown_sensor",
            "health, signal or another report of a sensor that the node does not have"},
    Meaning{"CAN frames", "for_nodes", "a command to nodes: nothing for the host in it"},
    Meaning{"CAN frames", "sync_unmatched", "FOLLOW_UP or SYNC_REPORT without their SYNC"},
    Meaning{"CAN frames", "sync_repeated", "a second SYNC, FOLLOW_UP or SYNC_REPORT where one belongs"},
    Meaning{"CAN frames", "node_refused",
            "NODE_INFO or joints of a node that is quarantined, babbles or speaks another version"},
    Meaning{"CAN frames", "not_joint_source", "joint states of a node that the rig does not name for them"},
    Meaning{"CAN frames", "joint_repeated", "a joint frame that its sample has already"},
    Meaning{"CAN frames", "joint_no_host_time", "a joint frame while the host does not know the time yet"},
    Meaning{"CAN frames", "for_people",
            "a piece of a node's black box, or a calibration's answer: for octoskin black-box and octoskin "
            "calibrate, nothing for the map in it"},
    Meaning{"CAN frames", "mark_ignored", "a START or STOP where none was waited for, or over 1 s from now"},
    Meaning{"readings", "node_absent", "the node has sent no heartbeat yet"},
    Meaning{"readings", "node_lost", "no heartbeat of the node for 350 ms"},
    Meaning{"readings", "node_version", "the node speaks another version of the protocol"},
    Meaning{"readings", "node_quarantined", "two boards share the node id"},
    Meaning{
        "readings", "node_babbling",
        "the node sent over twice as many frames within a second as the rig has it send, and has not kept "
        "to that for a second"},
    Meaning{"readings", "node_time_suspect", "the node's clock source failed its own check"},
    Meaning{"readings", "node_info_incomplete",
            "not all pages of NODE_INFO are here yet: usual at the start"},
    Meaning{"readings", "node_info_mismatch",
            "configuration block, number of sensors or unique id is not what the rig says"},
    Meaning{"readings", "node_build_refused", "the rig pins another firmware build"},
    Meaning{"readings", "unknown_sensor", "a sensor index that the node does not have"},
    Meaning{"readings", "no_host_time", "the host does not know the time yet"},
    Meaning{"readings", "clock_not_ready",
            "fewer than two SYNC exchanges with the node yet: usual in its first seconds"},
    Meaning{"readings", "clock_in_doubt",
            "the newest exchange with the node contradicts those before: its clock jumped, or one of them is "
            "wrong. Or other readings of the node have times that cannot be, and this one's does not follow "
            "those of its sensor by its period"},
    Meaning{"readings", "clock_silent", "no exchange with the node for too long"},
    Meaning{"readings", "time_uncertain",
            "the capture time may be further off than time_uncertainty_max_ms of the rig allows, or the node "
            "has not told how far"},
    Meaning{"readings", "duplicate", "a reading that was here already"},
    Meaning{"readings", "contradicts_reading",
            "another of its sensor has its number and other contents, or a later number and an earlier time: "
            "a damaged frame or a second sender. Where the other still waited, it is counted here too"},
    Meaning{"readings", "sensor_disputed",
            "two senders speak under its sensor's name: refused until a second after the last sign of it"},
    Meaning{"readings", "out_of_window",
            "older than the last 32 of its sensor, or its number does not fit its time"},
    Meaning{"readings", "too_soon", "its ranging window overlaps that of another reading of the sensor"},
    Meaning{"readings", "too_young", "arrived before its ranging can have ended"},
    Meaning{"readings", "too_old", "arrived later than half its budget and 100 ms after its capture"},
    Meaning{"readings", "sensor_misconfigured",
            "its node says that the sensor's registers are not as configured: it may look elsewhere, or mean "
            "another range"},
    Meaning{"readings", "no_return",
            "the sensor saw no target, and the map leaves such beams alone (no_return_clear_m: 0): usual "
            "when a beam leaves the room"},
    Meaning{"readings", "status_fault", "the sensor gave any status but \"valid\" and \"no target\""},
    Meaning{"readings", "zone_unknown", "the node does not know which zone was in force"},
    Meaning{"readings", "zone_not_in_rig", "a zone that the sensor does not have in the rig"},
    Meaning{"readings", "not_finite", "a range that is no number"},
    Meaning{"readings", "below_range_min", "nearer than range_limits.min_m of the rig"},
    Meaning{"readings", "above_range_max", "further than range_limits.max_m"},
    Meaning{"readings", "sigma_above_max", "the sensor calls it less sure than range_limits.sigma_max_m"},
    Meaning{"readings", "queue_overflow", "displaced by newer ones in a full queue"},
    Meaning{"readings", "outside_marks",
            "captured before START or after STOP: in a simulation the rest before the motion"},
    Meaning{"readings", "late", "came after the map had gone on"},
    Meaning{"readings", "joints_missing", "no pose of the arm at its capture time"},
    Meaning{"readings", "self_hit",
            "the beam reaches the robot's own body: usual for a sensor that sees another link"},
    Meaning{"readings", "beam_not_valid", "a pose or range that is no number"},
    Meaning{"readings", "outside_map", "beyond the bounds of the octree"},
    Meaning{
        "readings", "contradicts_camera",
        "its sensor contradicts the camera (the problems say how): the map does without it until it agrees "
        "again"},
    Meaning{"joint samples", "incomplete", "not all four frames of the sample came in time"},
    Meaning{"joint samples", "contradictory",
            "two frames differ that should be one, or one came before the sample was taken, or out of turn "
            "and so late that it may be of the next round"},
    Meaning{"joint samples", "clock_not_ready",
            "fewer than two SYNC exchanges with the node yet: usual in its first seconds"},
    Meaning{"joint samples", "clock_in_doubt",
            "the newest exchange with the node contradicts those before: its clock jumped, or one of them is "
            "wrong"},
    Meaning{"joint samples", "clock_silent", "no exchange with the node for too long"},
    Meaning{"joint samples", "too_old", "arrived more than 50 ms after it was sampled"},
    Meaning{"joint samples", "out_of_limits", "a joint beyond the limits of the robot description"},
    Meaning{"joint samples", "out_of_order", "not later than the sample before it"},
    Meaning{"joint samples", "queue_overflow", "displaced by newer ones in a full queue"},
    Meaning{"joint samples", "too_frequent",
            "the source is over 1.6 times as quick as joints.rate_hz of the rig says: its samples cannot be "
            "told apart with certainty. Its first five, if its clock is known by then"},
    Meaning{"joint samples", "second_sender",
            "two senders of joint states are heard, or were within the last second, and it cannot be decided "
            "which of "
            "them is true: neither is used"},
    Meaning{"joint samples", "joint_jump",
            "further from the sample before it than 1.5 times the velocity of the robot description's "
            "<limit> lets the arm move in that time"},
    Meaning{"depth frames", "no_camera", "the rig has no camera"},
    Meaning{"depth frames", "wrong_size", "not the camera's width and height in the rig"},
    Meaning{"depth frames", "out_of_order", "not later than the frame before it"},
    Meaning{"depth frames", "ahead_of_time",
            "captured over a second after all that was told of the time: the bus fell silent, its log ends "
            "before the images, or the camera's clock is wrong"},
    Meaning{"depth frames", "queue_overflow", "displaced by newer ones in a full queue"},
    Meaning{"depth frames", "outside_marks",
            "captured before START, after STOP, or before the first usable reading"},
    Meaning{"depth frames", "late", "came after the map had gone on"},
    Meaning{"depth frames", "joints_missing",
            "no pose of the arm at its capture time, so that the robot cannot be taken out"},
    Meaning{"depth frames", "outside_map", "the camera stands beyond the octree, or its pose is no number"},
    Meaning{"depth frames", "box_too_large", "its rays span more voxels than depth_box_voxels_max"},
    Meaning{"depth frames", "no_memory", "the system had no memory to work it out with"},
    Meaning{"depth images", "without_pose",
            "groundtruth.txt has no poses about its time; usual at the beginning and the end"},
    Meaning{"depth images", "unreadable",
            "missing, damaged, or not grey with 16 bits: the replay ends there"},
    Meaning{"depth pixels", "no_value", "the camera or the filter gave none"},
    Meaning{"depth pixels", "robot", "on the robot, taken out"},
    Meaning{"depth pixels", "bad_value", "infinite, zero or negative"},
    Meaning{"depth pixels", "outside_map", "beyond the bounds of the octree"},
};

}  // namespace

std::span<const Meaning> counter_meanings() noexcept {
    return kCounterMeanings;
}

}  // namespace octoskin
