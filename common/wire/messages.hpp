// The bus messages, as plain values. docs/protocol.md has the byte layout; codec.hpp converts messages to
// frames and back.
#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "common/time.hpp"

namespace octoskin::wire {

/// The low 3 bits of byte 0 of every frame, fixed for all versions.
inline constexpr std::uint8_t kProtocolVersion = 1;

/// 1..62; 0 is the host, 63 addresses every node (commands).
using NodeId = std::uint8_t;
inline constexpr NodeId kHostId = 0;
inline constexpr NodeId kBroadcastId = 63;

inline constexpr std::uint8_t kAllSensors = 63;         ///< in commands
inline constexpr std::uint8_t kSensorsPerNodeMax = 63;  ///< sensor index: 6 bits, 63 = all
inline constexpr std::uint8_t kZonesMax = 15;           ///< zone index: 4 bits, 15 = unknown
inline constexpr std::uint8_t kZoneUnknown = 15;
inline constexpr std::uint8_t kSequenceCount = 64;  ///< readings: 6-bit sequence per (node, sensor)

/// The low bits of a node's clock as sent: the clock value modulo `span_us`, rounded down to the field's
/// step.
struct TimeResidue {
    std::uint32_t value_us = 0;
    std::uint32_t span_us = 0;
    friend constexpr bool operator==(const TimeResidue&, const TimeResidue&) = default;
};
inline constexpr std::uint32_t kClassicalTimeStepUs = 64;
inline constexpr std::uint32_t kClassicalTimeSpanUs = 1U << 18;  ///< 12 bits of 64 us: 262 ms
inline constexpr std::uint32_t kFdTimeSpanUs = 1U << 24;         ///< 24 bits of 1 us: 16.8 s

[[nodiscard]] constexpr TimeResidue classical_residue(NodeTime time) noexcept {
    const std::uint32_t low = time.us % kClassicalTimeSpanUs;
    return {.value_us = low - low % kClassicalTimeStepUs, .span_us = kClassicalTimeSpanUs};
}
[[nodiscard]] constexpr TimeResidue fd_residue(NodeTime time) noexcept {
    return {.value_us = time.us % kFdTimeSpanUs, .span_us = kFdTimeSpanUs};
}

/// One reading of one sensor, with everything that the host needs to accept or reject it.
struct RangeReading {
    std::uint8_t sensor = 0;             ///< local index on its node
    std::uint8_t zone = 0;               ///< ROI in force when the range began
    std::uint8_t device_status = 0;      ///< the device's 5-bit code; 19 for code 9 with stream count 0
    std::uint8_t sequence = 0;           ///< per (node, sensor), modulo 64
    std::uint16_t range_mm = 0;          ///< classical: saturates at 8191
    std::uint16_t sigma_quarter_mm = 0;  ///< device format 14.2; classical: whole mm, rounded up, at most 127
    TimeResidue capture;                 ///< middle of the ranging window on the node's clock
    friend constexpr bool operator==(const RangeReading&, const RangeReading&) = default;
};

/// Signal figures of one reading, device format 9.7 Mcps.
struct SignalReading {
    std::uint16_t peak_signal = 0;
    std::uint16_t ambient = 0;
    friend constexpr bool operator==(const SignalReading&, const SignalReading&) = default;
};

struct Range {  ///< classical: one reading in 8 bytes
    RangeReading reading;
    friend constexpr bool operator==(const Range&, const Range&) = default;
};
struct RangeAux {  ///< classical, optional, decimated; never needed for acceptance
    std::uint8_t sensor = 0;
    std::uint8_t sequence = 0;
    SignalReading signal;
    friend constexpr bool operator==(const RangeAux&, const RangeAux&) = default;
};
inline constexpr std::uint8_t kReadingsPerFdFrame = 4;
struct RangeFd {  ///< CAN FD: 1..4 lossless readings
    struct Entry {
        RangeReading reading;
        SignalReading signal;
        friend constexpr bool operator==(const Entry&, const Entry&) = default;
    };
    std::uint8_t count = 0;
    std::array<Entry, kReadingsPerFdFrame> entries{};
    friend constexpr bool operator==(const RangeFd&, const RangeFd&) = default;
};

/// Sent once when something comes closer than a sensor's configured limit, with the highest priority on the
/// bus: for a device that must stop an arm at once. The reading itself follows as RANGE or RANGE_FD.
struct Reflex {
    std::uint8_t sensor = 0;
    std::uint8_t zone = 0;
    std::uint16_t range_mm = 0;  ///< saturates at 8191
    TimeResidue capture;         ///< classical_residue
    std::uint8_t sequence = 0;   ///< counts the node's events, modulo 64
    friend constexpr bool operator==(const Reflex&, const Reflex&) = default;
};

inline constexpr std::uint8_t kBlackBoxBytes = 5;
inline constexpr std::uint16_t kBlackBoxFramesMax = 512;
/// One piece of a dump of the last transfers on one I2C bus. black_box.hpp describes the whole dump.
struct BlackBox {
    std::uint8_t bus = 0;     ///< 0..3
    std::uint8_t dump = 0;    ///< number of the dump: counts the node's dumps modulo 4
    std::uint16_t index = 0;  ///< of this piece in its dump
    std::array<std::uint8_t, kBlackBoxBytes> bytes{};
    friend constexpr bool operator==(const BlackBox&, const BlackBox&) = default;
};

enum class NodeState : std::uint8_t {
    starting = 0,  ///< sensors are being brought up
    ranging = 1,
    stopped = 2,      ///< by command
    safe = 3,         ///< after repeated resets: heartbeat only
    bad_config = 4,   ///< configuration block missing, damaged or for another board: no ranging
    id_conflict = 5,  ///< received a frame with its own node id: ranging stopped
    bus_fault = 6,    ///< no I2C bus usable
    can_fault = 7,    ///< bus-off less than a second ago, or error-passive; ranging continues
};
enum class ResetCause : std::uint8_t {
    power_on = 0,
    brown_out = 1,
    watchdog = 2,
    software = 3,
    pin = 4,
    fault = 5,
    unknown = 7,
};
/// 10 Hz, one classical frame of 8 bytes in all versions.
struct Heartbeat {
    NodeState state = NodeState::starting;
    ResetCause reset_cause = ResetCause::unknown;
    bool is_rate_overridden = false;    ///< a volatile rate command is in force
    bool is_time_suspect = false;       ///< the node's clock source failed its check
    std::uint8_t degraded_sensors = 0;  ///< sensors not ranging as configured; saturates at 31
    std::uint16_t uid_crc = 0;          ///< CRC-16 of the 96-bit unique id
    std::uint16_t node_hash_low = 0;
    friend constexpr bool operator==(const Heartbeat&, const Heartbeat&) = default;
};

/// Sent as pages at start, on request and once a second. Pages arrive in any order; a receiver has the
/// complete info once it has every page.
enum class InfoPage : std::uint8_t {
    uid_low = 0,
    uid_high = 1,
    identity = 2,
    build = 3,
    counters = 4,
    traffic = 5,
    fault = 6,
};
inline constexpr std::uint8_t kInfoPages = 7;
struct InfoUidLow {
    std::array<std::uint8_t, 6> uid{};
    friend constexpr bool operator==(const InfoUidLow&, const InfoUidLow&) = default;
};
struct InfoUidHigh {
    std::array<std::uint8_t, 6> uid{};
    friend constexpr bool operator==(const InfoUidHigh&, const InfoUidHigh&) = default;
};
struct InfoIdentity {
    std::uint32_t node_hash = 0;  ///< CRC-32 of the configuration block
    std::uint8_t sensor_count = 0;
    std::uint8_t board_type = 0;  ///< hw/boards/: the number of the board type
    friend constexpr bool operator==(const InfoIdentity&, const InfoIdentity&) = default;
};
struct InfoBuild {
    std::uint32_t build_id = 0;  ///< first 32 bits of the firmware's git commit
    std::uint16_t uptime_s = 0;  ///< saturates
    friend constexpr bool operator==(const InfoBuild&, const InfoBuild&) = default;
};
struct InfoCounters {  ///< since start, saturating
    std::uint16_t i2c_errors = 0;
    std::uint16_t reads_disagreed = 0;  ///< double reads that never agreed
    std::uint16_t sensor_restarts = 0;
    friend constexpr bool operator==(const InfoCounters&, const InfoCounters&) = default;
};
struct InfoTraffic {                 ///< since start, saturating
    std::uint16_t tx_dropped = 0;    ///< displaced by newer readings, or given up by the controller
    std::uint16_t late_dropped = 0;  ///< readings, REFLEX and SYNC_REPORT that waited over 50 ms to be sent
    std::uint8_t bus_off_count = 0;
    std::uint8_t rx_rejected = 0;  ///< frames for this node that failed length, CRC or version
    friend constexpr bool operator==(const InfoTraffic&, const InfoTraffic&) = default;
};
/// A recorded fault has reset the node. A present fault exists now, and has caused no reset.
enum class FaultKind : std::uint8_t {
    none = 0,
    assertion = 1,    ///< where: number of the assertion in the build's map
    hard_fault = 2,   ///< where: program counter
    stack_guard = 3,  ///< where: program counter
    watchdog = 4,     ///< no fault was recorded before the reset
    brown_out = 5,
    clock_fault = 6,   ///< the crystal failed
    xshut_stuck = 7,   ///< present fault, no reset; where: XSHUT line that does not reset its sensor
    stray_sensor = 8,  ///< present fault, no reset; where: I2C bus with an unexpected answer at 0x29
    /// Present fault, no reset: a register of a sensor does not keep the value written. where:
    /// RegisterReport, whose subject is the sensor.
    register_fixed = 9,
    /// Present fault, no reset: the data-ready line of I2C bus `where` had too many spurious falls and is
    /// ignored. Its sensors are still read.
    data_ready_ignored = 10,
    /// Present fault, no reset: on three or more of the node's sensors a register reads back the same value,
    /// which is not the one written. This is a property of the type of part, and no reading is withheld for
    /// it. where: RegisterReport, whose subject is the number of sensors that had shown it when it was
    /// recognised.
    register_alike = 11,
    /// Present fault, no reset: sensor `where` had not reported the end of its boot when it was given its
    /// address.
    boot_late = 12,
    /// Present fault, no reset: a COMMAND was refused, because the rig has the node refuse all of them
    /// (`refuses_commands`). where: the command's code.
    commands_refused = 13,
    unknown = 15,
};
/// `InfoFault::where` for a register: subject in bits 31:24, register index in 23:16, the value written in
/// 15:8 and the value read in 7:0.
struct RegisterReport {
    std::uint8_t subject = 0;
    std::uint8_t index = 0;
    std::uint8_t written = 0;
    std::uint8_t read = 0;
    [[nodiscard]] constexpr std::uint32_t where() const noexcept {
        return std::uint32_t{subject} << 24U | std::uint32_t{index} << 16U | std::uint32_t{written} << 8U |
               read;
    }
    [[nodiscard]] static constexpr RegisterReport of(std::uint32_t where) noexcept {
        return {.subject = static_cast<std::uint8_t>(where >> 24U),
                .index = static_cast<std::uint8_t>(where >> 16U & 0xFFU),
                .written = static_cast<std::uint8_t>(where >> 8U & 0xFFU),
                .read = static_cast<std::uint8_t>(where & 0xFFU)};
    }
    friend constexpr bool operator==(const RegisterReport&, const RegisterReport&) = default;
};
/// One fault: the node's present faults and the last recorded fault take turns. Without any fault, all fields
/// are 0.
struct InfoFault {
    FaultKind kind = FaultKind::none;
    std::uint8_t count = 0;     ///< unexpected resets since the last intended one; saturates at 15
    std::uint32_t where = 0;    ///< meaning depends on `kind`
    std::uint8_t uptime_s = 0;  ///< length of the run that the fault ended; saturates at 255
    friend constexpr bool operator==(const InfoFault&, const InfoFault&) = default;
};
using NodeInfo =
    std::variant<InfoUidLow, InfoUidHigh, InfoIdentity, InfoBuild, InfoCounters, InfoTraffic, InfoFault>;

enum class SensorState : std::uint8_t {
    absent = 0,  ///< never answered
    starting = 1,
    ranging = 2,
    stopped = 3,
    degraded = 4,  ///< answers, but ten readings in a row were rejected on the node
    lost = 5,      ///< answered before, does not now
};
enum class SensorFault : std::uint8_t {
    none = 0,
    no_answer = 1,
    wrong_id = 2,
    boot_timeout = 3,
    config_mismatch = 4,
    no_data_ready = 5,
    stale_stream = 6,
    reads_disagree = 7,
    implausible_block = 8,
    bus_error = 9,
    address_conflict = 10,
    xshut_stuck = 11,    ///< its XSHUT line does not put it in reset
    hardware_fail = 12,  ///< reported by the sensor itself, range after range: user status 5
};
/// On change and once a second.
struct SensorHealth {
    std::uint8_t sensor = 0;
    SensorState state = SensorState::absent;
    SensorFault fault = SensorFault::none;  ///< why it is not ranging, or the last fault
    std::uint16_t sent = 0;  ///< readings sent since start, modulo 2^16; each reading in a frame counts
    std::uint8_t capture_bound_64us =
        0;                      ///< bound on the capture time's error, in steps of 64 us, rounded up
    std::uint8_t rejected = 0;  ///< readings rejected on the node since start, modulo 256
    std::int8_t period_error_permille = 0;  ///< measured period against the configured one, saturating
    friend constexpr bool operator==(const SensorHealth&, const SensorHealth&) = default;
};

/// Two-step synchronisation: every node records its clock at the end of SYNC; FOLLOW_UP carries the host's
/// own time stamp of that instant; each node reports its record in SYNC_REPORT.
inline constexpr std::uint8_t kSyncSequenceCount = 32;
struct Sync {
    std::uint8_t sequence = 0;
    friend constexpr bool operator==(const Sync&, const Sync&) = default;
};
struct FollowUp {
    std::uint8_t sequence = 0;       ///< of its SYNC
    std::uint64_t host_time_us = 0;  ///< host clock at the end of that SYNC, 48 bits
    friend constexpr bool operator==(const FollowUp&, const FollowUp&) = default;
};
struct SyncReport {
    std::uint8_t sequence = 0;
    NodeTime heard;  ///< node clock at the end of that SYNC
    friend constexpr bool operator==(const SyncReport&, const SyncReport&) = default;
};

inline constexpr std::uint8_t kJointsPerSample = 7;
inline constexpr std::uint8_t kJointSequenceCount = 8;
/// Frames 0..2 carry joints (2i, 2i+1); frame 3 carries joint 6 and the sample's time.
struct JointPair {
    std::uint8_t index = 0;  ///< 0..2
    std::uint8_t sequence = 0;
    std::array<std::int32_t, 2> position_urad{};  ///< 24 bits signed: +-8.38 rad
    friend constexpr bool operator==(const JointPair&, const JointPair&) = default;
};
struct JointLast {
    std::uint8_t sequence = 0;
    std::int32_t position_urad = 0;
    TimeResidue sampled;  ///< span kFdTimeSpanUs
    friend constexpr bool operator==(const JointLast&, const JointLast&) = default;
};
using JointState = std::variant<JointPair, JointLast>;

enum class MarkKind : std::uint8_t { stop = 0, start = 1 };
/// From the host (recorder or simulator): measurements captured before START or after STOP are kept out of
/// the map.
struct Mark {
    MarkKind kind = MarkKind::start;
    std::uint64_t host_time_us = 0;  ///< 48 bits
    friend constexpr bool operator==(const Mark&, const Mark&) = default;
};

enum class CommandCode : std::uint8_t {
    start = 1,
    stop = 2,
    set_rate = 3,
    reinitialise_sensor = 4,
    identify = 5,
    reset = 6,
    send_info = 7,
    send_black_box = 8,  ///< the last transfers on the I2C bus of a sensor, or on all buses
    /// One sensor, facing a target at a known range; the node answers with CALIBRATION.
    calibrate_offset = 9,
    calibrate_crosstalk = 10,
};
struct Command {
    CommandCode code = CommandCode::start;
    std::uint8_t sensor = kAllSensors;
    std::uint16_t argument = 0;  ///< set_rate: inter-measurement period in ms; identify: seconds;
                                 ///< calibrate_...: range of the target in mm; else 0
    std::uint8_t sequence = 0;
    friend constexpr bool operator==(const Command&, const Command&) = default;
};

enum class CalibrationQuantity : std::uint8_t { offset = 0, crosstalk = 1 };
enum class CalibrationOutcome : std::uint8_t {
    under_way = 0,
    done = 1,
    refused = 2,         ///< no such sensor, no such target, or another calibration is under way on the node
    not_brought_up = 3,  ///< the sensor could not be initialised; SENSOR_HEALTH gives the reason
    device_failed = 4,   ///< it failed during the calibration
    no_result = 5,       ///< no range for 2 s
    no_target = 6,       ///< too many ranges without a valid result
    out_of_range = 7,    ///< the offset does not fit the device's 13 bits
};
/// The answer to a calibration command: at once `under_way` or `refused`; after `under_way` the final
/// outcome. The sensor is then brought up again as configured: the node keeps nothing of a calibration.
struct Calibration {
    std::uint8_t sensor = 0;
    CalibrationQuantity quantity = CalibrationQuantity::offset;
    CalibrationOutcome outcome = CalibrationOutcome::under_way;
    std::uint8_t sequence = 0;           ///< of the command
    std::int16_t offset_quarter_mm = 0;  ///< if `done`: of an offset calibration; else 0
    std::uint16_t crosstalk_raw = 0;     ///< if `done`: of a crosstalk calibration, 7.9 kcps per SPAD; else 0
    friend constexpr bool operator==(const Calibration&, const Calibration&) = default;
};

using Message = std::variant<Range, RangeAux, RangeFd, Heartbeat, NodeInfo, SensorHealth, Sync, FollowUp,
                             SyncReport, JointState, Mark, Command, Reflex, BlackBox, Calibration>;

}  // namespace octoskin::wire
