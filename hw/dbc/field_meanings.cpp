#include "hw/dbc/field_meanings.hpp"

#include <algorithm>
#include <array>

namespace octoskin::dbc {
namespace {

using enum wire::FrameType;

// Texts that several messages share.
constexpr std::string_view kSensor = "local index on the node";
constexpr std::string_view kZone =
    "index of the region of interest in force when the range began; a reading with an unknown index is not "
    "used";
constexpr std::string_view kStatus = "the device's own code: bits 4:0 of its register 0x0089";
constexpr std::string_view kReadings = "counts the readings sent from this sensor, modulo 64";
constexpr std::string_view kCapture = "middle of the ranging window, on the node's clock";
constexpr std::string_view kSignal = "signal of the target, the device's 9.7 format";
constexpr std::string_view kAmbient = "ambient light, the device's 9.7 format";
constexpr std::string_view kShortRange = "negative is sent as 0; saturates at 8191";

constexpr std::array kFieldMeanings = {
    FieldMeaning{reflex, "sensor", kSensor},
    FieldMeaning{reflex, "zone", kZone},
    FieldMeaning{reflex, "range", kShortRange},
    FieldMeaning{reflex, "capture_time", kCapture},
    FieldMeaning{reflex, "sequence", "counts the node's events, modulo 64"},

    FieldMeaning{sync, "sequence", "counts the SYNC frames, modulo 32"},
    FieldMeaning{follow_up, "sequence", "of the SYNC it belongs to"},
    FieldMeaning{follow_up, "host_time", "the host's clock at the end of that SYNC frame"},
    FieldMeaning{sync_report, "sequence", "of the SYNC it answers"},
    FieldMeaning{sync_report, "heard", "the node's clock at the end of that SYNC frame, all 32 bits"},

    FieldMeaning{command, "code", "what to do"},
    FieldMeaning{command, "sensor", "local index; ignored by commands that concern the node"},
    FieldMeaning{command, "argument", "depends on the code; 0 where there is none"},
    FieldMeaning{command, "sequence",
                 "number of the command, modulo 256; the same command within 0.5 s is not performed again"},

    FieldMeaning{mark, "kind", "data captured before START or after STOP is not mapped"},
    FieldMeaning{mark, "host_time", "instant of the mark on the host's clock"},

    FieldMeaning{heartbeat, "state", "what the node does"},
    FieldMeaning{heartbeat, "reset_cause", "why the node started"},
    FieldMeaning{heartbeat, "is_rate_overridden", "a volatile rate command is in force"},
    FieldMeaning{heartbeat, "is_time_suspect",
                 "the node's clock failed its own check, or is not within 100 ppm: the host uses none of its "
                 "times. Nodes of this project never set it"},
    FieldMeaning{heartbeat, "degraded_sensors", "sensors that do not range as configured; saturates at 31"},
    FieldMeaning{heartbeat, "uid_crc", "CRC-16, as that of frames, of the 12 bytes of the unique id"},
    FieldMeaning{heartbeat, "node_hash_low", "low half of node_hash in NODE_INFO"},

    FieldMeaning{joint_state, "index", "which of the four frames of a sample"},
    FieldMeaning{joint_state, "sequence", "the same in all four; counts samples, modulo 8"},
    FieldMeaning{joint_state, "position",
                 "angle of this joint in the rig's order; zero if the rig has fewer"},
    FieldMeaning{joint_state, "sample_time", "when this sample was taken, on the node's clock"},

    FieldMeaning{range, "sensor", kSensor},
    FieldMeaning{range, "zone", kZone},
    FieldMeaning{range, "device_status", kStatus},
    FieldMeaning{range, "range", kShortRange},
    FieldMeaning{range, "sigma", "the device's estimate, rounded up; saturates at 127"},
    FieldMeaning{range, "capture_time", kCapture},
    FieldMeaning{range, "sequence", kReadings},

    FieldMeaning{range_fd, "count", "readings in this frame"},
    FieldMeaning{range_fd, "sensor", kSensor},
    FieldMeaning{range_fd, "zone", kZone},
    FieldMeaning{range_fd, "device_status", kStatus},
    FieldMeaning{range_fd, "sequence", kReadings},
    FieldMeaning{range_fd, "range", "negative is sent as 0"},
    FieldMeaning{range_fd, "sigma", "the device's estimate, its 14.2 format"},
    FieldMeaning{range_fd, "peak_signal", kSignal},
    FieldMeaning{range_fd, "ambient", kAmbient},
    FieldMeaning{range_fd, "capture_time", kCapture},

    FieldMeaning{range_aux, "sensor", kSensor},
    FieldMeaning{range_aux, "sequence", "of the RANGE it belongs to"},
    FieldMeaning{range_aux, "peak_signal", kSignal},
    FieldMeaning{range_aux, "ambient", kAmbient},

    FieldMeaning{sensor_health, "sensor", kSensor},
    FieldMeaning{sensor_health, "state", "what the sensor does"},
    FieldMeaning{sensor_health, "fault", "why it does not range, or its last fault"},
    FieldMeaning{sensor_health, "sent", "readings of this sensor sent since start, modulo 65536"},
    FieldMeaning{sensor_health, "capture_bound",
                 "bound on the error of its capture times, rounded up; saturates"},
    FieldMeaning{sensor_health, "rejected", "its readings rejected on the node since start, modulo 256"},
    FieldMeaning{sensor_health, "period_error", "measured period against the configured one; saturates"},

    FieldMeaning{node_info, "page", "which other fields the frame has"},
    FieldMeaning{node_info, "uid_low", "bytes 0..5 of the chip's unique id, byte 0 lowest"},
    FieldMeaning{node_info, "uid_high", "bytes 6..11 of the unique id"},
    FieldMeaning{node_info, "node_hash",
                 "CRC-32, as zlib's, of the configuration block that octoskin compiles from the rig"},
    FieldMeaning{node_info, "sensor_count", "sensors of the configuration"},
    FieldMeaning{node_info, "board_type", "number of the board type in hw/boards/"},
    FieldMeaning{node_info, "build_id", "first 32 bits of the firmware's git commit"},
    FieldMeaning{node_info, "uptime", "since start; saturates"},
    FieldMeaning{node_info, "i2c_errors", "failed transfers since start, also those retried; saturates"},
    FieldMeaning{node_info, "reads_disagreed",
                 "readings since start whose two reads never agreed; saturates"},
    FieldMeaning{node_info, "sensor_restarts", "repeated initialisations since start; saturates"},
    FieldMeaning{node_info, "tx_dropped",
                 "readings since start that a newer one of the sensor displaced, and frames that "
                 "the controller could not send (not acknowledged for 20 ms, or pending at bus-off), counted "
                 "by their readings; saturates"},
    FieldMeaning{node_info, "late_dropped",
                 "readings, REFLEX and SYNC_REPORT since start that waited over 50 ms to be sent; saturates"},
    FieldMeaning{node_info, "bus_off_count", "times at bus-off since start; saturates"},
    FieldMeaning{node_info, "rx_rejected", "frames for this node that it refused since start; saturates"},
    FieldMeaning{node_info, "fault_kind",
                 "alternates between the present faults and the last one, which is kept over a reset; "
                 "without a fault the page is zero"},
    FieldMeaning{node_info, "fault_count", "unexpected resets since the last intended one; saturates"},
    FieldMeaning{node_info, "fault_where", "depends on fault_kind; else 0"},
    FieldMeaning{node_info, "fault_uptime", "length of the run that the fault ended; saturates"},

    FieldMeaning{calibration, "sensor", kSensor},
    FieldMeaning{calibration, "quantity", "what is calibrated"},
    FieldMeaning{calibration, "outcome", "how far the calibration is, or how it ended"},
    FieldMeaning{calibration, "sequence", "of the command"},
    FieldMeaning{calibration, "offset", "added by the device, its 11.2 format; 0 unless done and quantity 0"},
    FieldMeaning{calibration, "crosstalk", "per SPAD, the device's 7.9 format; 0 unless done and quantity 1"},

    FieldMeaning{black_box, "bus", "index of the I2C bus on the node"},
    FieldMeaning{black_box, "dump", "counts the node's dumps, modulo 4"},
    FieldMeaning{black_box, "index", "number of this piece"},
    FieldMeaning{black_box, "bytes", "five bytes of the dump, from byte 5 times index; zero beyond the end"},
};

constexpr std::string_view kReset = "has reset the node";
constexpr std::string_view kProgramCounter = "program counter";
constexpr std::string_view kBus = "index of the I2C bus";
constexpr std::string_view kTarget = "range of the target in mm, 1..4000";

constexpr std::array kValueMeanings = {
    ValueMeaning{heartbeat, "state", "starting", "brings its sensors up"},
    ValueMeaning{heartbeat, "state", "stopped", "by command"},
    ValueMeaning{heartbeat, "state", "safe", "repeated resets: heartbeat only"},
    ValueMeaning{heartbeat, "state", "bad_config",
                 "configuration block missing, damaged or for another board"},
    ValueMeaning{heartbeat, "state", "id_conflict", "received its own node id from another sender"},
    ValueMeaning{heartbeat, "state", "bus_fault", "no I2C bus usable"},
    ValueMeaning{heartbeat, "state", "can_fault",
                 "ranges, but was bus-off less than a second ago, or its controller is error-passive"},

    ValueMeaning{node_info, "fault_kind", "assertion", kReset, "number of the assertion"},
    ValueMeaning{node_info, "fault_kind", "hard_fault", kReset, kProgramCounter},
    ValueMeaning{node_info, "fault_kind", "stack_guard", kReset, kProgramCounter},
    ValueMeaning{node_info, "fault_kind", "watchdog", kReset},
    ValueMeaning{node_info, "fault_kind", "brown_out", kReset},
    ValueMeaning{node_info, "fault_kind", "clock_fault", "has reset the node: the crystal failed"},
    ValueMeaning{node_info, "fault_kind", "xshut_stuck", "the line does not reset its sensor",
                 "index of the XSHUT line"},
    ValueMeaning{node_info, "fault_kind", "stray_sensor", "an unexpected answer at 0x29", kBus},
    ValueMeaning{node_info, "fault_kind", "register_fixed", "a register does not keep its value",
                 "from the highest byte down: sensor, register, value written, value read"},
    ValueMeaning{node_info, "fault_kind", "data_ready_ignored", "the data-ready line has only noise", kBus},
    ValueMeaning{node_info, "fault_kind", "register_alike",
                 "a register has the same wrong value on three or more sensors",
                 "as for register_fixed, with the number of sensors in place of the sensor"},
    ValueMeaning{node_info, "fault_kind", "boot_late",
                 "a sensor got its address before it reported the end of its boot", "the sensor"},
    ValueMeaning{
        node_info, "fault_kind", "commands_refused",
        "a COMMAND was refused because of refuses_commands; from within 100 ms until 2 s after the last",
        "code of the first one"},
    ValueMeaning{node_info, "fault_kind", "unknown", kReset},

    ValueMeaning{sensor_health, "state", "absent", "never answered"},
    ValueMeaning{sensor_health, "state", "starting", "is brought up"},
    ValueMeaning{sensor_health, "state", "stopped", "by command, or while it is calibrated"},
    ValueMeaning{sensor_health, "state", "degraded", "answers, but the node rejects its readings"},
    ValueMeaning{sensor_health, "state", "lost", "answered before, but not now"},

    ValueMeaning{sensor_health, "fault", "no_answer", "does not acknowledge its address"},
    ValueMeaning{sensor_health, "fault", "wrong_id", "another model, or a damaged reply"},
    ValueMeaning{sensor_health, "fault", "boot_timeout", "answers, but never reports the end of its boot"},
    ValueMeaning{sensor_health, "fault", "config_mismatch", "a register does not read back as written"},
    ValueMeaning{sensor_health, "fault", "no_data_ready", "no new readings"},
    ValueMeaning{sensor_health, "fault", "stale_stream", "its results do not come at its period"},
    ValueMeaning{sensor_health, "fault", "reads_disagree", "the two reads of a result differ"},
    ValueMeaning{sensor_health, "fault", "implausible_block", "the result is inconsistent"},
    ValueMeaning{sensor_health, "fault", "bus_error", "line held, arbitration lost, or no time"},
    ValueMeaning{sensor_health, "fault", "address_conflict", "two sensors answer at one address"},
    ValueMeaning{sensor_health, "fault", "xshut_stuck", "its XSHUT line does not put it in reset"},
    ValueMeaning{sensor_health, "fault", "hardware_fail",
                 "device status 1, 2, 3 or 17 in consecutive ranges"},

    ValueMeaning{command, "code", "start",
                 "range again; a sensor stopped for over a minute is first brought up anew, in 0.3 s"},
    ValueMeaning{command, "code", "stop", "stop ranging"},
    ValueMeaning{command, "code", "set_rate",
                 "another inter-measurement period, until reset; the heartbeat shows it",
                 "period in ms; 0: as configured"},
    ValueMeaning{command, "code", "reinitialise_sensor", "bring it up anew"},
    ValueMeaning{command, "code", "identify", "blink", "seconds"},
    ValueMeaning{command, "code", "reset", "restart the node"},
    ValueMeaning{command, "code", "send_info",
                 "send all pages of NODE_INFO, and SENSOR_HEALTH of each sensor, now"},
    ValueMeaning{command, "code", "send_black_box",
                 "send BLACK_BOX of the bus of the sensor, or of all buses"},
    ValueMeaning{command, "code", "calibrate_offset",
                 "calibrate one sensor, not all; the node answers with CALIBRATION", kTarget},
    ValueMeaning{command, "code", "calibrate_crosstalk", "the same", kTarget},

    ValueMeaning{calibration, "outcome", "under_way", "has begun, or goes on"},
    ValueMeaning{calibration, "outcome", "done", "the frame has the result"},
    ValueMeaning{calibration, "outcome", "refused",
                 "no such sensor, no such target, commands refused, or another calibration is under way"},
    ValueMeaning{calibration, "outcome", "not_brought_up", "SENSOR_HEALTH has the reason"},
    ValueMeaning{calibration, "outcome", "device_failed", "failed during the calibration"},
    ValueMeaning{calibration, "outcome", "no_result", "no range for 2 s, or for 3 periods if that is longer"},
    ValueMeaning{calibration, "outcome", "no_target", "more than 10 ranges without a valid result"},
    ValueMeaning{calibration, "outcome", "out_of_range", "the offset does not fit the device's 13 bits"},
};

constexpr std::array kSendingTimes = {
    SendingTime{reflex, "within 5 ms of reading out a range that is too close; not sent if over 50 ms late"},
    SendingTime{sync,
                "once a second; after a silence of the bus or readings with impossible times once more, at "
                "least 250 ms later"},
    SendingTime{follow_up, "after each SYNC"},
    SendingTime{command, "by octoskin command"},
    SendingTime{mark, "by the recorder or the simulator"},
    SendingTime{heartbeat, "every 100 ms, from within 300 ms after reset, in every state"},
    SendingTime{joint_state,
                "four frames per sample, back to back, at the rig's rate, less than 50 ms after the sample"},
    SendingTime{sync_report, "after each valid SYNC that has a time stamp: at once, within 50 ms or never"},
    SendingTime{range, "classical bus: each reading once, within 50 ms of its being ready, or never"},
    SendingTime{range_fd, "CAN FD bus: as RANGE; a reading may wait some milliseconds to share a frame"},
    SendingTime{sensor_health,
                "each sensor once a second, when its state, fault or capture_bound changes, "
                "and on send_info; not in state safe"},
    SendingTime{node_info,
                "each page at start, once a second, and on send_info, in any order; not required of "
                "a joint source"},
    SendingTime{range_aux, "after every n-th RANGE, n being aux_every of the rig; without aux_every never"},
    SendingTime{calibration,
                "within 100 ms of the command; when it has ended, at once and after each of the "
                "next two heartbeats"},
    SendingTime{black_box,
                "after a sensor failed, at most once a minute for each bus, and on send_black_box; "
                "at most 20 frames a second"},
};

}  // namespace

std::span<const FieldMeaning> field_meanings() noexcept {
    return kFieldMeanings;
}

std::string_view meaning_of(wire::FrameType type, std::string_view field) noexcept {
    const auto found = std::ranges::find_if(kFieldMeanings, [type, field](const FieldMeaning& meaning) {
        return meaning.type == type && meaning.field == field;
    });
    return found == kFieldMeanings.end() ? std::string_view{} : found->text;
}

std::span<const ValueMeaning> value_meanings() noexcept {
    return kValueMeanings;
}

std::string_view detail_field(wire::FrameType type, std::string_view field) noexcept {
    if (type == command && field == "code") return "argument";
    if (type == node_info && field == "fault_kind") return "fault_where";
    return {};
}

std::span<const SendingTime> sending_times() noexcept {
    return kSendingTimes;
}

}  // namespace octoskin::dbc
