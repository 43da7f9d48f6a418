// The byte layout of every message, written once. A *walker* visits a message's fields in wire order. The
// codec has one walker that writes and one that reads; the DBC (hw/dbc) has one that describes. They cannot
// differ from each other. The caller of a walker handles the fields that every frame has: the version, which
// is first, and the CRC, which is last.
//
// Walker:   number(field, value)    unsigned or signed integer of `field.bits`, within `field.min..max`
//           saturated(field, value) the same, but a larger value is sent as the largest
//           rounded_up(field, quarter_mm)  quarter millimetres as whole millimetres, rounded up, saturated
//           residue(field, time)    the low bits of a clock, in steps of `field.unit`, rounded down
//           choice(field, value)    an enumeration with a table in names.hpp
//           flag(field, value)      one bit
//           bytes(field, array)     the first byte in the lowest bits
//           selector(field, value)  selects one of several layouts. The value is a constant or a member of
//                                   the message. It follows the version; a reader evaluates it before the
//                                   walk
//           zeros(bits)             padding
//           entries_present(count)  how many readings follow
#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>

#include "common/wire/bits.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::wire {

/// The unit of one step of a field's value.
enum class Unit : std::uint8_t {
    none,
    millimetre,
    quarter_millimetre,
    microsecond,
    step_of_64_us,
    second,
    mcps_by_128,  ///< 1/128 million counts a second: the device's 9.7 format
    microradian,
    permille,
    kcps_by_512,  ///< 1/512 thousand counts a second and SPAD: the device's 7.9 format
};

struct Field {
    const char* name;
    unsigned bits;
    Unit unit;
    std::uint64_t min = 0;
    std::uint64_t max;
    std::optional<unsigned> index;  ///< distinguishes repeated fields of one name

    constexpr Field(const char* field_name, unsigned field_bits, Unit field_unit = Unit::none)
        : name(field_name), bits(field_bits), unit(field_unit), max(max_of_bits(field_bits)) {}
    [[nodiscard]] constexpr Field within(std::uint64_t least, std::uint64_t most) const {
        Field field = *this;
        field.min = least;
        field.max = most;
        return field;
    }
    [[nodiscard]] constexpr Field at(unsigned which) const {
        Field field = *this;
        field.index = which;
        return field;
    }
};

/// The step of a residue's field in microseconds.
[[nodiscard]] constexpr std::uint32_t step_us(Unit unit) noexcept {
    return unit == Unit::step_of_64_us ? kClassicalTimeStepUs : 1;
}

inline constexpr unsigned kVersionBits = 3;
inline constexpr unsigned kInfoPageBits = 3;
inline constexpr unsigned kJointIndexBits = 2;
inline constexpr std::uint8_t kJointIndexLast = 3;
inline constexpr unsigned kRangeFdEntryBits = 14 * 8;

/// A walker that writes or describes takes messages as const; one that reads fills them in.
template <class Walker, class T>
using Of = std::conditional_t<Walker::kFillsIn, T, const T>;

inline constexpr Field kSensorField = Field("sensor", 6).within(0, kSensorsPerNodeMax - 1U);
inline constexpr Field kZoneField = Field("zone", 4);
inline constexpr Field kDeviceStatusField = Field("device_status", 5);
inline constexpr Field kReadingSequenceField = Field("sequence", 6);
inline constexpr Field kPeakSignalField = Field("peak_signal", 16, Unit::mcps_by_128);
inline constexpr Field kAmbientField = Field("ambient", 16, Unit::mcps_by_128);

