// One CAN interface of Linux as the node's controller: SocketCAN, classical and FD frames in one raw socket.
// An interface that is down, gone or unusable counts as a controller that has left the bus; it is looked
// after every 100 ms, and the node is back on the bus by itself.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/port/linux/frames_in_flight.hpp"

namespace octoskin::linux_port {

class CanInterface final : public node::CanTransmitter {
  public:
    struct Received {
        wire::CanFrame frame;
        NodeTime received;  ///< when the kernel had it
    };

    /// `uses_can_fd`: the interface must have FD. Opens it if it is there, else later.
    CanInterface(std::string name, wire::NodeId node_id, bool uses_can_fd, NodeTime now);
    ~CanInterface();
    CanInterface(const CanInterface&) = delete;
    CanInterface& operator=(const CanInterface&) = delete;

    // --- the node's side
    /// At most `FramesInFlight::kMax` frames are with the kernel and not on the bus yet.
    [[nodiscard]] bool send(const wire::CanFrame& frame) override;
    [[nodiscard]] node::CanState state() const override;
    /// The kernel itself throws its queue away when the controller goes bus-off or the link down.
    void discard() override { in_flight_.give_up_all(); }
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() override {
        return in_flight_.take_given_up();
    }
    /// Only the kernel restarts a controller (`restart-ms`), or somebody with the right to.
    void restart() override {}

    // --- the program's side
    /// To wait for; -1 while there is no socket.
    [[nodiscard]] int descriptor() const noexcept { return socket_; }
    /// The next frame of somebody else. Confirmations and error frames are taken in on the way; if many are
    /// there, it is empty, and the descriptor still readable.
    [[nodiscard]] std::optional<Received> receive();
    /// Looks after an interface that is not on the bus, and after frames that were never confirmed.
    void poll(NodeTime now);
    /// When `poll` next has something to do; empty: when something comes.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;
    /// Why there is no traffic, as a sentence; empty while the interface is up.
    [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
    /// Frames of which nobody knows whether they were sent.
    [[nodiscard]] std::uint64_t unconfirmed() const noexcept { return unconfirmed_; }

  private:
    void open();
    void close(int error_number, const char* doing);
    [[nodiscard]] int set_up(int index);
    void fail(int error_number, const char* doing);
    [[nodiscard]] bool is_up() const;
    [[nodiscard]] bool can_carry_frames() const;
    [[nodiscard]] bool has_carrier() const;

    std::string name_;
    wire::NodeId node_id_;
    bool uses_can_fd_;
    int socket_ = -1;
    std::string trouble_;
    node::CanState errors_ = node::CanState::active;  ///< as the adapter tells it
    FramesInFlight in_flight_;
    NodeTime now_;      ///< of the last `poll`
    NodeTime look_at_;  ///< while something is wrong
    std::uint64_t unconfirmed_ = 0;
};

}  // namespace octoskin::linux_port
