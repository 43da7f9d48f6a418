// A Linux board and its node: opens the devices, connects them to the node, and runs the loop.
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
        reset,    ///< ordered by the host
    };

    /// Every device except the CAN interface must exist. `kept` outlives boards: it corresponds to the memory
    /// that a microcontroller keeps over a reset.
    [[nodiscard]] static Result<std::unique_ptr<Board>, linux_port::StartFailure> open(
        const Arguments& arguments, const NodeConfig& config, const node::Identity& identity,
        node::KeptMemory& kept);
    ~Board();
    Board(const Board&) = delete;
    Board& operator=(const Board&) = delete;

    /// Runs the loop until the descriptor `stop` is readable or the host orders a reset. Reports each
    /// completed turn to `manager`.
    [[nodiscard]] Ending run(int stop, Journal& journal, linux_port::ServiceManager& manager);

    struct Left {
        std::size_t xshut_refused = 0;   ///< lines that the kernel refused to set low
        std::vector<std::string> stuck;  ///< buses with a transfer that stays in the kernel for over a second
    };
    /// Call after `run`. Puts all sensors into reset and waits, 1 s in all, for the transfers in the kernel.
    /// With a stuck bus, do not destroy the board: the destructor would block.
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
    /// False if the loop must stop.
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
