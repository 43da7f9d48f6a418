// A CAN interface that comes and goes: opened, kept open, opened again; and what the adapter says of the bus.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/io/socketcan/can_socket.hpp"

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
    /// How often a closed link is tried.
    static constexpr Nanoseconds kRetry{200'000'000};

    /// `on_close` before each close of a descriptor: whoever watches it must let go of it first.
    explicit CanLink(Opener opener, std::function<void()> on_close = {})
        : opener_(std::move(opener)), on_close_(std::move(on_close)) {}

    /// Opens the interface if it is closed and a try is due. True if the descriptor changed.
    bool attend(HostTime now);
    /// Closes what is open; `attend` opens it again, in this way.
    void reopen(Opener opener);
    /// -1 while closed.
    [[nodiscard]] int descriptor() const noexcept { return socket_ ? socket_->descriptor() : -1; }

    /// The next frame of the bus or echo of ours; error frames are taken note of here. Empty if none is
    /// here, or the link is not up.
    [[nodiscard]] std::optional<socketcan::Received> receive();
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
    void set(LinkState state, std::string why);

    Opener opener_;
    std::function<void()> on_close_;
    std::optional<socketcan::CanSocket> socket_;
    std::optional<HostTime> tried_;
    bool was_open_ = false;
    LinkState state_ = LinkState::absent;
    std::string why_ = "not opened yet";
    Counts counts_;  ///< of the sockets before this one, and what no socket counts
};

}  // namespace octoskin
