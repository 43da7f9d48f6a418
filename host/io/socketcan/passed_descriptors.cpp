#include "host/io/socketcan/passed_descriptors.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>

#include "host/io/socketcan/descriptor_disposal.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin::socketcan {
namespace {

/// For what the kernel says beside a message of its own accord. With room for a descriptor one would be
/// received.
constexpr std::size_t kPeekedMax = CMSG_SPACE(sizeof(ucred)) + CMSG_SPACE(sizeof(timespec));

bool is_on(int descriptor, int option) {
    int value = 0;
    socklen_t size = sizeof(value);
    return ::getsockopt(descriptor, SOL_SOCKET, option, &value, &size) == 0 && value != 0;
}

/// That the kernel fills beside each message of this socket.
std::size_t bytes_beside(int descriptor) {
    return (is_on(descriptor, SO_PASSCRED) ? CMSG_SPACE(sizeof(ucred)) : 0) +
           (is_on(descriptor, SO_TIMESTAMPNS) ? CMSG_SPACE(sizeof(timespec)) : 0);
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
            close_beside(descriptor);
        }
    }
}

bool has_descriptors_beside(int descriptor) {
    alignas(cmsghdr) std::array<char, kPeekedMax> beside{};
    char byte = 0;
    iovec part{&byte, sizeof(byte)};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = beside.data();
    message.msg_controllen = std::min(bytes_beside(descriptor), beside.size());
    if (::recvmsg(descriptor, &message, MSG_DONTWAIT | MSG_PEEK | MSG_CMSG_CLOEXEC) < 0) return false;
    close_passed(message);  // copies, where the kernel says less than it was asked for
    return (message.msg_flags & MSG_CTRUNC) != 0;
}

ssize_t receive_text(int descriptor, std::span<char> bytes) {
    return receive_stamped(descriptor, std::as_writable_bytes(bytes)).count;
}

void close_connection(int descriptor) {
    constexpr int kReadsMax = 4096;  // each takes one message with descriptors, and a sender has room for few
    ::shutdown(descriptor, SHUT_RDWR);
    std::array<char, 4096> bytes{};
    ssize_t count = 1;
    for (int i = 0; i < kReadsMax && count > 0 && has_room_for_closing(); ++i)
        count = receive_text(descriptor, bytes);
    count > 0 ? close_beside(descriptor) : void(::close(descriptor));
}

}  // namespace octoskin::socketcan
