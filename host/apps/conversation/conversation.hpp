// A dialogue with one node, held over a CAN socket: what the commands that ask a node have in common.
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

/// Frames and times in, frames out, until it is over. It must end by itself, whatever comes or does not.
class NodeDialogue {
  public:
    virtual ~NodeDialogue() = default;

    virtual void on_frame(const wire::CanFrame& frame, HostTime now) = 0;
    /// The time is now, whatever came.
    virtual void on_time(HostTime now) = 0;
    /// To be sent; told once.
    [[nodiscard]] virtual std::optional<wire::CanFrame> take_frame() = 0;
    /// The frame taken last is on its way to the bus. Until then no other is taken.
    virtual void on_sent(HostTime) {}
    /// When `on_time` has something to do.
    [[nodiscard]] virtual HostTime deadline() const = 0;
    [[nodiscard]] virtual bool is_over() const = 0;
};

/// The world outside, so that a test can be it.
struct Outside {
    std::function<HostTime()> now;
    /// Returns once the descriptor can be read, or at that time; spurious returns are harmless.
    std::function<void(int descriptor, HostTime until)> wait;
};
[[nodiscard]] Outside this_machine();

/// The first of 16 sequences of commands that are this dialogue's: others than those of a dialogue begun 100
/// ms or more before, or the node takes a command for a repeated frame.
[[nodiscard]] std::uint8_t new_sequence();

/// Blocks until the dialogue is over; what waits in the socket already is forgotten. Error: a CAN interface
/// that does not work (`unavailable`).
[[nodiscard]] Status<AppError> converse(NodeDialogue& dialogue, socketcan::CanSocket& socket,
                                        const Outside& outside);

}  // namespace octoskin
