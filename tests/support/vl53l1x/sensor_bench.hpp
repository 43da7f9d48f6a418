// Simulated sensors on one simulated bus, with a clock that the test advances: directly, by playing a trace,
// or by running the driver.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"
#include "tests/support/i2c/i2c_trace.hpp"

namespace octoskin::test {

using Bytes = std::vector<std::uint8_t>;

/// A wall at `range_m` with a good signal: sigma 5 mm, 16 Mcps, ambient 0.125 Mcps.
[[nodiscard]] sim::RangingScene wall_at(double range_m);
/// Nothing in sight.
[[nodiscard]] sim::RangingScene empty_scene();

class SensorBench {
  public:
    /// No sensor yet; 400 kHz; the node's clock starts at `node_start`.
    explicit SensorBench(NodeTime node_start = {});

    /// Adds a part on the bus with XSHUT low.
    sim::SensorModel& add(const sim::RangingScene& scene, const sim::SensorPart& part = {});
    /// The same, out of reset and booted.
    sim::SensorModel& add_booted(const sim::RangingScene& scene, const sim::SensorPart& part = {});

    [[nodiscard]] sim::SimulatedI2cBus& bus() noexcept { return bus_; }
    [[nodiscard]] sim::SimTime time() const noexcept { return present_.time; }
    [[nodiscard]] NodeTime now() const { return clock_.to_node(present_.time); }
    void wait(Microseconds duration) { present_.time.us += duration.count(); }
    void set_xshut(sim::SensorModel& sensor, bool is_high) { sensor.set_xshut(is_high, present_.time); }

    /// One transfer; empty optional if it failed, then `bus().error()`.
    std::optional<Bytes> transfer(i2c::Address address, const Bytes& write, std::size_t read_bytes);
    /// Must succeed.
    Bytes read(std::uint16_t index, std::size_t count, i2c::Address address = 0x29);
    void write(std::uint16_t index, const Bytes& bytes, i2c::Address address = 0x29);
    /// Plays the transfers; every byte read must be that of the trace. `WAIT` advances the time.
    void play(std::string_view trace);
    /// Polls until data is ready by RESULT registers 0x30 and 0x31, every 100 us; false after `limit`.
    bool await_ready(Microseconds limit, i2c::Address address = 0x29);

    /// Runs the operation begun on `device` to its end, from event to event; busy if it has none within 10 s.
    [[nodiscard]] vl53l1x::Progress finish(vl53l1x::Device& device);
    /// From power-up to timed ranging at `settings.address`; fails the test if any operation does.
    void bring_up(vl53l1x::Device& device, sim::SensorModel& sensor, const vl53l1x::Settings& settings);
    /// Reads until there is a measurement; false after `limit` or if a read fails.
    [[nodiscard]] bool await_measurement(vl53l1x::Device& device,
                                         Microseconds limit = Microseconds{1'000'000});

  private:
    sim::Present present_;
    sim::NodeClock clock_;
    sim::SimulatedI2cBus bus_;
    std::vector<std::unique_ptr<sim::SensorModel>> sensors_;
};

}  // namespace octoskin::test
