// Commands to a served bus while it runs, as lines of text: `SENSOR FAULT` or `bus KIND COUNT POSITION`.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"

namespace octoskin::test {

struct SensorFaultCommand {
    std::string sensor;
    sim::SensorFaults faults{};  ///< these and no others from now on
    bool is_brown_out = false;   ///< the supply dips once; no other fault
};

/// `first` counts from the next transfer on.
struct BusFaultCommand {
    sim::I2cFault fault{};
};

using FaultCommand = std::variant<SensorFaultCommand, BusFaultCommand>;

/// A line as one of
/// - `SENSOR FAULT`: none, absent, never_boots, wrong_id, ignores_xshut, freezes_stream, never_ready or
///   always_ready;
/// - `SENSOR brown_out`;
/// - `SENSOR status BYTE`: RESULT__RANGE_STATUS of every result;
/// - `bus KIND COUNT POSITION [ADDRESS]`: KIND as in sim::I2cFaultKind, for the next COUNT transfers, to
///   ADDRESS if given;
///
/// with numbers in decimal or, after 0x, in hexadecimal. Empty: not a valid line.
[[nodiscard]] std::optional<FaultCommand> parse_fault_command(const std::string& line);

}  // namespace octoskin::test
