#include "host/io/socketcan/passed_descriptors.hpp"

#include <unistd.h>

#include <cstring>

namespace octoskin::socketcan {
namespace {

void close_at_once(int descriptor) {
    const linger none{.l_onoff = 0, .l_linger = 0};
    (void)::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &none, sizeof(none));  // no socket: nothing to do
    ::close(descriptor);
}

}  // namespace

void close_passed(const msghdr& message) {
    auto* const given = const_cast<msghdr*>(&message);  // NOLINT(*-const-cast): the macros want it
    for (cmsghdr* part = CMSG_FIRSTHDR(given); part != nullptr; part = CMSG_NXTHDR(given, part)) {
        if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
        const std::size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
        for (std::size_t i = 0; i < count; ++i) {
            int descriptor = -1;
            std::memcpy(&descriptor, CMSG_DATA(part) + i * sizeof(int), sizeof(descriptor));
            close_at_once(descriptor);
        }
    }
}

ssize_t receive_text(int descriptor, std::span<char> bytes) {
    alignas(cmsghdr) ControlRoom control{};
    iovec part{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = ::recvmsg(descriptor, &message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
    if (count >= 0) close_passed(message);
    return count;
}

void close_connection(int descriptor) {
    constexpr int kReadsMax = 4096;  // each takes one message with descriptors, and a sender has room for few
    ::shutdown(descriptor, SHUT_RDWR);
    std::array<char, 4096> bytes{};
    ssize_t count = 1;
    for (int i = 0; i < kReadsMax && count > 0; ++i) count = receive_text(descriptor, bytes);
    ::close(descriptor);
}

}  // namespace octoskin::socketcan
