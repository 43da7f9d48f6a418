// One Linux CAN interface as the node's controller: SocketCAN, classical and FD frames through one raw
// socket. An interface that is down, gone or unusable counts as a controller in bus-off. It is checked every
// 100 ms, and the node resumes without further action.
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
        NodeTime received;  ///< time at which the kernel received it
    };

    /// `uses_can_fd`: the interface must support FD. Opens the interface now, or as soon as it exists.
    CanInterface(std::string name, wire::NodeId node_id, bool uses_can_fd, NodeTime now);
    ~CanInterface();
    CanInterface(const CanInterface&) = delete;
    CanInterface& operator=(const CanInterface&) = delete;

    // --- the node's side
    /// Takes the frame unless `FramesInFlight::kMax` frames are in the kernel and not confirmed.
    [[nodiscard]] bool send(const wire::CanFrame& frame) override;
    [[nodiscard]] node::CanState state() const override;
    /// The kernel drops its own queue when the controller goes bus-off or the link down.
    void discard() override { in_flight_.give_up_all(); }
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() override {
        return in_flight_.take_given_up();
    }
    /// Does nothing: only the kernel (`restart-ms`) or a privileged user can restart the controller.
    void restart() override {}

    // --- the program's side
    /// Descriptor to wait for; -1 while there is no socket.
    [[nodiscard]] int descriptor() const noexcept { return socket_; }
    /// The next frame of another sender. Also processes confirmations and error frames. If there are many of
    /// these, the result may be empty while the descriptor is still readable.
    [[nodiscard]] std::optional<Received> receive();
    /// Reopens an interface that is not on the bus, and counts frames that were never confirmed.
    void poll(NodeTime now);
    /// The next time at which `poll` has work to do; empty: only after an event.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;
    /// Why there is no traffic, as text for the log; empty while the interface is up.
    [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
    /// Number of frames for which the kernel gave no confirmation: they may or may not have been sent.
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
    node::CanState errors_ = node::CanState::active;  ///< as reported by the adapter
    FramesInFlight in_flight_;
    NodeTime now_;      ///< time of the last `poll`
    NodeTime look_at_;  ///< next check while the interface is unusable
    std::uint64_t unconfirmed_ = 0;
};

}  // namespace octoskin::linux_port
