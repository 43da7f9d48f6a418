// Log of a Linux node, one line per event on standard error: its identity at the start, then each change.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "firmware/core/node.hpp"
#include "firmware/port/linux/can_interface.hpp"
#include "firmware/port/linux/gpio_lines.hpp"

namespace octoskin::linux_node {

/// Writes one line, prefixed with the program's name. Never waits for the reader; the end of the program
/// waits up to 1 s.
void say(const std::string& what);

class Journal {
  public:
    void started(const NodeConfig& config, const std::string& can, std::uint32_t build_id);
    /// Call once per turn of the loop. Writes a line for each change since the last call.
    void update(const node::Node& node, const linux_port::CanInterface& can,
                const linux_port::XshutOutputs& xshut, const linux_port::DataReadyInputs& data_ready);

  private:
    void say_troubles(const node::Node& node);

    std::optional<wire::NodeState> state_;
    std::size_t common_reported_ = 0;
    std::array<std::optional<node::Sensor::Trouble>, kNodeSensorsMax>
        troubles_{};  ///< last reported, by sensor
    std::string trouble_;
    node::CanState can_state_ = node::CanState::active;
    std::uint8_t ignored_data_ready_ = 0;
    std::uint64_t unconfirmed_ = 0;
    std::uint64_t xshut_failures_ = 0;
    std::size_t data_ready_gone_ = 0;  ///< number already reported
};

}  // namespace octoskin::linux_node
