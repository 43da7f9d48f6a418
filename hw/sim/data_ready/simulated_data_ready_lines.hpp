// The data-ready lines of a simulated board for the node core. The board's loop samples them whenever one may
// have changed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "firmware/core/ports.hpp"
#include "hw/sim/data_ready/data_ready_line.hpp"

namespace octoskin::sim {

class SimulatedDataReadyLines final : public node::DataReadyLines {
  public:
    [[nodiscard]] DataReadyLine& line(std::size_t bus) { return lines_.at(bus); }
    /// Samples the lines and records falling edges. Call at each `next_change` and after each transfer.
    void look(SimTime now);
    [[nodiscard]] std::optional<SimTime> next_change(SimTime now) const;
    /// Number of the node's queries.
    [[nodiscard]] std::uint64_t asked_count(std::size_t bus) const { return asked_.at(bus); }

    [[nodiscard]] bool take_fall(std::uint8_t bus) override;

  private:
    std::array<DataReadyLine, kNodeBusesMax> lines_{};
    std::array<bool, kNodeBusesMax> was_high_{};
    std::array<bool, kNodeBusesMax> has_fallen_{};
    std::array<std::uint64_t, kNodeBusesMax> asked_{};
    SimTime looked_{};
};

}  // namespace octoskin::sim
