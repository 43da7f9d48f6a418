#include "host/apps/node_session/node_session.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>

namespace octoskin {
namespace {

/// The wait before another attempt to send a frame for which the socket had no room.
constexpr Nanoseconds kRetry{10'000'000};

AppError app_error(const socketcan::SocketFault& fault) {
    return {ExitCode::unavailable, in_file({ErrorCode::no_device, fault.what}, fault.interface)};
}

/// Discards frames that arrived before the dialogue began. An error of the socket appears again at the next
/// call.
void forget_what_waits(socketcan::CanSocket& socket) {
    constexpr int kFramesMax = 100'000;
    for (int frames_left = kFramesMax; frames_left > 0;) {
        const auto received = socket.receive(frames_left);
        if (!received || !*received) return;
    }
}

}  // namespace

std::uint8_t new_sequence() {
    constexpr std::int64_t kSequencesEach = 16;
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
    return static_cast<std::uint8_t>(ms / 100 * kSequencesEach);
}

Outside this_machine() {
    const auto now = [] {
        const auto since_boot = std::chrono::steady_clock::now().time_since_epoch();
        return HostTime{std::chrono::duration_cast<Nanoseconds>(since_boot).count()};
    };
    const auto wait = [now](int descriptor, HostTime until) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now()).count();
        pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
        (void)::poll(&entry, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000)));
    };
    return {now, wait};
}

Status<AppError> converse(NodeDialogue& dialogue, socketcan::CanSocket& socket, const Outside& outside) {
    forget_what_waits(socket);
    std::optional<wire::CanFrame> unsent;
    while (!dialogue.is_over()) {
        auto received = socket.receive();
        if (!received) return unexpected(app_error(received.error()));
        if (*received) {
            dialogue.on_frame((*received)->entry.frame, outside.now());
        } else {
            const HostTime soon = outside.now() + kRetry;
            outside.wait(socket.descriptor(),
                         unsent ? std::min(soon, dialogue.deadline()) : dialogue.deadline());
        }
        dialogue.on_time(outside.now());
        if (!unsent) unsent = dialogue.take_frame();
        if (!unsent) continue;
        const auto sent = socket.send(*unsent);
        if (!sent) return unexpected(app_error(sent.error()));
        if (!*sent) continue;
        unsent.reset();
        dialogue.on_sent(outside.now());
    }
    return Done{};
}

}  // namespace octoskin
