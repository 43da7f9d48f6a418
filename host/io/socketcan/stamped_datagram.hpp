// One datagram with the kernel's additional data: its arrival time, and the number of dropped ones.
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
    ssize_t count = 0;  ///< result of recvmsg(2); negative: see errno
    int flags = 0;      ///< MSG_...
    std::optional<WallTime> stamp;
    std::optional<std::uint32_t> dropped;  ///< SO_RXQ_OVFL: since the socket was opened, modulo 2^32
    /// SCM_CREDENTIALS, if requested; verified by the kernel. 0: a process that has no number here.
    struct Sender {
        pid_t pid = 0;
        uid_t uid = 0;
    };
    std::optional<Sender> sender;
};

/// Exactly the room for the kernel's own data of a datagram. There is none for what a sender adds:
/// descriptors are dropped, which MSG_CTRUNC shows.
inline constexpr std::size_t kRoomBeside = CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(ucred));

/// From now on datagrams have time stamps, if the kernel supports that for this kind of socket.
bool want_stamps(int descriptor);

/// From now on datagrams of a Unix socket contain the process that sent them.
bool want_senders(int descriptor);

/// Takes one datagram, if there is one. Descriptors in it are dropped, which can take as long as
/// passed_descriptors.hpp states; otherwise it never waits. A Unix socket must be set up for time stamps and
/// senders. `address`: for a Unix socket, the address of the sender's socket, with '?' for unprintable
/// characters; empty if it has none. May be null.
[[nodiscard]] StampedDatagram receive_stamped(int descriptor, std::span<std::byte> bytes,
                                              std::string* address = nullptr);

}  // namespace octoskin::socketcan
