#include "host/io/socketcan/passed_descriptors.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "host/io/socketcan/short_waits.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"

namespace octoskin::socketcan {
namespace {

/// Since Linux 6.16; older headers do not define it.
constexpr int kPassRights = 83;
#ifdef SO_PASSRIGHTS
static_assert(kPassRights == SO_PASSRIGHTS);
#endif

}  // namespace

void refuse_descriptors(int socket) {
    const int no = 0;
    (void)::setsockopt(socket, SOL_SOCKET, kPassRights, &no, sizeof(no));
}

bool has_descriptors_beside(int socket) {
    alignas(cmsghdr) std::array<char, kRoomBeside> beside{};
    msghdr message{};
    message.msg_control = beside.data();
    message.msg_controllen = beside.size();
    const ssize_t count = ::recvmsg(socket, &message, MSG_DONTWAIT | MSG_PEEK);
    return count >= 0 && (message.msg_flags & MSG_CTRUNC) != 0;
}

ssize_t receive_text(int connection, std::span<char> bytes) {
    // Does not look for descriptors first: for an out-of-band byte that is impossible.
    const ShortWaits none_long;
    return ::recv(connection, bytes.data(), bytes.size(), MSG_DONTWAIT);
}

void read_the_rest(int connection) {
    constexpr int kReadsMax = 16;
    std::array<char, 4096> bytes{};
    const ShortWaits none_long;
    for (int i = 0; i<kReadsMax&& ::recv(connection, bytes.data(), bytes.size(), MSG_DONTWAIT)> 0; ++i) {
    }
}

void close_socket(int socket) {
    const ShortWaits none_long;
    ::close(socket);
}

}  // namespace octoskin::socketcan
