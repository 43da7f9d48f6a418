#include "hw/sim/board_link/link_socket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace octoskin::sim {
namespace {

constexpr int kSilenceMs = 60'000;
// The longest message is a summary with a thousand violations.
constexpr std::size_t kMessageBytesMax = 160'000;

[[noreturn]] void fail(const char* what) {
    throw BoardLinkError(std::string("board link: ") + what + ": " + std::strerror(errno));
}

}  // namespace

LinkSocket::~LinkSocket() {
    if (descriptor_ >= 0) close(descriptor_);
}

LinkSocket::LinkSocket(LinkSocket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

void LinkSocket::send(const BoardMessage& message) {
    const std::vector<std::uint8_t> bytes = encode_message(message);
    ssize_t sent = 0;
    do {
        sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    } while (sent < 0 && errno == EINTR);
    if (sent != static_cast<ssize_t>(bytes.size())) fail("cannot send");
}

std::optional<BoardMessage> LinkSocket::receive() {
    pollfd waiting{descriptor_, POLLIN, 0};
    int ready = 0;
    do {
        ready = poll(&waiting, 1, kSilenceMs);
    } while (ready < 0 && errno == EINTR);
    if (ready < 0) fail("cannot wait");
    if (ready == 0) throw BoardLinkError("board link: no message for 60 s");
    static thread_local std::vector<std::uint8_t> buffer(kMessageBytesMax);
    ssize_t received = 0;
    do {
        received = recv(descriptor_, buffer.data(), buffer.size(), 0);
    } while (received < 0 && errno == EINTR);
    if (received < 0 && errno != ECONNRESET) fail("cannot receive");
    if (received <= 0) return std::nullopt;
    return decode_message({buffer.begin(), buffer.begin() + received});
}

}  // namespace octoskin::sim
