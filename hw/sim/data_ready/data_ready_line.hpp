// One bus's data-ready line: the open-drain GPIO1 outputs of its sensors on a wire with a pull-up.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hw/sim/vl53l1x/sensor_model.hpp"

namespace octoskin::sim {

/// Faults of the wire.
enum class LineFault : std::uint8_t {
    none,
    stuck_low,   ///< shorted to ground, or held low by a defective part
    stuck_high,  ///< not connected
    chatters,    ///< a new level every microsecond
};

class DataReadyLine {
  public:
    /// The sensor must outlive the line.
    void attach(SensorModel& sensor) { sensors_.push_back(&sensor); }
    void set_fault(LineFault fault) { fault_ = fault; }
    [[nodiscard]] LineFault fault() const noexcept { return fault_; }

    [[nodiscard]] bool is_high(SimTime time) const;
    /// The next time after `now` at which the level may change by itself; empty if never. The controller may
    /// change it at any time over I2C or by XSHUT.
    [[nodiscard]] std::optional<SimTime> next_change(SimTime now) const;

  private:
    std::vector<SensorModel*> sensors_;
    LineFault fault_ = LineFault::none;
};

}  // namespace octoskin::sim
