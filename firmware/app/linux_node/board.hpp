// A Linux board and its node: opens the devices, wires them, turns the loop.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/result.hpp"
#include "firmware/app/linux_node/arguments.hpp"
#include "firmware/app/linux_node/journal.hpp"
#include "firmware/core/node.hpp"
#include "firmware/core/run_record.hpp"
#include "firmware/port/linux/can_interface.hpp"
#include "firmware/port/linux/gpio_lines.hpp"
#include "firmware/port/linux/i2c_adapter.hpp"
#include "firmware/port/linux/i2c_thread_bus.hpp"
#include "firmware/port/linux/service_manager.hpp"

namespace octoskin::linux_node {

class Board {
  public:
    enum class Ending : std::uint8_t {
        stopped,  ///< by a signal
        reset,    ///< the host has ordered it
    };

    /// All devices but the CAN interface must be there. `kept` outlives boards: what a microcontroller keeps
    /// over a reset.
    [[nodiscard]] static Result<std::unique_ptr<Board>, linux_port::StartFailure> open(
        const Arguments& arguments, const NodeConfig& config, const node::Identity& identity,
        node::KeptMemory& kept);
    ~Board();
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    /// Until `stop`, a descriptor, is readable. `manager` is told of each turn that has ended.
    [[nodiscard]] Ending run(int stop, Journal& journal, linux_port::ServiceManager& manager);

    struct Left {
        std::size_t xshut_refused = 0;   ///< lines that the kernel refused to set low
        std::vector<std::string> stuck;  ///< buses with a transfer that does not come back within a second
    };
    /// After `run`: all sensors go into reset, and transfers that are in the kernel come back. With a stuck
    /// bus the board cannot be destroyed: the destructor would wait for it.
    [[nodiscard]] Left end();

  private:
    struct Devices {
        std::vector<linux_port::I2cDevice> i2c;
        linux_port::XshutOutputs xshut;
        linux_port::DataReadyInputs data_ready;
    };
    Board(const Arguments& arguments, const NodeConfig& config, const node::Identity& identity,
          node::KeptMemory& kept, Devices devices);
    [[nodiscard]] node::Ports ports(node::KeptMemory& kept);
    /// False: stop.
    [[nodiscard]] bool wait(int stop, Microseconds sleep_max);
    void turn();
    [[nodiscard]] NodeTime wake_time(NodeTime now) const;

    const Arguments& arguments_;
    Devices devices_;
    int transfers_ended_;  ///< eventfd
    std::vector<std::unique_ptr<linux_port::I2cThreadBus>> threads_;
    std::vector<i2c::Bus*> buses_;
    linux_port::CanInterface can_;
    node::Policy policy_;
    node::Node node_;
};

}  // namespace octoskin::linux_node