template <class Walker>
void walk(Walker& walker, Of<Walker, Range>& range) {
    auto& reading = range.reading;
    walker.number(kSensorField, reading.sensor);
    walker.number(kZoneField, reading.zone);
    walker.number(kDeviceStatusField, reading.device_status);
    walker.saturated(Field("range", 13, Unit::millimetre), reading.range_mm);
    walker.rounded_up(Field("sigma", 7, Unit::millimetre), reading.sigma_quarter_mm);
    walker.residue(Field("capture_time", 12, Unit::step_of_64_us), reading.capture);
    walker.number(kReadingSequenceField, reading.sequence);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, Reflex>& reflex) {
    walker.number(kSensorField, reflex.sensor);
    walker.number(kZoneField, reflex.zone);
    walker.saturated(Field("range", 13, Unit::millimetre), reflex.range_mm);
    walker.residue(Field("capture_time", 12, Unit::step_of_64_us), reflex.capture);
    walker.number(kReadingSequenceField, reflex.sequence);
    walker.zeros(4);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, BlackBox>& piece) {
    walker.number(Field("bus", 2), piece.bus);
    walker.number(Field("dump", 2), piece.dump);
    walker.number(Field("index", 9), piece.index);
    walker.bytes(Field("bytes", 8 * kBlackBoxBytes), piece.bytes);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, RangeAux>& aux) {
    walker.number(kSensorField, aux.sensor);
    walker.number(kReadingSequenceField, aux.sequence);
    walker.number(kPeakSignalField, aux.signal.peak_signal);
    walker.number(kAmbientField, aux.signal.ambient);
    walker.zeros(1);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, RangeFd>& frame) {
    walker.selector(Field("count", 3).within(1, kReadingsPerFdFrame), frame.count);
    walker.zeros(2);
    const std::uint8_t present = walker.entries_present(frame.count);
    for (std::uint8_t i = 0; i < present; ++i) {
        auto& [reading, signal] = frame.entries[i];
        walker.number(kSensorField.at(i), reading.sensor);
        walker.number(kZoneField.at(i), reading.zone);
        walker.number(kDeviceStatusField.at(i), reading.device_status);
        walker.number(kReadingSequenceField.at(i), reading.sequence);
        walker.number(Field("range", 16, Unit::millimetre).at(i), reading.range_mm);
        walker.number(Field("sigma", 16, Unit::quarter_millimetre).at(i), reading.sigma_quarter_mm);
        walker.number(kPeakSignalField.at(i), signal.peak_signal);
        walker.number(kAmbientField.at(i), signal.ambient);
        walker.residue(Field("capture_time", 24, Unit::microsecond).at(i), reading.capture);
        walker.zeros(3);
    }
}

template <class Walker>
void walk(Walker& walker, Of<Walker, Heartbeat>& beat) {
    walker.choice(Field("state", 3), beat.state);
    walker.choice(Field("reset_cause", 3), beat.reset_cause);
    walker.flag(Field("is_rate_overridden", 1), beat.is_rate_overridden);
    walker.flag(Field("is_time_suspect", 1), beat.is_time_suspect);
    walker.saturated(Field("degraded_sensors", 5), beat.degraded_sensors);
    walker.number(Field("uid_crc", 16), beat.uid_crc);
    walker.number(Field("node_hash_low", 16), beat.node_hash_low);
}

/// The first field of every NODE_INFO page.
template <class Walker>
void walk_page(Walker& walker, InfoPage page) {
    walker.selector(Field("page", kInfoPageBits), static_cast<std::uint8_t>(page));
    walker.zeros(2);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, InfoUidLow>& info) {
    walk_page(walker, InfoPage::uid_low);
    walker.bytes(Field("uid_low", 48), info.uid);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoUidHigh>& info) {
    walk_page(walker, InfoPage::uid_high);
    walker.bytes(Field("uid_high", 48), info.uid);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoIdentity>& info) {
    walk_page(walker, InfoPage::identity);
    walker.number(Field("node_hash", 32), info.node_hash);
    walker.number(Field("sensor_count", 8), info.sensor_count);
    walker.number(Field("board_type", 8), info.board_type);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoBuild>& info) {
    walk_page(walker, InfoPage::build);
    walker.number(Field("build_id", 32), info.build_id);
    walker.number(Field("uptime", 16, Unit::second), info.uptime_s);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoCounters>& info) {
    walk_page(walker, InfoPage::counters);
    walker.number(Field("i2c_errors", 16), info.i2c_errors);
    walker.number(Field("reads_disagreed", 16), info.reads_disagreed);
    walker.number(Field("sensor_restarts", 16), info.sensor_restarts);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoTraffic>& info) {
    walk_page(walker, InfoPage::traffic);
    walker.number(Field("tx_dropped", 16), info.tx_dropped);
    walker.number(Field("late_dropped", 16), info.late_dropped);
    walker.number(Field("bus_off_count", 8), info.bus_off_count);
    walker.number(Field("rx_rejected", 8), info.rx_rejected);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, InfoFault>& info) {
    walk_page(walker, InfoPage::fault);
    walker.choice(Field("fault_kind", 4), info.kind);
    walker.saturated(Field("fault_count", 4), info.count);
    walker.number(Field("fault_where", 32), info.where);
    walker.number(Field("fault_uptime", 8, Unit::second), info.uptime_s);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, SensorHealth>& health) {
    walker.number(kSensorField, health.sensor);
    walker.choice(Field("state", 3), health.state);
    walker.choice(Field("fault", 4), health.fault);
    walker.number(Field("sent", 16), health.sent);
    walker.number(Field("capture_bound", 8, Unit::step_of_64_us), health.capture_bound_64us);
    walker.number(Field("rejected", 8), health.rejected);
    walker.number(Field("period_error", 8, Unit::permille), health.period_error_permille);
}

