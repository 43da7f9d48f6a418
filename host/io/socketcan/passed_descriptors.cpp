#include "host/io/socketcan/passed_descriptors.hpp"

#include <unistd.h>

#include <array>
#include <cstring>

#include "host/io/socketcan/stamped_datagram.hpp"

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
    return receive_stamped(descriptor, std::as_writable_bytes(bytes)).count;
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
