#include "host/io/socketcan/stamped_datagram.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "common/wall_time.hpp"

namespace octoskin::socketcan {
namespace {

using ControlRoom = std::array<char, kRoomBeside>;
static_assert(CMSG_SPACE(sizeof(std::uint32_t)) <= CMSG_SPACE(sizeof(ucred)), "of CAN sockets: SO_RXQ_OVFL");

template <class Value>
Value value_of(const cmsghdr* part) {
    Value value{};
    std::memcpy(&value, CMSG_DATA(part), sizeof(value));
    return value;
}

StampedDatagram::Sender sender_of(const cmsghdr* part) {
    const auto credentials = value_of<ucred>(part);
    return {credentials.pid, credentials.uid};
}

/// `length`: from recvmsg(2). An abstract address begins with a zero byte and has no terminator.
std::string name_of(const sockaddr_un& address, socklen_t length) {
    if (length <= offsetof(sockaddr_un, sun_path)) return {};
    std::string name(address.sun_path, length - offsetof(sockaddr_un, sun_path));
    const bool is_abstract = name.front() == '\0';
    if (is_abstract) name.front() = '@';
    if (!is_abstract) name.resize(std::min(name.find('\0'), name.size()));
    std::ranges::replace_if(
        name, [](char c) { return c < ' ' || c > '~'; }, '?');
    return name;
}

WallTime stamp_of(const cmsghdr* part) {
    const auto time = value_of<timespec>(part);
    return wall_time(time.tv_sec, time.tv_nsec);
}

}  // namespace

bool want_stamps(int descriptor) {
    const int yes = 1;
    return ::setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof(yes)) == 0;
}

bool want_senders(int descriptor) {
    const int yes = 1;
    return ::setsockopt(descriptor, SOL_SOCKET, SO_PASSCRED, &yes, sizeof(yes)) == 0;
}

StampedDatagram receive_stamped(int descriptor, std::span<std::byte> bytes, std::string* address) {
    alignas(cmsghdr) ControlRoom control{};
    iovec part{bytes.data(), bytes.size()};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    sockaddr_un from{};
    if (address != nullptr) {
        message.msg_name = &from;
        message.msg_namelen = sizeof(from);
    }
    StampedDatagram datagram;
    datagram.count = ::recvmsg(descriptor, &message, MSG_DONTWAIT);
    if (datagram.count < 0) return datagram;
    datagram.flags = message.msg_flags;
    if (address != nullptr) *address = name_of(from, message.msg_namelen);
    for (cmsghdr* beside = CMSG_FIRSTHDR(&message); beside != nullptr;
         beside = CMSG_NXTHDR(&message, beside)) {
        if (beside->cmsg_level != SOL_SOCKET) continue;
        if (beside->cmsg_type == SO_TIMESTAMPNS) datagram.stamp = stamp_of(beside);
        if (beside->cmsg_type == SCM_CREDENTIALS) datagram.sender = sender_of(beside);
        if (beside->cmsg_type == SO_RXQ_OVFL) datagram.dropped = value_of<std::uint32_t>(beside);
    }
    return datagram;
}

}  // namespace octoskin::socketcan
