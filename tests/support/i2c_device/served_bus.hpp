// Simulated sensors on a simulated bus, run on the machine's clock: their XSHUT follows a GPIO line and their
// GPIO1 drives one. Simulated time is CLOCK_MONOTONIC.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"
#include "tests/support/i2c_device/fault_command.hpp"
#include "tests/support/i2c_device/line_pipe.hpp"

namespace octoskin::test {

/// With the 200 us that a served part takes to boot, XSHUT takes effect within the 1.2 ms of the datasheet
/// (2.6.1).
inline constexpr Microseconds kLinePeriod{1'000};

/// One sensor and the kernel's files its pins are wired to.
struct ServedSensor {
    std::string name;
    std::string xshut_path;  ///< reads `0` or `1`: gpio-sim's `value`; `-`: pulled up
    std::string gpio1_path;  ///< takes `pull-up` or `pull-down`: gpio-sim's `pull`; `-`: not wired.
                             ///< Of several with the same path any pulls the line low: wired together
    std::string range;       ///< see `true_range_mm`
};

struct ServedBusOptions {
    std::vector<ServedSensor> sensors;
    std::uint32_t hz = 400'000;
    /// If not empty: a named pipe that takes `parse_fault_command`'s lines, each in force from the next
    /// transfer on.
    std::string faults_path{};
};

class ServedBus {
  public:
    /// Throws std::runtime_error, saying which, if a file cannot be opened.
    explicit ServedBus(const ServedBusOptions& options);
    ~ServedBus();
    ServedBus(const ServedBus&) = delete;
    ServedBus& operator=(const ServedBus&) = delete;

    /// One transfer; waits as long as it takes on the wire. 0, or the error number that the kernel's document
    /// on I2C fault codes gives for it. One at a time.
    [[nodiscard]] int transfer(i2c::Address address, std::span<const std::uint8_t> write,
                               std::span<std::uint8_t> read);

    /// Updates the pins: reads every XSHUT, drives every GPIO1 that changed. Any thread; never waits for a
    /// transfer. Call every `kLinePeriod`: pulses in between are missed.
    void follow_lines();

    /// The true data of the rangings since the last call, one per line: `NAME INDEX MIDDLE_US READY_US STATUS
    /// STREAM RANGE_MM`, times of CLOCK_MONOTONIC, STATUS the device's own code. Kept until the next call.
    /// Any thread.
    [[nodiscard]] std::string take_record();

  private:
    struct Wired;
    struct Gpio1Line;
    void take_faults(sim::SimTime now);
    bool apply(const SensorFaultCommand& command, sim::SimTime now);
    void follow_lines_at(sim::SimTime now);
    void wire_gpio1(const std::string& path, sim::SensorModel& sensor);
    void drive_gpio1(sim::SimTime time);
    void record(Wired& wired);

    std::mutex mutex_;
    sim::Present present_;
    sim::SimulatedI2cBus bus_;
    std::vector<std::unique_ptr<Wired>> sensors_;
    std::vector<std::unique_ptr<Gpio1Line>> gpio1_lines_;
    std::string record_;
    std::optional<LinePipe> faults_;
};

}  // namespace octoskin::test
