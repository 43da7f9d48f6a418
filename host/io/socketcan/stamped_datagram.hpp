// One datagram with what the kernel says beside it: when it came, and how many it had no room for.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"

namespace octoskin::socketcan {

struct StampedDatagram {
    ssize_t count = 0;  ///< as of recvmsg(2); negative: errno says why
    int flags = 0;      ///< MSG_...
    std::optional<WallTime> stamp;
    std::optional<std::uint32_t> dropped;  ///< SO_RXQ_OVFL: since the socket was opened, modulo 2^32
};

/// From now on datagrams are stamped, if the kernel does that for this kind of socket.
bool want_stamps(int descriptor);

/// Takes one datagram, if one is here; never waits.
[[nodiscard]] StampedDatagram receive_stamped(int descriptor, std::span<std::byte> bytes);

}  // namespace octoskin::socketcan
