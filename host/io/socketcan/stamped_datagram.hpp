// One datagram with what the kernel says beside it: when it came, and how many it had no room for.
#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <ctime>
#include <optional>
#include <span>
#include <string>

#include "common/time.hpp"

namespace octoskin::socketcan {

struct StampedDatagram {
    ssize_t count = 0;  ///< as of recvmsg(2); negative: errno says why
    int flags = 0;      ///< MSG_...
    std::optional<WallTime> stamp;
    std::optional<std::uint32_t> dropped;  ///< SO_RXQ_OVFL: since the socket was opened, modulo 2^32
    /// SCM_CREDENTIALS, if they are wanted: what the kernel vouches for. 0: a process that it cannot name
    /// here.
    struct Sender {
        pid_t pid = 0;
        uid_t uid = 0;
    };
    std::optional<Sender> sender;
};

/// What the kernel says beside a datagram of its own accord has just this room. What a sender puts beside it
/// finds none: descriptors are dropped, and MSG_CTRUNC says so.
inline constexpr std::size_t kRoomBeside = CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(ucred));

/// From now on datagrams are stamped, if the kernel does that for this kind of socket.
bool want_stamps(int descriptor);

/// From now on datagrams of a Unix socket tell the process that sent them.
bool want_senders(int descriptor);

/// Takes one datagram, if one is here, and no descriptor beside it: that is dropped, which can take as long
/// as passed_descriptors.hpp says. Else never waits. A Unix socket is to want stamps and senders. `address`:
/// of a Unix socket, what the sender's is bound to, its own characters where they are printable and '?'
/// elsewhere; empty: to nothing. May be null.
[[nodiscard]] StampedDatagram receive_stamped(int descriptor, std::span<std::byte> bytes,
                                              std::string* address = nullptr);

}  // namespace octoskin::socketcan
