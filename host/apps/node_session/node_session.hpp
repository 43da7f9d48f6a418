// A node session over a CAN socket: the common part of all commands that talk to one node.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin {

/// Input: frames and times. Output: frames, until it is over. It must end by itself, whether or not frames
/// arrive.
class NodeDialogue {
  public:
    virtual ~NodeDialogue() = default;

    virtual void on_frame(const wire::CanFrame& frame, HostTime now) = 0;
    /// Called with the present time, after frames and after waits.
    virtual void on_time(HostTime now) = 0;
    /// The frame to send next; each is returned once.
    [[nodiscard]] virtual std::optional<wire::CanFrame> take_frame() = 0;
    /// The last frame from take_frame() was accepted by the interface. Until then no other frame is taken.
    virtual void on_sent(HostTime) {}
    /// The time at which `on_time` must be called next.
    [[nodiscard]] virtual HostTime deadline() const = 0;
    [[nodiscard]] virtual bool is_over() const = 0;
};

/// The outside world, which a test can replace.
struct Outside {
    std::function<HostTime()> now;
    /// Returns when the descriptor is readable, or at `until`; it may return earlier.
    std::function<void(int descriptor, HostTime until)> wait;
};
[[nodiscard]] Outside this_machine();

/// The first of 16 command sequences of this dialogue. They differ from those of a dialogue that began 100 ms
/// or more before; otherwise a node would treat the command as a repeated frame.
[[nodiscard]] std::uint8_t new_sequence();

/// Blocks until the dialogue is over. Frames that are in the socket at the start are discarded. Error: a CAN
/// interface that does not work (`unavailable`).
[[nodiscard]] Status<AppError> converse(NodeDialogue& dialogue, socketcan::CanSocket& socket,
                                        const Outside& outside);

}  // namespace octoskin
