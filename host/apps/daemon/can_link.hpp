// A CAN interface that comes and goes: opened, kept open, opened again; and what the adapter says of the bus.
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

/// How the link stands; the worst that holds.
enum class LinkState : std::uint8_t {
    absent,         ///< no such interface: tried again and again
    down,           ///< there, and down
    bus_off,        ///< the adapter has left the bus
    error_passive,  ///< over 127 errors: nobody acknowledges, or the lines are disturbed
    up,
};
[[nodiscard]] constexpr std::array<const char*, 5> names_of(LinkState) {
    return {"absent", "down", "bus_off", "error_passive", "up"};
}

class CanLink {
  public:
    using Opener = std::function<Result<socketcan::CanSocket, socketcan::SocketFault>()>;
    /// How the interface stands; empty if nobody can say.
    using StateReader = std::function<std::optional<socketcan::InterfaceState>()>;
    /// How often a closed link is tried, and one that is down asked for.
    static constexpr Nanoseconds kRetry{200'000'000};
    /// How often the kernel is asked how an open one stands.
    static constexpr Nanoseconds kAsk{1'000'000'000};
    /// An error-passive transmitter has an error count of 128 to 255, and each frame that is acknowledged
    /// takes one off: after so many without an error it is active again (ISO 11898-1, fault confinement).
    static constexpr int kSentToRecover = 128;

    /// `on_close` before each close of a descriptor: whoever watches it must let go of it first.
    /// `state_reader`: asked once a second, for adapters whose controllers recover, or fail, without a word,
    /// and while the link is down, for nothing tells of its being up where nobody sends.
    explicit CanLink(Opener opener, std::function<void()> on_close = {}, StateReader state_reader = {})
        : opener_(std::move(opener)),
          on_close_(std::move(on_close)),
          state_reader_(std::move(state_reader)) {}

    /// Opens the interface if it is closed and a try is due. True if the descriptor changed.
    bool attend(HostTime now);
    /// Only frames that pass `filters` are wanted from now on: `opener` opens the interface for them. What is
    /// open stays open where it can, so that no frame is missed; else `attend` opens it again.
    void change_filters(Opener opener, std::span<const socketcan::IdFilter> filters);
    /// -1 while closed.
    [[nodiscard]] int descriptor() const noexcept { return socket_ ? socket_->descriptor() : -1; }

    /// The next frame of the bus or echo of ours; error frames are taken note of here. Takes at most so many
    /// datagrams for it, which it counts down, whatever they are. Empty if none is here, or the link is not
    /// up; with none left: there may be more.
    [[nodiscard]] std::optional<socketcan::Received> receive(int& datagrams_left);
    [[nodiscard]] std::optional<socketcan::Received> receive() {
        int datagrams_left = socketcan::CanSocket::kDatagramsMax;
        return receive(datagrams_left);
    }
    /// When the newest that was taken out of the socket had come, whatever it was; empty before the first.
    [[nodiscard]] std::optional<WallTime> newest() const noexcept {
        return socket_ ? socket_->newest() : std::nullopt;
    }
    /// False if it could not be sent now; it will not be sent later.
    bool send(const wire::CanFrame& frame);

    [[nodiscard]] LinkState state() const noexcept { return state_; }
    /// Why it is not up, for a person; empty if it is.
    [[nodiscard]] const std::string& why() const noexcept { return why_; }

    struct Counts {
        std::uint64_t received = 0;      ///< frames, echoes included
        std::uint64_t sent = 0;          ///< frames handed over
        std::uint64_t not_sent = 0;      ///< no room, or the link was not up
        std::uint64_t error_frames = 0;  ///< of the adapter
        std::uint64_t dropped = 0;       ///< by the kernel: nobody read them in time
        std::uint64_t malformed = 0;
        std::uint64_t bus_off = 0;    ///< times
        std::uint64_t reopened = 0;   ///< times the interface was opened, after the first
        std::uint64_t went_down = 0;  ///< times
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
    bool is_transmitter_passive_ = false;  ///< else the receiver alone, while error-passive
    int sent_since_error_ = 0;
    std::optional<socketcan::CanSocket> socket_;
    std::optional<HostTime> tried_;
    bool was_open_ = false;
    LinkState state_ = LinkState::absent;
    std::string why_ = "not opened yet";
    Counts counts_;  ///< of the sockets before this one, and what no socket counts
};

}  // namespace octoskin
