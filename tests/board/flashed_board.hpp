// The flashed image on a board with a fleet of sensors and a CAN bus; everything said is kept.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "common/wire/codec.hpp"
#include "hw/sim/stm32g474/board_on_bus.hpp"
#include "hw/sim/stm32g474/sensor_carrier.hpp"

namespace octoskin::sim::stm32 {

/// `count` sensors on four buses in turn, all in one mode at one rate, taking turns within the period.
[[nodiscard]] NodeConfig fleet(std::uint8_t count, DistanceMode mode, std::uint16_t budget_ms,
                               std::uint16_t period_ms);

struct SaidReading {
    wire::RangeReading reading;
    SimTime end{};
};
struct SaidHeartbeat {
    wire::Heartbeat heartbeat;
    SimTime end{};
};

struct SaidReflex {
    wire::Reflex reflex;
    SimTime end{};
};

class FlashedBoard {
  public:
    explicit FlashedBoard(const NodeConfig& config, NucleoOptions options = {});

    void run_for(Microseconds duration);
    [[nodiscard]] SimTime now() const noexcept { return now_; }
    [[nodiscard]] NucleoBoard& board() { return *board_; }
    [[nodiscard]] SimulatedCanBus& bus() { return *bus_; }
    [[nodiscard]] SensorModel& sensor(std::size_t index) { return sensors_->sensor(index); }
    [[nodiscard]] const std::vector<SaidReading>& readings(std::uint8_t sensor) { return readings_[sensor]; }
    [[nodiscard]] const std::vector<SaidHeartbeat>& heartbeats() const noexcept { return heartbeats_; }
    [[nodiscard]] const std::vector<SaidReflex>& reflexes() const noexcept { return reflexes_; }
    /// Rangings that ended since power-up.
    [[nodiscard]] std::uint32_t rangings(std::size_t sensor) const { return rangings_.at(sensor); }
    /// The middles of their windows.
    [[nodiscard]] const std::vector<SimTime>& windows(std::size_t sensor) const {
        return windows_.at(sensor);
    }
    /// As last said.
    [[nodiscard]] const std::optional<wire::InfoTraffic>& traffic() const noexcept { return traffic_; }
    [[nodiscard]] SimTime first_range() const noexcept { return first_range_; }
    [[nodiscard]] std::string violations() const;

  private:
    void note(const wire::CanFrame& frame, SimTime end);
    void note(const wire::RangeReading& reading, SimTime end);

    NodeConfig config_;
    std::vector<std::uint32_t> rangings_;
    std::vector<std::vector<SimTime>> windows_;
    std::unique_ptr<NucleoBoard> board_;
    std::unique_ptr<SensorCarrier> sensors_;
    std::unique_ptr<SimulatedCanBus> bus_;
    std::unique_ptr<BoardOnBus> on_bus_;
    std::map<std::uint8_t, std::vector<SaidReading>> readings_;
    std::vector<SaidHeartbeat> heartbeats_;
    std::vector<SaidReflex> reflexes_;
    std::optional<wire::InfoTraffic> traffic_;
    SimTime first_range_{};
    SimTime now_{};
};

}  // namespace octoskin::sim::stm32
