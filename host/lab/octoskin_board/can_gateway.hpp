// Connects the simulated CAN bus to a CAN interface of this machine: forwards frames in both directions.
#pragma once

#include <cstdint>
#include <optional>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"

namespace octoskin::board {

struct GatewayCounts {
    std::uint64_t sent = 0;          ///< out of the interface
    std::uint64_t not_sent = 0;      ///< the interface had no room, or is down
    std::uint64_t received = 0;      ///< out of the interface, onto the simulated bus
    std::uint64_t not_received = 0;  ///< the simulated bus had no room
};

class CanGateway {
  public:
    /// Attaches its own seat to `bus`, which must outlive this.
    CanGateway(socketcan::CanSocket socket, sim::SimulatedCanBus& bus);
    CanGateway(const CanGateway&) = delete;
    CanGateway& operator=(const CanGateway&) = delete;

    /// Forwards received frames. Call in every turn. Waits for an interface that is down; any other fault is
    /// an error.
    [[nodiscard]] Status<AppError> poll();
    [[nodiscard]] const GatewayCounts& counts() const noexcept { return counts_; }

  private:
    void forward(const wire::CanFrame& frame);
    void note(const socketcan::SocketFault& fault);

    socketcan::CanSocket socket_;
    node::CanTransmitter* seat_ = nullptr;
    GatewayCounts counts_;
    std::optional<socketcan::SocketFault> fault_;  ///< that ends it
};

/// Opens the interface. `unavailable` if it is not there, `no_permission` if it may not be used.
[[nodiscard]] Result<socketcan::CanSocket, AppError> open_interface(const std::string& interface);

}  // namespace octoskin::board
