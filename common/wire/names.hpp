// The enumerations of the wire as tables: the values and their names. The decoder refuses values that are not
// in them; the DBC and the monitor print the names.
#pragma once

#include <array>
#include <span>

#include "common/wire/messages.hpp"

namespace octoskin::wire {

template <class E>
struct Named {
    E value;
    const char* name;
};

namespace tables {
inline constexpr auto kNodeState = std::to_array<Named<NodeState>>({
    {NodeState::starting, "starting"},
    {NodeState::ranging, "ranging"},
    {NodeState::stopped, "stopped"},
    {NodeState::safe, "safe"},
    {NodeState::bad_config, "bad_config"},
    {NodeState::id_conflict, "id_conflict"},
    {NodeState::bus_fault, "bus_fault"},
    {NodeState::can_fault, "can_fault"},
});
inline constexpr auto kResetCause = std::to_array<Named<ResetCause>>({
    {ResetCause::power_on, "power_on"},
    {ResetCause::brown_out, "brown_out"},
    {ResetCause::watchdog, "watchdog"},
    {ResetCause::software, "software"},
    {ResetCause::pin, "pin"},
    {ResetCause::fault, "fault"},
    {ResetCause::unknown, "unknown"},
});
inline constexpr auto kFaultKind = std::to_array<Named<FaultKind>>({
    {FaultKind::none, "none"},
    {FaultKind::assertion, "assertion"},
    {FaultKind::hard_fault, "hard_fault"},
    {FaultKind::stack_guard, "stack_guard"},
    {FaultKind::watchdog, "watchdog"},
    {FaultKind::brown_out, "brown_out"},
    {FaultKind::clock_fault, "clock_fault"},
    {FaultKind::xshut_stuck, "xshut_stuck"},
    {FaultKind::stray_sensor, "stray_sensor"},
    {FaultKind::register_fixed, "register_fixed"},
    {FaultKind::data_ready_ignored, "data_ready_ignored"},
    {FaultKind::register_alike, "register_alike"},
    {FaultKind::boot_late, "boot_late"},
    {FaultKind::commands_refused, "commands_refused"},
    {FaultKind::unknown, "unknown"},
});
inline constexpr auto kInfoPage = std::to_array<Named<InfoPage>>({
    {InfoPage::uid_low, "uid_low"},
    {InfoPage::uid_high, "uid_high"},
    {InfoPage::identity, "identity"},
    {InfoPage::build, "build"},
    {InfoPage::counters, "counters"},
    {InfoPage::traffic, "traffic"},
    {InfoPage::fault, "fault"},
});
inline constexpr auto kSensorState = std::to_array<Named<SensorState>>({
    {SensorState::absent, "absent"},
    {SensorState::starting, "starting"},
    {SensorState::ranging, "ranging"},
    {SensorState::stopped, "stopped"},
    {SensorState::degraded, "degraded"},
    {SensorState::lost, "lost"},
});
inline constexpr auto kSensorFault = std::to_array<Named<SensorFault>>({
    {SensorFault::none, "none"},
    {SensorFault::no_answer, "no_answer"},
    {SensorFault::wrong_id, "wrong_id"},
    {SensorFault::boot_timeout, "boot_timeout"},
    {SensorFault::config_mismatch, "config_mismatch"},
    {SensorFault::no_data_ready, "no_data_ready"},
    {SensorFault::stale_stream, "stale_stream"},
    {SensorFault::reads_disagree, "reads_disagree"},
    {SensorFault::implausible_block, "implausible_block"},
    {SensorFault::bus_error, "bus_error"},
    {SensorFault::address_conflict, "address_conflict"},
    {SensorFault::xshut_stuck, "xshut_stuck"},
    {SensorFault::hardware_fail, "hardware_fail"},
});
inline constexpr auto kMarkKind = std::to_array<Named<MarkKind>>({
    {MarkKind::stop, "stop"},
    {MarkKind::start, "start"},
});
inline constexpr auto kCommandCode = std::to_array<Named<CommandCode>>({
    {CommandCode::start, "start"},
    {CommandCode::stop, "stop"},
    {CommandCode::set_rate, "set_rate"},
    {CommandCode::reinitialise_sensor, "reinitialise_sensor"},
    {CommandCode::identify, "identify"},
    {CommandCode::reset, "reset"},
    {CommandCode::send_info, "send_info"},
    {CommandCode::send_black_box, "send_black_box"},
    {CommandCode::calibrate_offset, "calibrate_offset"},
    {CommandCode::calibrate_crosstalk, "calibrate_crosstalk"},
});
inline constexpr auto kCalibrationQuantity = std::to_array<Named<CalibrationQuantity>>({
    {CalibrationQuantity::offset, "offset"},
    {CalibrationQuantity::crosstalk, "crosstalk"},
});
inline constexpr auto kCalibrationOutcome = std::to_array<Named<CalibrationOutcome>>({
    {CalibrationOutcome::under_way, "under_way"},
    {CalibrationOutcome::done, "done"},
    {CalibrationOutcome::refused, "refused"},
    {CalibrationOutcome::not_brought_up, "not_brought_up"},
    {CalibrationOutcome::device_failed, "device_failed"},
    {CalibrationOutcome::no_result, "no_result"},
    {CalibrationOutcome::no_target, "no_target"},
    {CalibrationOutcome::out_of_range, "out_of_range"},
});
}  // namespace tables

/// All values of an enumeration, chosen by the argument's type.
[[nodiscard]] constexpr std::span<const Named<NodeState>> values_of(NodeState) {
    return tables::kNodeState;
}
[[nodiscard]] constexpr std::span<const Named<ResetCause>> values_of(ResetCause) {
    return tables::kResetCause;
}
[[nodiscard]] constexpr std::span<const Named<FaultKind>> values_of(FaultKind) {
    return tables::kFaultKind;
}
[[nodiscard]] constexpr std::span<const Named<InfoPage>> values_of(InfoPage) {
    return tables::kInfoPage;
}
[[nodiscard]] constexpr std::span<const Named<SensorState>> values_of(SensorState) {
    return tables::kSensorState;
}
[[nodiscard]] constexpr std::span<const Named<SensorFault>> values_of(SensorFault) {
    return tables::kSensorFault;
}
[[nodiscard]] constexpr std::span<const Named<MarkKind>> values_of(MarkKind) {
    return tables::kMarkKind;
}
[[nodiscard]] constexpr std::span<const Named<CommandCode>> values_of(CommandCode) {
    return tables::kCommandCode;
}
[[nodiscard]] constexpr std::span<const Named<CalibrationQuantity>> values_of(CalibrationQuantity) {
    return tables::kCalibrationQuantity;
}
[[nodiscard]] constexpr std::span<const Named<CalibrationOutcome>> values_of(CalibrationOutcome) {
    return tables::kCalibrationOutcome;
}

template <class E>
[[nodiscard]] constexpr bool is_known(E value) noexcept {
    for (const Named<E>& entry : values_of(E{})) {
        if (entry.value == value) {
            return true;
        }
    }
    return false;
}

/// The enumerator as written in the source; "?" for a value that does not exist.
template <class E>
requires requires {
    values_of(E{});
}
[[nodiscard]] constexpr const char* name(E value) noexcept {
    for (const Named<E>& entry : values_of(E{})) {
        if (entry.value == value) {
            return entry.name;
        }
    }
    return "?";
}

}  // namespace octoskin::wire