inline constexpr Field kSyncSequenceField = Field("sequence", 5);
inline constexpr Field kHostTimeField = Field("host_time", 48, Unit::microsecond);

template <class Walker>
void walk(Walker& walker, Of<Walker, Sync>& sync) {
    walker.number(kSyncSequenceField, sync.sequence);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, FollowUp>& follow_up) {
    walker.number(kSyncSequenceField, follow_up.sequence);
    walker.number(kHostTimeField, follow_up.host_time_us);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, SyncReport>& report) {
    walker.number(kSyncSequenceField, report.sequence);
    walker.number(Field("heard", 32, Unit::microsecond), report.heard.us);
}

inline constexpr Field kJointIndexField = Field("index", kJointIndexBits);
inline constexpr Field kJointSequenceField = Field("sequence", 3);
inline constexpr Field kPositionField = Field("position", 24, Unit::microradian);

template <class Walker>
void walk(Walker& walker, Of<Walker, JointPair>& joints) {
    walker.selector(kJointIndexField.within(0, kJointIndexLast - 1U), joints.index);
    walker.number(kJointSequenceField, joints.sequence);
    walker.number(kPositionField.at(2U * joints.index), joints.position_urad[0]);
    walker.number(kPositionField.at(2U * joints.index + 1U), joints.position_urad[1]);
}
template <class Walker>
void walk(Walker& walker, Of<Walker, JointLast>& joint) {
    walker.selector(kJointIndexField, kJointIndexLast);
    walker.number(kJointSequenceField, joint.sequence);
    walker.number(kPositionField.at(kJointsPerSample - 1U), joint.position_urad);
    walker.residue(Field("sample_time", 24, Unit::microsecond), joint.sampled);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, Mark>& mark) {
    walker.choice(Field("kind", 5), mark.kind);
    walker.number(kHostTimeField, mark.host_time_us);
}

inline constexpr Field kCommandSequenceField = Field("sequence", 8);

template <class Walker>
void walk(Walker& walker, Of<Walker, Command>& command) {
    walker.choice(Field("code", 5), command.code);
    walker.number(Field("sensor", 6), command.sensor);
    walker.zeros(2);
    walker.number(Field("argument", 16), command.argument);
    walker.number(kCommandSequenceField, command.sequence);
}

template <class Walker>
void walk(Walker& walker, Of<Walker, Calibration>& calibration) {
    walker.number(kSensorField, calibration.sensor);
    walker.choice(Field("quantity", 1), calibration.quantity);
    walker.choice(Field("outcome", 4), calibration.outcome);
    walker.zeros(2);
    walker.number(kCommandSequenceField, calibration.sequence);
    walker.number(Field("offset", 16, Unit::quarter_millimetre), calibration.offset_quarter_mm);
    walker.number(Field("crosstalk", 16, Unit::kcps_by_512), calibration.crosstalk_raw);
}

}  // namespace octoskin::wire
