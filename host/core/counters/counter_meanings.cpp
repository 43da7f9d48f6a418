#include "host/core/counters/counter_meanings.hpp"
#include "host/core/counters/input_counters.hpp"

#include <algorithm>
#include <array>

namespace octoskin {
namespace {

// Remedies that several counters share.
constexpr std::string_view kCandump = "record the bus with candump -L";
constexpr std::string_view kOtherDevices =
    "other devices share the bus: give octoskin identifiers of its own, or filter out theirs";
constexpr std::string_view kSecondBoard =
    "look for a second board with its node id, or for frames that are recorded twice";
constexpr std::string_view kMoreProcessor = "give the program more processor time, or lower the rates";
constexpr std::string_view kFlashedRig = "use the rig that the node was flashed with";
constexpr std::string_view kOneProgram = "let only one program send joint states";

// The texts are those of docs/counters.md, word for word. A test checks that both are equal and complete.
constexpr std::array kCounterMeanings = {
    CounterMeaning{"log lines", "line_blank", "the line is empty", Cause::other_device, ""},
    CounterMeaning{"log lines", "line_foreign",
                   "does not begin with \"(\": not a line of candump with its time", Cause::mendable,
                   kCandump},
    CounterMeaning{
        "log lines", "line_timestamp",
        "neither \"(seconds.fraction)\" nor \"(date time.fraction)\" with 3 to 9 digits of fraction",
        Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_interface",
                   "the interface is missing, longer than 15 characters, not printable, or has a \"#\"",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_identifier", "not 3 or 8 hexadecimal digits, or out of range",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_data",
                   "neither \"#\" nor \"[length]\", a digit that is not hexadecimal, half a byte, or text "
                   "after the frame",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_length", "more than 8 bytes, or a length that CAN FD does not have",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_too_long", "longer than any line that candump writes (320 bytes)",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_truncated", "the file ends within the line", Cause::mendable,
                   "copy the whole file"},
    CounterMeaning{"log lines", "other_interface",
                   "a valid line of a CAN interface other than the one replayed", Cause::other_device, ""},
    CounterMeaning{"CAN frames", "foreign_format",
                   "an extended, remote or error frame, or CAN FD in place of classical CAN or the reverse",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "unknown_type", "an identifier that the protocol does not assign",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_length", "the length is not that of its type", Cause::other_device,
                   kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_crc", "the checksum in the frame does not match its content",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_version", "a valid frame of another version of the protocol",
                   Cause::other_device,
                   "if these are octoskin's nodes, flash the firmware of this version; else give octoskin "
                   "identifiers of its own"},
    CounterMeaning{"CAN frames", "nonzero_padding", "bytes that must be 0 are not", Cause::other_device,
                   kOtherDevices},
    CounterMeaning{"CAN frames", "invalid_field", "a value outside its enumeration or range",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "unknown_node", "a node id that the rig does not have", Cause::mendable,
                   "add the node to the rig, or give its rig"},
    CounterMeaning{"CAN frames", "unknown_sensor",
                   "health, signal or another report of a sensor that the node does not have",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"CAN frames", "host_command", "a host command to the nodes: the map does not use it",
                   Cause::other_device, ""},
    CounterMeaning{"CAN frames", "sync_unmatched", "a FOLLOW_UP or SYNC_REPORT without its SYNC",
                   Cause::mendable, "let one host alone send SYNC"},
    CounterMeaning{"CAN frames", "sync_repeated", "a second SYNC, FOLLOW_UP or SYNC_REPORT of one exchange",
                   Cause::mendable, "let one host alone send SYNC"},
    CounterMeaning{
        "CAN frames", "sync_contradicted",
        "a second SYNC_REPORT of one node for one SYNC with a different time: there are two senders",
        Cause::mendable, "look for a second board with its node id"},
    CounterMeaning{"CAN frames", "node_refused",
                   "NODE_INFO or joint states of a node that is quarantined, sends too many frames, or uses "
                   "another version",
                   Cause::mendable, "correct the fault that the node's line names"},
    CounterMeaning{"CAN frames", "not_joint_source",
                   "joint states of a node that is not the joint source of the rig", Cause::mendable,
                   "set joints.node_id of the rig"},
    CounterMeaning{"CAN frames", "joint_repeated", "a joint frame that its sample already contains",
                   Cause::mendable, "let one sender alone send joint states"},
    CounterMeaning{"CAN frames", "joint_no_host_time", "a joint frame while the host's time is not known yet",
                   Cause::outside, "let a host send SYNC and FOLLOW_UP on the bus"},
    CounterMeaning{"CAN frames", "diagnostic_frame",
                   "a diagnostic frame: a piece of a node's black box or the answer to a calibration, for "
                   "octoskin black-box and octoskin calibrate",
                   Cause::other_device, ""},
    CounterMeaning{"CAN frames", "mark_ignored",
                   "a START or STOP that was not expected, or more than 1 s from the present time",
                   Cause::outside, ""},
    CounterMeaning{"readings", "node_absent", "the node has sent no heartbeat yet", Cause::outside,
                   "check the node's cable and supply, and the node ids of the rig"},
    CounterMeaning{"readings", "node_lost", "no heartbeat of the node for 350 ms", Cause::mendable,
                   "look at the node's cable and supply"},
    CounterMeaning{"readings", "node_version", "the node uses another version of the protocol",
                   Cause::mendable, "flash the firmware of this version"},
    CounterMeaning{"readings", "node_quarantined", "two boards share the node id", Cause::mendable,
                   "give each board its own node id"},
    CounterMeaning{"readings", "node_babbling",
                   "the node sent more than twice the frames of its rig within a second, and has not kept to "
                   "the rig for a second since",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "node_time_suspect", "the node's clock source failed its own check",
                   Cause::mendable, "check the board's crystal"},
    CounterMeaning{"readings", "node_info_incomplete",
                   "not all pages of NODE_INFO have arrived yet: usual at the start", Cause::outside,
                   "wait some seconds: NODE_INFO arrives page by page"},
    CounterMeaning{"readings", "node_info_mismatch",
                   "the configuration block, the number of sensors or the unique id is not that of the rig",
                   Cause::mendable, "flash the node with this rig, or give the rig that it was flashed with"},
    CounterMeaning{"readings", "node_build_refused", "the rig pins another firmware build", Cause::mendable,
                   "flash the build that the rig pins, or remove the pin"},
    CounterMeaning{"readings", "unknown_sensor", "a sensor index that the node does not have",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "no_host_time", "the host's time is not known yet", Cause::outside,
                   "let a host send SYNC and FOLLOW_UP on the bus"},
    CounterMeaning{"readings", "clock_not_ready",
                   "fewer than two SYNC exchanges with the node yet: usual in its first seconds",
                   Cause::outside, "wait some seconds, with the SYNC of a host on the bus"},
    CounterMeaning{
        "readings", "clock_in_doubt",
        "the newest exchange with the node contradicts those before: its clock jumped, or one of them is "
        "wrong. Or other readings of the node have impossible times, and the time of this one does not "
        "follow those of its sensor by the sensor's period. Time stamps of a serial adapter in steps of over "
        "16 ms have the same effect",
        Cause::mendable,
        "look for a second host that sends SYNC, and for an adapter whose time stamps are coarse or late"},
    CounterMeaning{"readings", "clock_silent", "no exchange with the node for too long", Cause::mendable,
                   "let the host send SYNC and FOLLOW_UP continuously"},
    CounterMeaning{"readings", "time_uncertain",
                   "the error of the capture time may exceed time_uncertainty_max_ms of the rig, or the node "
                   "has not reported its bound",
                   Cause::mendable, "raise time_uncertainty_max_ms of the rig, or shorten the SYNC period"},
    CounterMeaning{"readings", "duplicate", "a reading that has arrived before", Cause::mendable,
                   kSecondBoard},
    CounterMeaning{"readings", "contradicts_reading",
                   "another reading of its sensor has the same number and other contents, or a later number "
                   "and an earlier time: a damaged frame or a second sender. If the other one was still "
                   "waiting, it is counted here too",
                   Cause::mendable, kSecondBoard},
    CounterMeaning{
        "readings", "sensor_disputed",
        "two senders use the identifier of its sensor: refused until one second after the last sign of it",
        Cause::mendable, kSecondBoard},
    CounterMeaning{"readings", "out_of_window",
                   "older than the last 32 readings of its sensor, or its number does not fit its time",
                   Cause::mendable, kSecondBoard},
    CounterMeaning{"readings", "too_soon",
                   "its ranging window overlaps that of another reading of the sensor", Cause::mendable,
                   kSecondBoard},
    CounterMeaning{"readings", "too_young", "arrived before its ranging window can have ended",
                   Cause::mendable, kSecondBoard},
    CounterMeaning{"readings", "too_old", "arrived later than half its budget and 100 ms after its capture",
                   Cause::mendable, "look for a bus that is full or an adapter that holds frames back"},
    CounterMeaning{"readings", "sensor_misconfigured",
                   "its node reports that the sensor's registers are not as configured: its direction or its "
                   "range may be wrong",
                   Cause::mendable,
                   "leave out the register that the node's line names, or replace the sensor"},
    CounterMeaning{"readings", "no_return",
                   "the sensor saw no target, and the map ignores such beams (no_return_clear_m: 0): usual "
                   "when a beam leaves the room",
                   Cause::scene, "set no_return_clear_m of the mapping to let such beams free space"},
    CounterMeaning{"readings", "status_fault",
                   "the sensor reported a status other than \"valid\" and \"no target\"", Cause::scene,
                   "look at the sensor, its cover and its light: docs/hardware/fault-table.md"},
    CounterMeaning{"readings", "zone_unknown", "the node does not know which zone was active",
                   Cause::mendable, "flash the node with this rig"},
    CounterMeaning{"readings", "zone_not_in_rig", "a zone that the sensor does not have in the rig",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "not_finite", "a range that is not a number", Cause::scene, ""},
    CounterMeaning{"readings", "below_range_min", "nearer than range_limits.min_m of the rig", Cause::scene,
                   ""},
    CounterMeaning{"readings", "above_range_max", "further than range_limits.max_m", Cause::scene, ""},
    CounterMeaning{"readings", "sigma_above_max",
                   "the sensor gives a standard deviation above range_limits.sigma_max_m of the rig",
                   Cause::scene, ""},
    CounterMeaning{"readings", "queue_overflow", "displaced by newer ones in a full queue", Cause::mendable,
                   kMoreProcessor},
    CounterMeaning{"readings", "outside_marks",
                   "captured before the START or after the STOP mark: in a simulation, while the robot rests "
                   "before the motion",
                   Cause::outside, "record from before START to after STOP"},
    CounterMeaning{"readings", "late", "arrived after the map had advanced past its time", Cause::mendable,
                   kMoreProcessor},
    CounterMeaning{"readings", "joints_missing", "no pose of its link at its capture time", Cause::mendable,
                   "send joint states at 20 Hz or more, from before the first reading to after the last"},
    CounterMeaning{"readings", "self_hit",
                   "the beam ends on the robot's own body: usual for a sensor that sees another link",
                   Cause::scene, ""},
    CounterMeaning{"readings", "beam_not_valid", "a pose or range that is not a number", Cause::mendable,
                   "look for a value that is not a number in the rig and the robot description"},
    CounterMeaning{"readings", "outside_map", "beyond the bounds of the octree", Cause::mendable,
                   "look at T_map_base of the rig, or raise the mapping's resolution_m"},
    CounterMeaning{"readings", "cone_too_large", "its cone has more than 16777216 voxels of the map",
                   Cause::mendable, "raise resolution_m of the mapping, or lower no_return_clear_m"},
    CounterMeaning{"readings", "contradicts_camera",
                   "its sensor contradicts the camera (the problems state how): the map does not use it "
                   "until it agrees again",
                   Cause::mendable, "measure the poses of the camera and of this sensor again"},
    CounterMeaning{"joint samples", "incomplete", "not all four frames of the sample arrived in time",
                   Cause::mendable, "look for lost frames, or for a source that omits frames"},
    CounterMeaning{"joint samples", "contradictory",
                   "two frames that should be equal differ, or one arrived before the sample was taken, or "
                   "out of order and so late that it may be of the next round",
                   Cause::mendable, kOneProgram},
    CounterMeaning{"joint samples", "clock_not_ready",
                   "fewer than two SYNC exchanges with the node yet: usual in its first seconds",
                   Cause::outside, "wait some seconds, with the SYNC of a host on the bus"},
    CounterMeaning{
        "joint samples", "clock_in_doubt",
        "the newest exchange with the node contradicts the earlier ones: its clock jumped, or one of them is "
        "wrong",
        Cause::mendable,
        "look for a second host that sends SYNC, and for an adapter whose time stamps are coarse or late"},
    CounterMeaning{"joint samples", "clock_silent", "no exchange with the node for too long", Cause::mendable,
                   "let the host send SYNC and FOLLOW_UP continuously"},
    CounterMeaning{"joint samples", "too_old", "arrived more than 50 ms after it was sampled",
                   Cause::mendable, "send each sample immediately"},
    CounterMeaning{"joint samples", "out_of_limits", "a joint beyond the limits of the robot description",
                   Cause::mendable,
                   "send radians and metres in the order of joints of the rig, or correct the <limit>"},
    CounterMeaning{"joint samples", "out_of_order", "not later than the sample before it", Cause::mendable,
                   kOneProgram},
    CounterMeaning{"joint samples", "queue_overflow", "displaced by newer ones in a full queue",
                   Cause::mendable, kMoreProcessor},
    CounterMeaning{"joint samples", "too_frequent",
                   "the source sends at more than 1.6 times joints.rate_hz of the rig: its samples cannot be "
                   "distinguished with certainty. Its first five, if its clock is known by then",
                   Cause::mendable, "put the true rate into joints.rate_hz of the rig"},
    CounterMeaning{"joint samples", "second_sender",
                   "two senders of joint states are active, or were within the last second, and it cannot be "
                   "decided which of them is right: neither is used",
                   Cause::mendable, kOneProgram},
    CounterMeaning{"joint samples", "joint_jump",
                   "further from the sample before it than the arm can move in that time at 1.5 times the "
                   "velocity of the robot description's <limit>",
                   Cause::mendable,
                   "let only one program send joint states, or correct the velocity of the <limit>"},
    CounterMeaning{"joint samples", "wrong_count",
                   "a position beyond the source's joints in the rig is not zero: its node sends more joints",
                   Cause::mendable, "list in joints of the rig all that the node sends, in its order"},
    CounterMeaning{"depth frames", "no_camera", "the rig has no camera", Cause::outside,
                   "use a rig with the camera"},
    CounterMeaning{"depth frames", "wrong_size", "not the camera's width and height in the rig",
                   Cause::mendable, "use a rig whose camera has their width_px and height_px"},
    CounterMeaning{"depth frames", "out_of_order", "not later than the frame before it", Cause::mendable,
                   "let only one camera send images"},
    CounterMeaning{"depth frames", "ahead_of_time",
                   "captured over a second after the newest known time: the bus fell silent, its log ends "
                   "before the images, or the camera's clock is wrong",
                   Cause::mendable, "set the clock of the camera, or record the bus to the end"},
    CounterMeaning{"depth frames", "queue_overflow", "displaced by newer ones in a full queue",
                   Cause::mendable, kMoreProcessor},
    CounterMeaning{"depth frames", "outside_marks",
                   "captured before START, after STOP, or before the first usable reading", Cause::outside,
                   "record from before START to after STOP"},
    CounterMeaning{"depth frames", "late", "arrived after the map had advanced past its time",
                   Cause::mendable, kMoreProcessor},
    CounterMeaning{"depth frames", "joints_missing",
                   "no pose of the arm at its capture time, so that the robot cannot be removed",
                   Cause::mendable,
                   "send joint states at 20 Hz or more, from before the first reading to after the last"},
    CounterMeaning{"depth frames", "outside_map",
                   "the camera is outside the octree, or its pose is not a number", Cause::mendable,
                   "correct the camera's pose"},
    CounterMeaning{"depth frames", "box_too_large", "its rays span more voxels than depth_box_voxels_max",
                   Cause::mendable, "raise depth_box_voxels_max, or resolution_m, of the mapping"},
    CounterMeaning{"depth frames", "no_memory", "the system had no memory to compute it", Cause::mendable,
                   "free memory, or raise resolution_m of the mapping"},
    CounterMeaning{
        "depth images", "without_pose",
        "there are no poses around its time, or they are too far apart; usual at the beginning and the end",
        Cause::mendable,
        "raise camera.data_set.pose_gap_max_ms of the rig, or record poses at a higher rate"},
    CounterMeaning{"depth images", "unreadable",
                   "missing, damaged, or not grey with 16 bits: the replay ends there", Cause::mendable,
                   "remove the line from the list"},
    CounterMeaning{"depth images", "bad_line", "the line does not name an image and its time",
                   Cause::mendable, "correct the line, or remove it"},
    CounterMeaning{"camera poses", "no_pose",
                   "the pose at this time is not known: nan, a quaternion of zeros, or no file of it",
                   Cause::outside, ""},
    CounterMeaning{"camera poses", "bad_line", "the line, or the file of one pose, contains no valid pose",
                   Cause::mendable, "correct the line, or take it out"},
    CounterMeaning{"camera poses", "repeated", "a pose of the same time precedes it", Cause::outside, ""},
    CounterMeaning{"depth pixels", "no_value", "the camera or the filter gave no value", Cause::scene, ""},
    CounterMeaning{"depth pixels", "robot", "on the robot, removed", Cause::scene, ""},
    CounterMeaning{"depth pixels", "bad_value", "infinite, zero or negative", Cause::mendable, ""},
    CounterMeaning{"depth pixels", "outside_map", "beyond the bounds of the octree", Cause::mendable,
                   "correct the camera's pose, or raise resolution_m of the mapping"},
};

}  // namespace

std::span<const CounterMeaning> counter_meanings() noexcept {
    return kCounterMeanings;
}

const CounterMeaning* find_counter(std::string_view unit, std::string_view name) noexcept {
    unit = unit.substr(0, unit.find(CounterTable::kOf));
    const auto* const found = std::ranges::find_if(
        kCounterMeanings, [&](const CounterMeaning& one) { return one.unit == unit && one.name == name; });
    return found == kCounterMeanings.end() ? nullptr : &*found;
}

}  // namespace octoskin
