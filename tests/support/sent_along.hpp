// Descriptors that a program sends along with a text, through a Unix socket.
#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/un.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

namespace octoskin::test {

/// 0, or the kernel's error number.
[[nodiscard]] inline int try_to_send_along(int socket, std::string text, std::span<const int> descriptors,
                                           int flags = 0) {
    constexpr std::size_t kMost = 253;  // SCM_MAX_FD
    iovec part{text.data(), text.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(kMost * sizeof(int))> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* const beside = CMSG_FIRSTHDR(&message);
    beside->cmsg_level = SOL_SOCKET;
    beside->cmsg_type = SCM_RIGHTS;
    beside->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(beside), descriptors.data(), descriptors.size_bytes());
    return ::sendmsg(socket, &message, flags) == static_cast<ssize_t>(text.size()) ? 0 : errno;
}

inline void send_along(int socket, std::string text, std::span<const int> descriptors, int flags = 0) {
    ASSERT_EQ(try_to_send_along(socket, std::move(text), descriptors, flags), 0);
}

inline constexpr int kPassRights = 83;  // SO_PASSRIGHTS, of Linux 6.16

/// Whether this kernel can refuse them to their sender.
inline bool can_refuse_descriptors(int socket) {
    int value = 0;
    socklen_t size = sizeof(value);
    return ::getsockopt(socket, SOL_SOCKET, kPassRights, &value, &size) == 0;
}

/// This process's socket that is bound to `file`, and the connections that are made to it from now on, let
/// descriptors through, as those of an older kernel do.
inline void let_descriptors_through(const std::filesystem::path& file) {
    constexpr int kDescriptors = 1024;
    for (int descriptor = 0; descriptor < kDescriptors; ++descriptor) {
        sockaddr_un address{};
        socklen_t size = sizeof(address);
        if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
        if (address.sun_family != AF_UNIX || address.sun_path != file.string()) continue;
        const int yes = 1;
        (void)::setsockopt(descriptor, SOL_SOCKET, kPassRights, &yes, sizeof(yes));
    }
}

}  // namespace octoskin::test
