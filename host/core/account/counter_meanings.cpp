#include "host/core/account/counter_meanings.hpp"

#include <algorithm>
#include <array>

namespace octoskin {
namespace {

// Remedies that several counters share.
constexpr std::string_view kCandump = "record the bus with candump -L";
constexpr std::string_view kOtherDevices =
    "other devices share the bus: give octoskin identifiers of its own, or filter theirs";
constexpr std::string_view kSecondBoard =
    "look for a second board with its node id, or frames that are recorded twice";
constexpr std::string_view kMoreProcessor = "give the program more processor, or lower the rates";
constexpr std::string_view kFlashedRig = "give the rig that the node was flashed with";
constexpr std::string_view kOneProgram = "let one program alone send joint states";

// Word for word as docs/account.md has them; a test holds the two equal and complete.
constexpr std::array kCounterMeanings = {
    CounterMeaning{"log lines", "line_blank", "nothing on the line", Cause::other_device, ""},
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
                   "neither \"#\" nor \"[length]\", a digit that is not hexadecimal, half a byte, or "
                   "something behind the frame",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_length", "more than 8 bytes, or a length that CAN FD does not have",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_too_long", "longer than any line that candump writes (320 bytes)",
                   Cause::mendable, kCandump},
    CounterMeaning{"log lines", "line_truncated", "the file ends within the line", Cause::mendable,
                   "copy the whole file"},
    CounterMeaning{"log lines", "other_interface",
                   "a good line of another CAN interface than the one replayed", Cause::other_device, ""},
    CounterMeaning{"CAN frames", "foreign_format",
                   "extended, remote or error frame, or CAN FD where classical belongs and the reverse",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "unknown_type", "an identifier that the protocol does not assign",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_length", "not the length that its type has", Cause::other_device,
                   kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_crc", "the checksum in the frame does not fit its content",
                   Cause::other_device, kOtherDevices},
    CounterMeaning{"CAN frames", "wrong_version", "a sound frame of another version of the protocol",
                   Cause::other_device,
                   "flash the firmware of this version, if they are octoskin's nodes; else give octoskin "
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
    CounterMeaning{"CAN frames", "for_nodes", "a command to nodes: nothing for the host in it",
                   Cause::other_device, ""},
    CounterMeaning{"CAN frames", "sync_unmatched", "FOLLOW_UP or SYNC_REPORT without their SYNC",
                   Cause::mendable, "let one host alone send SYNC"},
    CounterMeaning{"CAN frames", "sync_repeated", "a second SYNC, FOLLOW_UP or SYNC_REPORT where one belongs",
                   Cause::mendable, "let one host alone send SYNC"},
    CounterMeaning{"CAN frames", "sync_contradicted",
                   "a second SYNC_REPORT of one node to one SYNC with another time: two senders",
                   Cause::mendable, "look for a second board with its node id"},
    CounterMeaning{"CAN frames", "node_refused",
                   "NODE_INFO or joints of a node that is quarantined, babbles or speaks another version",
                   Cause::mendable, "mend what the node's line says"},
    CounterMeaning{"CAN frames", "not_joint_source",
                   "joint states of a node that the rig does not name for them", Cause::mendable,
                   "set joints.node_id of the rig"},
    CounterMeaning{"CAN frames", "joint_repeated", "a joint frame that its sample has already",
                   Cause::mendable, "let one sender alone send joint states"},
    CounterMeaning{"CAN frames", "joint_no_host_time",
                   "a joint frame while the host does not know the time yet", Cause::outside,
                   "let a host send SYNC and FOLLOW_UP on the bus"},
    CounterMeaning{"CAN frames", "for_people",
                   "a piece of a node's black box, or a calibration's answer: for octoskin black-box and "
                   "octoskin calibrate, nothing for the map in it",
                   Cause::other_device, ""},
    CounterMeaning{"CAN frames", "mark_ignored",
                   "a START or STOP where none was waited for, or over 1 s from now", Cause::outside, ""},
    CounterMeaning{"readings", "node_absent", "the node has sent no heartbeat yet", Cause::outside,
                   "look at the node's cable and supply, and at the node ids of the rig"},
    CounterMeaning{"readings", "node_lost", "no heartbeat of the node for 350 ms", Cause::mendable,
                   "look at the node's cable and supply"},
    CounterMeaning{"readings", "node_version", "the node speaks another version of the protocol",
                   Cause::mendable, "flash the firmware of this version"},
    CounterMeaning{"readings", "node_quarantined", "two boards share the node id", Cause::mendable,
                   "give each board its own node id"},
    CounterMeaning{"readings", "node_babbling",
                   "the node sent over twice as many frames within a second as the rig has it send, and has "
                   "not kept to that for a second",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "node_time_suspect", "the node's clock source failed its own check",
                   Cause::mendable, "look at the board's crystal"},
    CounterMeaning{"readings", "node_info_incomplete",
                   "not all pages of NODE_INFO are here yet: usual at the start", Cause::outside,
                   "give it some seconds: NODE_INFO comes page by page"},
    CounterMeaning{"readings", "node_info_mismatch",
                   "configuration block, number of sensors or unique id is not what the rig says",
                   Cause::mendable, "flash the node with this rig, or give the rig that it was flashed with"},
    CounterMeaning{"readings", "node_build_refused", "the rig pins another firmware build", Cause::mendable,
                   "flash the build that the rig pins, or take the pin out"},
    CounterMeaning{"readings", "unknown_sensor", "a sensor index that the node does not have",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "no_host_time", "the host does not know the time yet", Cause::outside,
                   "let a host send SYNC and FOLLOW_UP on the bus"},
    CounterMeaning{"readings", "clock_not_ready",
                   "fewer than two SYNC exchanges with the node yet: usual in its first seconds",
                   Cause::outside, "give it some seconds, with the SYNC of a host on the bus"},
    CounterMeaning{
        "readings", "clock_in_doubt",
        "the newest exchange with the node contradicts those before: its clock jumped, or one of them is "
        "wrong. Or other readings of the node have times that cannot be, and this one's does not follow "
        "those of its sensor by its period. Stamps of a serial adapter, in steps of over 16 ms, look the "
        "same",
        Cause::mendable,
        "look for a second host that sends SYNC, and for an adapter that stamps frames coarsely or late"},
    CounterMeaning{"readings", "clock_silent", "no exchange with the node for too long", Cause::mendable,
                   "let the host send SYNC and FOLLOW_UP all the time"},
    CounterMeaning{"readings", "time_uncertain",
                   "the capture time may be further off than time_uncertainty_max_ms of the rig allows, or "
                   "the node has not reported how far",
                   Cause::mendable, "raise time_uncertainty_max_ms of the rig, or shorten the SYNC period"},
    CounterMeaning{"readings", "duplicate", "a reading that was here already", Cause::mendable, kSecondBoard},
    CounterMeaning{
        "readings", "contradicts_reading",
        "another of its sensor has its number and other contents, or a later number and an earlier time: a "
        "damaged frame or a second sender. Where the other still waited, it is counted here too",
        Cause::mendable, kSecondBoard},
    CounterMeaning{
        "readings", "sensor_disputed",
        "two senders speak under its sensor's name: refused until a second after the last sign of it",
        Cause::mendable, kSecondBoard},
    CounterMeaning{"readings", "out_of_window",
                   "older than the last 32 of its sensor, or its number does not fit its time",
                   Cause::mendable, kSecondBoard},
    CounterMeaning{"readings", "too_soon",
                   "its ranging window overlaps that of another reading of the sensor", Cause::mendable,
                   kSecondBoard},
    CounterMeaning{"readings", "too_young", "arrived before its ranging can have ended", Cause::mendable,
                   kSecondBoard},
    CounterMeaning{"readings", "too_old", "arrived later than half its budget and 100 ms after its capture",
                   Cause::mendable, "look for a bus that is full or an adapter that holds frames back"},
    CounterMeaning{"readings", "sensor_misconfigured",
                   "its node says that the sensor's registers are not as configured: it may look elsewhere, "
                   "or mean another range",
                   Cause::mendable,
                   "leave out the register that the node's line names, or exchange the sensor"},
    CounterMeaning{"readings", "no_return",
                   "the sensor saw no target, and the map leaves such beams alone (no_return_clear_m: 0): "
                   "usual when a beam leaves the room",
                   Cause::scene, "set no_return_clear_m of the mapping to let such beams free space"},
    CounterMeaning{"readings", "status_fault", "the sensor gave any status but \"valid\" and \"no target\"",
                   Cause::scene, "look at the sensor, its cover and its light: bring-up.md"},
    CounterMeaning{"readings", "zone_unknown", "the node does not know which zone was in force",
                   Cause::mendable, "flash the node with this rig"},
    CounterMeaning{"readings", "zone_not_in_rig", "a zone that the sensor does not have in the rig",
                   Cause::mendable, kFlashedRig},
    CounterMeaning{"readings", "not_finite", "a range that is no number", Cause::scene, ""},
    CounterMeaning{"readings", "below_range_min", "nearer than range_limits.min_m of the rig", Cause::scene,
                   ""},
    CounterMeaning{"readings", "above_range_max", "further than range_limits.max_m", Cause::scene, ""},
    CounterMeaning{"readings", "sigma_above_max",
                   "the sensor calls it less sure than range_limits.sigma_max_m", Cause::scene, ""},
    CounterMeaning{"readings", "queue_overflow", "displaced by newer ones in a full queue", Cause::mendable,
                   kMoreProcessor},
    CounterMeaning{"readings", "outside_marks",
                   "captured before START or after STOP: in a simulation the rest before the motion",
                   Cause::outside, "record from before START to after STOP"},
    CounterMeaning{"readings", "late", "came after the map had gone on", Cause::mendable, kMoreProcessor},
    CounterMeaning{"readings", "joints_missing", "no pose of the arm at its capture time", Cause::mendable,
                   "send joint states at 20 Hz or more, from before the first reading to after the last"},
    CounterMeaning{"readings", "self_hit",
                   "the beam reaches the robot's own body: usual for a sensor that sees another link",
                   Cause::scene, ""},
    CounterMeaning{"readings", "beam_not_valid", "a pose or range that is no number", Cause::mendable,
                   "look for a number that is none in the rig and the robot description"},
    CounterMeaning{"readings", "outside_map", "beyond the bounds of the octree", Cause::mendable,
                   "look at T_map_base of the rig, or raise the mapping's resolution_m"},
    CounterMeaning{"readings", "contradicts_camera",
                   "its sensor contradicts the camera (the problems say how): the map does without it until "
                   "it agrees again",
                   Cause::mendable, "measure the poses of the camera and of this sensor again"},
    CounterMeaning{"joint samples", "incomplete", "not all four frames of the sample came in time",
                   Cause::mendable, "look for lost frames, or for a source that leaves frames out"},
    CounterMeaning{"joint samples", "contradictory",
                   "two frames differ that should be one, or one came before the sample was taken, or out of "
                   "turn and so late that it may be of the next round",
                   Cause::mendable, kOneProgram},
    CounterMeaning{"joint samples", "clock_not_ready",
                   "fewer than two SYNC exchanges with the node yet: usual in its first seconds",
                   Cause::outside, "give it some seconds, with the SYNC of a host on the bus"},
    CounterMeaning{
        "joint samples", "clock_in_doubt",
        "the newest exchange with the node contradicts those before: its clock jumped, or one of them is "
        "wrong",
        Cause::mendable,
        "look for a second host that sends SYNC, and for an adapter that stamps frames coarsely or late"},
    CounterMeaning{"joint samples", "clock_silent", "no exchange with the node for too long", Cause::mendable,
                   "let the host send SYNC and FOLLOW_UP all the time"},
    CounterMeaning{"joint samples", "too_old", "arrived more than 50 ms after it was sampled",
                   Cause::mendable, "send each sample at once"},
    CounterMeaning{"joint samples", "out_of_limits", "a joint beyond the limits of the robot description",
                   Cause::mendable,
                   "send radians and metres in the order of joints of the rig, or correct the <limit>"},
    CounterMeaning{"joint samples", "out_of_order", "not later than the sample before it", Cause::mendable,
                   kOneProgram},
    CounterMeaning{"joint samples", "queue_overflow", "displaced by newer ones in a full queue",
                   Cause::mendable, kMoreProcessor},
    CounterMeaning{"joint samples", "too_frequent",
                   "the source is over 1.6 times as quick as joints.rate_hz of the rig says: its samples "
                   "cannot be distinguished with certainty. Its first five, if its clock is known by then",
                   Cause::mendable, "put the true rate into joints.rate_hz of the rig"},
    CounterMeaning{"joint samples", "second_sender",
                   "two senders of joint states are heard, or were within the last second, and it cannot be "
                   "decided which of them is true: neither is used",
                   Cause::mendable, kOneProgram},
    CounterMeaning{"joint samples", "joint_jump",
                   "further from the sample before it than 1.5 times the velocity of the robot description's "
                   "<limit> lets the arm move in that time",
                   Cause::mendable,
                   "let one program alone send joint states, or correct the velocity of the <limit>"},
    CounterMeaning{"depth frames", "no_camera", "the rig has no camera", Cause::outside,
                   "give a rig with the camera"},
    CounterMeaning{"depth frames", "wrong_size", "not the camera's width and height in the rig",
                   Cause::mendable, "give a rig whose camera has their width_px and height_px"},
    CounterMeaning{"depth frames", "out_of_order", "not later than the frame before it", Cause::mendable,
                   "let one camera alone send images"},
    CounterMeaning{"depth frames", "ahead_of_time",
                   "captured over a second after the newest known time: the bus fell silent, its log "
                   "ends before the images, or the camera's clock is wrong",
                   Cause::mendable, "set the clock of the camera, or record the bus to the end"},
    CounterMeaning{"depth frames", "queue_overflow", "displaced by newer ones in a full queue",
                   Cause::mendable, kMoreProcessor},
    CounterMeaning{"depth frames", "outside_marks",
                   "captured before START, after STOP, or before the first usable reading", Cause::outside,
                   "record from before START to after STOP"},
    CounterMeaning{"depth frames", "late", "came after the map had gone on", Cause::mendable, kMoreProcessor},
    CounterMeaning{"depth frames", "joints_missing",
                   "no pose of the arm at its capture time, so that the robot cannot be taken out",
                   Cause::mendable,
                   "send joint states at 20 Hz or more, from before the first reading to after the last"},
    CounterMeaning{"depth frames", "outside_map", "the camera is beyond the octree, or its pose is no number",
                   Cause::mendable, "correct the camera's pose"},
    CounterMeaning{"depth frames", "box_too_large", "its rays span more voxels than depth_box_voxels_max",
                   Cause::mendable, "raise depth_box_voxels_max, or resolution_m, of the mapping"},
    CounterMeaning{"depth frames", "no_memory", "the system had no memory to work it out with",
                   Cause::mendable, "free memory, or raise resolution_m of the mapping"},
    CounterMeaning{
        "depth images", "without_pose",
        "there are no poses about its time, or they are too far apart; usual at the beginning and the end",
        Cause::mendable,
        "raise camera.data_set.pose_gap_max_ms of the rig, or record poses at a higher rate"},
    CounterMeaning{"depth images", "unreadable",
                   "missing, damaged, or not grey with 16 bits: the replay ends there", Cause::mendable,
                   "take the line out of the list"},
    CounterMeaning{"depth images", "bad_line", "the line does not name an image and its time",
                   Cause::mendable, "correct the line, or take it out"},
    CounterMeaning{"camera poses", "no_pose",
                   "the pose at this time is not known: nan, a quaternion of zeros, or no file of it",
                   Cause::outside, ""},
    CounterMeaning{"camera poses", "bad_line", "the line, or the file of one pose, is no pose",
                   Cause::mendable, "correct the line, or take it out"},
    CounterMeaning{"camera poses", "repeated", "a pose of the same time is above it", Cause::outside, ""},
    CounterMeaning{"depth pixels", "no_value", "the camera or the filter gave none", Cause::scene, ""},
    CounterMeaning{"depth pixels", "robot", "on the robot, taken out", Cause::scene, ""},
    CounterMeaning{"depth pixels", "bad_value", "infinite, zero or negative", Cause::mendable, ""},
    CounterMeaning{"depth pixels", "outside_map", "beyond the bounds of the octree", Cause::mendable,
                   "correct the camera's pose, or raise resolution_m of the mapping"},
};

}  // namespace

std::span<const CounterMeaning> counter_meanings() noexcept {
    return kCounterMeanings;
}

const CounterMeaning* find_counter(std::string_view unit, std::string_view name) noexcept {
    const auto* const found = std::ranges::find_if(
        kCounterMeanings, [&](const CounterMeaning& one) { return one.unit == unit && one.name == name; });
    return found == kCounterMeanings.end() ? nullptr : &*found;
}

}  // namespace octoskin
