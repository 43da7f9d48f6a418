// Reports the board's state to a person: one line on the serial port per event, and the flashes of the light.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/node.hpp"
#include "firmware/core/pause.hpp"
#include "firmware/port/stm32g4/can_controller.hpp"
#include "firmware/port/stm32g4/clocks.hpp"
#include "firmware/port/stm32g4/fault_record.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"

namespace octoskin::stm32g4 {

class Report {
  public:
    constexpr Report(SerialPort& serial, StatusLight& light) : serial_(serial), light_(light) {}

    void started(std::uint32_t build_id, wire::ResetCause cause, const Clocks& clocks);
    void fault(const Fault& fault);
    /// Start-up failed too often: the board waits for `seconds`.
    void start_up_failing(std::uint32_t seconds);
    /// The missing crystal now runs: the chip is about to be reset.
    void crystal_runs();
    void config_accepted(const NodeConfig& config);
    void config_refused(NodeConfigError error);
    /// The block is complete, but for another board, or with rates that this board cannot generate.
    void config_unsuitable(const NodeConfig& config);
    /// The CAN controller does not respond: CAN is silent until it does.
    void can_dead();

    /// Reports each change since the last call.
    void update(const node::Node& node, const CanController& can, NodeTime now);

  private:
    void report_losses(const CanCounts& counts, NodeTime now);
    void report_sensors(const node::Node& node, NodeTime now);
    void report_common_differences(const node::Node& node);
    void show(wire::NodeState state, bool is_can_started);

    SerialPort& serial_;
    StatusLight& light_;
    bool has_crystal_ = false;
    std::optional<wire::NodeState> state_;
    std::uint32_t bus_off_count_ = 0;
    std::uint8_t ignored_data_ready_ = 0;
    std::uint32_t can_failed_ = 0;
    CanCounts reported_;
    node::Pause losses_pause_;
    std::array<std::optional<node::Sensor::Trouble>, kNodeSensorsMax>
        troubles_{};  ///< last reported, by sensor
    std::size_t common_reported_ = 0;
    bool has_trouble_ = false;  ///< any sensor, at the last check
    node::Pause sensors_pause_;
};

}  // namespace octoskin::stm32g4
