// One CAN interface of Linux: classical and FD frames through one raw socket, with the kernel's time stamps,
// filters and drop counter and the adapter's error frames. No function waits: use `poll(2)` on `descriptor`.
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

/// Passes standard data frames whose identifier equals `can_id` in the bits of `mask`.
struct IdFilter {
    std::uint32_t can_id = 0;
    std::uint32_t mask = 0;
    [[nodiscard]] constexpr bool passes(std::uint32_t standard_id) const noexcept {
        return (standard_id & mask) == (can_id & mask);
    }
};

struct SocketOptions {
    std::span<const IdFilter> filters;  ///< empty: everything passes
    bool hears_itself = false;          ///< frames sent by this socket come back once they were on the bus
    bool wants_error_frames = true;
    int receive_buffer_bytes = 4 << 20;  ///< 2 s of a fully loaded bus; limited to what the system allows
};

/// Why a socket does not work (any longer), for the user: what, where, remedy.
struct SocketFault {
    std::string interface;
    int error_number = 0;
    std::string what;
    /// The interface is down. Once it is up again, frames arrive through this same socket.
    [[nodiscard]] bool is_down() const noexcept;
    [[nodiscard]] std::string message() const { return interface + ": " + what; }
};

struct Received {
    StampedFrame
        entry;  ///< `entry.frame.is_error`: a state of the bus, reported by the adapter (<linux/can/error.h>)
    bool is_own = false;  ///< sent by this socket, on the bus at `entry.stamp`
};

class CanSocket {
  public:
    [[nodiscard]] static Result<CanSocket, SocketFault> open(const std::string& interface,
                                                             const SocketOptions& options = {});
    /// Takes ownership of a descriptor that carries frames as a raw CAN socket does (one per datagram), such
    /// as one end of a socketpair. Time stamps are the kernel's if available, else the time of reading.
    /// `hears_itself`: sent frames come back, with the time at which they were handed over.
    CanSocket(std::string interface, int descriptor, bool hears_itself = false);
    ~CanSocket();
    CanSocket(CanSocket&& other) noexcept;
    CanSocket& operator=(CanSocket&& other) noexcept;

    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    [[nodiscard]] const std::string& interface() const noexcept { return interface_; }

    /// From now on only frames that pass one of `filters` arrive, or all if there is none. Frames that
    /// already wait stay, and none is lost during the change. False if the descriptor supports no filters.
    [[nodiscard]] bool set_filters(std::span<const IdFilter> filters);

    /// Default limit of datagrams for one `receive`.
    static constexpr int kDatagramsMax = 256;

    /// The next frame, if there is one. Takes at most `datagrams_left` datagrams for it and decreases that
    /// number. Datagrams without a frame count, too, so that a flood of them cannot delay the caller. If it
    /// is empty and none is left, more may be waiting.
    [[nodiscard]] Result<std::optional<Received>, SocketFault> receive(int& datagrams_left);
    [[nodiscard]] Result<std::optional<Received>, SocketFault> receive() {
        int datagrams_left = kDatagramsMax;
        return receive(datagrams_left);
    }
    /// False if there is no room now: the frame was not sent.
    [[nodiscard]] Result<bool, SocketFault> send(const wire::CanFrame& frame);

    /// Frames for which the kernel had no room since the socket was opened, as of the latest received frame.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
    /// Number of datagrams that were not frames.
    [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }
    /// Arrival time of the latest datagram, frame or not; empty before the first.
    [[nodiscard]] std::optional<WallTime> newest() const noexcept { return newest_; }

    /// The message, with the remedy, after `doing` failed with `error_number`.
    [[nodiscard]] SocketFault fault(int error_number, const std::string& doing) const;

  private:
    /// One datagram from the descriptor.
    struct Taken {
        std::optional<Received> received;  ///< empty: it was malformed, and is counted
    };
    /// Empty if there is none.
    [[nodiscard]] Result<std::optional<Taken>, SocketFault> take_one();

    std::string interface_;
    int descriptor_ = -1;
    std::optional<WallTime> newest_;
    std::uint64_t dropped_ = 0;
    std::uint32_t dropped_raw_ = 0;  ///< the kernel's counter, modulo 2^32
    std::uint64_t malformed_ = 0;
    static constexpr std::size_t kWaitingMax = 16'384;
    void take_what_came();
    bool has_echo_ =
        false;  ///< this class makes the echo itself, because the descriptor does not return sent frames
    std::deque<Received> waiting_;  ///< frames that arrived before a send, and its echo
};

}  // namespace octoskin::socketcan
