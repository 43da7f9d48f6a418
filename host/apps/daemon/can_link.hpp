// A CAN interface that may come and go: opened, kept open, reopened; and the adapter's reports about the bus.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/io/socketcan/can_socket.hpp"
#include "host/io/socketcan/interface_state.hpp"

namespace octoskin {

/// The state of the link, the worst that applies.
enum class LinkState : std::uint8_t {
    absent,         ///< no such interface: tried again and again
    down,           ///< it exists, and is down
    bus_off,        ///< the adapter has left the bus
    error_passive,  ///< over 127 errors: no node acknowledges, or the lines are disturbed
    up,
};
[[nodiscard]] constexpr std::array<const char*, 5> names_of(LinkState) {
    return {"absent", "down", "bus_off", "error_passive", "up"};
}

class CanLink {
  public:
    using Opener = std::function<Result<socketcan::CanSocket, socketcan::SocketFault>()>;
    /// The state of the interface; empty if it cannot be read.
    using StateReader = std::function<std::optional<socketcan::InterfaceState>()>;
    /// How often a closed link is opened, and the state of one that is down is read.
    static constexpr Nanoseconds kRetry{200'000'000};
    /// How often the state of an open link is read from the kernel.
    static constexpr Nanoseconds kAsk{1'000'000'000};
    /// An error-passive transmitter has an error count of 128 to 255, and each acknowledged frame lowers it
    /// by one: after this many frames without an error it is error-active again (ISO 11898-1, fault
    /// confinement).
    static constexpr int kSentToRecover = 128;

    /// `on_close` is called before each close of a descriptor, so that its watcher can release it.
    /// `state_reader` is called once a second, for adapters whose controllers recover or fail without a
    /// report, and while the link is down, because without traffic nothing reports that it is up again.
    explicit CanLink(Opener opener, std::function<void()> on_close = {}, StateReader state_reader = {})
        : opener_(std::move(opener)),
          on_close_(std::move(on_close)),
          state_reader_(std::move(state_reader)) {}

    /// Opens the interface if it is closed and a try is due. True if the descriptor changed.
    bool attend(HostTime now);
    /// From now on only frames that pass `filters` are wanted; `opener` opens the interface for them. An open
    /// socket stays open if possible, so that no frame is missed; else `attend` opens it again.
    void change_filters(Opener opener, std::span<const socketcan::IdFilter> filters);
    /// -1 while closed.
    [[nodiscard]] int descriptor() const noexcept { return socket_ ? socket_->descriptor() : -1; }

    /// The next frame of the bus or echo of our own; error frames are evaluated here. Takes at most
    /// `datagrams_left` datagrams of any kind, and counts them down. Empty if none has arrived, or the link
    /// is not up; if `datagrams_left` is 0, there may be more.
    [[nodiscard]] std::optional<socketcan::Received> receive(int& datagrams_left);
    [[nodiscard]] std::optional<socketcan::Received> receive() {
        int datagrams_left = socketcan::CanSocket::kDatagramsMax;
        return receive(datagrams_left);
    }
    /// Arrival of the newest datagram of any kind read from the socket; empty before the first.
    [[nodiscard]] std::optional<WallTime> newest() const noexcept {
        return socket_ ? socket_->newest() : std::nullopt;
    }
    /// False if the frame could not be sent now; it is not sent later.
    bool send(const wire::CanFrame& frame);

    [[nodiscard]] LinkState state() const noexcept { return state_; }
    /// Why it is not up, for a person; empty if it is up.
    [[nodiscard]] const std::string& why() const noexcept { return why_; }

    struct Counts {
        std::uint64_t received = 0;      ///< frames, echoes included
        std::uint64_t sent = 0;          ///< frames handed to the interface
        std::uint64_t not_sent = 0;      ///< no room, or the link was not up
        std::uint64_t error_frames = 0;  ///< reports of the adapter
        std::uint64_t dropped = 0;       ///< by the kernel: not read in time
        std::uint64_t malformed = 0;
        std::uint64_t bus_off = 0;    ///< number of times
        std::uint64_t reopened = 0;   ///< number of times after the first
        std::uint64_t went_down = 0;  ///< number of times
    };
    [[nodiscard]] Counts counts() const;

  private:
    void close();
    void on_fault(const socketcan::SocketFault& fault);
    void on_error_frame(const wire::CanFrame& frame);
    void on_traffic(bool is_own);
    void ask_kernel(HostTime now);
    void believe(socketcan::ControllerState state);
    void set_bus_off();
    void set_error_passive(bool is_transmitter);
    void set(LinkState state, std::string why);

    Opener opener_;
    std::function<void()> on_close_;
    StateReader state_reader_;
    std::optional<HostTime> asked_;
    bool is_transmitter_passive_ = false;  ///< while error-passive: false if only the receiver is
    int sent_since_error_ = 0;
    std::optional<socketcan::CanSocket> socket_;
    std::optional<HostTime> tried_;
    bool was_open_ = false;
    LinkState state_ = LinkState::absent;
    std::string why_ = "not opened yet";
    Counts counts_;  ///< of the sockets before this one, and counts that no socket has
};

}  // namespace octoskin
