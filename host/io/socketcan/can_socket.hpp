// One CAN interface of Linux: classical and FD frames through one raw socket, with the kernel's stamps, its
// filters, its drop counter and the adapter's error frames. Nothing here waits: `poll(2)` on `descriptor`.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/pipeline/can_source.hpp"

namespace octoskin::socketcan {

/// Standard data frames whose identifier agrees with `can_id` in the bits of `mask` pass.
struct IdFilter {
    std::uint32_t can_id = 0;
    std::uint32_t mask = 0;
    [[nodiscard]] constexpr bool passes(std::uint32_t standard_id) const noexcept {
        return (standard_id & mask) == (can_id & mask);
    }
};

struct SocketOptions {
    std::span<const IdFilter> filters;  ///< none: everything passes
    bool hears_itself = false;          ///< what this socket sent comes back once it was on the bus
    bool wants_error_frames = true;
    int receive_buffer_bytes = 4 << 20;  ///< 2 s of the fullest bus; cut to what the system allows
};

/// Why a socket does not work (any longer), for a person: what, where, what to do.
struct SocketFault {
    std::string interface;
    int error_number = 0;
    std::string what;
    /// The interface is down: frames come again once it is up, through this same socket.
    [[nodiscard]] bool is_down() const noexcept;
    [[nodiscard]] std::string message() const { return interface + ": " + what; }
};

struct Received {
    StampedFrame entry;   ///< `entry.frame.is_error`: what the adapter says of the bus (<linux/can/error.h>)
    bool is_own = false;  ///< sent by this socket, on the bus at `entry.stamp`
};

class CanSocket {
  public:
    [[nodiscard]] static Result<CanSocket, SocketFault> open(const std::string& interface,
                                                             const SocketOptions& options = {});
    /// A descriptor that carries frames as a raw CAN socket does (one each datagram), such as one end of a
    /// socketpair; becomes the socket's. Stamps are the kernel's where it gives one, else the time of
    /// reading. `hears_itself`: what was sent comes back, stamped when it was handed over.
    CanSocket(std::string interface, int descriptor, bool hears_itself = false);
    ~CanSocket();
    CanSocket(CanSocket&& other) noexcept;
    CanSocket& operator=(CanSocket&& other) noexcept;

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    [[nodiscard]] const std::string& interface() const noexcept { return interface_; }

    /// From now on only frames that pass one of `filters` arrive, or all if there is none; what waits already
    /// stays, and no frame is missed in between. False if the descriptor takes no filters.
    [[nodiscard]] bool set_filters(std::span<const IdFilter> filters);

    /// So many datagrams `receive` takes at most if it is not told otherwise.
    static constexpr int kDatagramsMax = 256;

    /// The next frame, if one is here; takes at most so many datagrams for it, which it counts down: what is
    /// no frame counts too, so that a flood of that holds nobody up. Empty with none left: there may be more.
    [[nodiscard]] Result<std::optional<Received>, SocketFault> receive(int& datagrams_left);
    [[nodiscard]] Result<std::optional<Received>, SocketFault> receive() {
        int datagrams_left = kDatagramsMax;
        return receive(datagrams_left);
    }
    /// False if there is no room now: the frame was not sent.
    [[nodiscard]] Result<bool, SocketFault> send(const wire::CanFrame& frame);

    /// Frames that the kernel had no room for, since the socket was opened, as of the newest frame received.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
    /// What was read and was no frame.
    [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }
    /// When the newest datagram that was taken had come, frame or not; empty before the first.
    [[nodiscard]] std::optional<WallTime> newest() const noexcept { return newest_; }

    /// In words, with what to do: `doing` failed with `error_number`.
    [[nodiscard]] SocketFault fault(int error_number, const std::string& doing) const;

  private:
    /// One datagram out of the descriptor.
    struct Taken {
        std::optional<Received> received;  ///< empty: it is malformed, and counted
    };
    /// Empty if none is there.
    [[nodiscard]] Result<std::optional<Taken>, SocketFault> take_one();

    std::string interface_;
    int descriptor_ = -1;
    std::optional<WallTime> newest_;
    std::uint64_t dropped_ = 0;
    std::uint32_t dropped_raw_ = 0;  ///< as the kernel counts, modulo 2^32
    std::uint64_t malformed_ = 0;
    static constexpr std::size_t kWaitingMax = 16'384;
    void take_what_came();
    bool has_echo_ = false;         ///< nobody else gives back what was sent
    std::deque<Received> waiting_;  ///< what came before something was sent, and its echo
};

}  // namespace octoskin::socketcan
