// A network connection that takes long to close: what it still has to send nobody reads, and it is to wait
// for that.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <string>
#include <utility>

namespace octoskin::test {

class LingeringConnection {
  public:
    static constexpr std::chrono::seconds kLingers{20};

    LingeringConnection() {
        const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        auto* const generic = reinterpret_cast<sockaddr*>(&address);
        socklen_t size = sizeof(address);
        EXPECT_EQ(::bind(listener, generic, size), 0) << std::strerror(errno);
        EXPECT_EQ(::listen(listener, 1), 0);
        EXPECT_EQ(::getsockname(listener, generic, &size), 0);
        end_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        EXPECT_EQ(::connect(end_, generic, size), 0) << std::strerror(errno);
        other_end_ = ::accept(listener, nullptr, nullptr);
        ::close(listener);
        const linger wait{.l_onoff = 1, .l_linger = static_cast<int>(kLingers.count())};
        EXPECT_EQ(::setsockopt(end_, SOL_SOCKET, SO_LINGER, &wait, sizeof(wait)), 0);
        const std::string text(1 << 16, 'x');
        while (::send(end_, text.data(), text.size(), MSG_DONTWAIT) > 0) {
        }
    }
    ~LingeringConnection() {
        ::close(other_end_);  // before: now nothing waits for it any more
        if (end_ >= 0) ::close(end_);
    }
    LingeringConnection(const LingeringConnection&) = delete;
    LingeringConnection& operator=(const LingeringConnection&) = delete;

    /// Sends its end along with `text`, and keeps none: who gets it has the last one. No earlier does it
    /// wait.
    void send_along(int socket, std::string text) {
        iovec part{text.data(), text.size()};
        alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
        msghdr message{};
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = control.data();
        message.msg_controllen = control.size();
        cmsghdr* const beside = CMSG_FIRSTHDR(&message);
        beside->cmsg_level = SOL_SOCKET;
        beside->cmsg_type = SCM_RIGHTS;
        beside->cmsg_len = CMSG_LEN(sizeof(int));
        std::memcpy(CMSG_DATA(beside), &end_, sizeof(end_));
        ASSERT_EQ(::sendmsg(socket, &message, 0), static_cast<ssize_t>(text.size()));
        ::close(std::exchange(end_, -1));
    }

  private:
    int end_ = -1;
    int other_end_ = -1;
};

}  // namespace octoskin::test
