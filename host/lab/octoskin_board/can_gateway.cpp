#include "host/lab/octoskin_board/can_gateway.hpp"

#include <cerrno>
#include <utility>

namespace octoskin::board {
namespace {

constexpr std::size_t kMailboxes = 64;
constexpr int kFramesPerPoll = 64;  // a flood of frames must not stop simulated time

}  // namespace

CanGateway::CanGateway(socketcan::CanSocket socket, sim::SimulatedCanBus& bus) : socket_(std::move(socket)) {
    // A seat does not receive its own frames, so no frame is sent back to the side it came from.
    seat_ = &bus.attach([this](const wire::CanFrame& frame, sim::SimTime) { forward(frame); }, kMailboxes);
}

void CanGateway::forward(const wire::CanFrame& frame) {
    const auto sent = socket_.send(frame);
    ++(sent && *sent ? counts_.sent : counts_.not_sent);
    if (!sent) note(sent.error());
}

void CanGateway::note(const socketcan::SocketFault& fault) {
    if (!fault.is_down() && !fault_) fault_ = fault;
}

Status<AppError> CanGateway::poll() {
    for (int frames_left = kFramesPerPoll; frames_left > 0;) {
        const auto received = socket_.receive(frames_left);
        if (!received) {
            note(received.error());
            break;
        }
        if (!*received) break;
        const wire::CanFrame& frame = (*received)->entry.frame;
        if (frame.is_error) continue;
        ++(seat_->send(frame) ? counts_.received : counts_.not_received);
    }
    if (fault_)
        return fail(ExitCode::io_failed, in_file({ErrorCode::no_device, fault_->what}, fault_->interface));
    return Done{};
}

Result<socketcan::CanSocket, AppError> open_interface(const std::string& interface) {
    auto socket = socketcan::CanSocket::open(interface);
    if (socket) return std::move(*socket);
    const int error = socket.error().error_number;
    const bool is_forbidden = error == EPERM || error == EACCES;
    return fail(is_forbidden ? ExitCode::no_permission : ExitCode::unavailable,
                in_file({is_forbidden ? ErrorCode::no_permission : ErrorCode::no_device, socket.error().what},
                        interface));
}

}  // namespace octoskin::board
