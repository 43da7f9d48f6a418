// A network connection that takes long to close: its unsent data is never read, and SO_LINGER makes close
// wait for it. Also such a connection that is itself unread data in another one: closing the other one waits,
// too, and its SO_LINGER cannot be changed.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <string>
#include <utility>

#include "tests/support/sent_along.hpp"

namespace octoskin::test {

class LingeringConnection {
  public:
    static constexpr std::chrono::seconds kLingers{20};

    LingeringConnection() {
        const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const int room = 1;  // raised by the kernel to its minimum
        EXPECT_EQ(::setsockopt(listener, SOL_SOCKET, SO_RCVBUF, &room, sizeof(room)), 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        auto* const generic = reinterpret_cast<sockaddr*>(&address);
        socklen_t size = sizeof(address);
        EXPECT_EQ(::bind(listener, generic, size), 0) << std::strerror(errno);
        EXPECT_EQ(::listen(listener, 1), 0);
        EXPECT_EQ(::getsockname(listener, generic, &size), 0);
        end_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        EXPECT_EQ(::setsockopt(end_, SOL_SOCKET, SO_SNDBUF, &room, sizeof(room)), 0);
        EXPECT_EQ(::connect(end_, generic, size), 0) << std::strerror(errno);
        other_end_ = ::accept(listener, nullptr, nullptr);
        ::close(listener);
        const linger wait{.l_onoff = 1, .l_linger = static_cast<int>(kLingers.count())};
        EXPECT_EQ(::setsockopt(end_, SOL_SOCKET, SO_LINGER, &wait, sizeof(wait)), 0);
        const std::string text(1 << 16, 'x');
        constexpr int kOnItsWayMs = 2;  // there may be room again after the other end has received some
        pollfd writable{end_, POLLOUT, 0};
        while (::poll(&writable, 1, kOnItsWayMs) > 0)
            EXPECT_GT(::send(end_, text.data(), text.size(), MSG_DONTWAIT), 0);
    }
    ~LingeringConnection() {
        end();
        if (end_ >= 0) ::close(end_);
    }
    LingeringConnection(const LingeringConnection&) = delete;
    LingeringConnection& operator=(const LingeringConnection&) = delete;

    /// From now on no close waits for it.
    void end() {
        if (other_end_ >= 0) ::close(std::exchange(other_end_, -1));
    }
    /// Passes the ownership of its end to the caller.
    [[nodiscard]] int release() { return std::exchange(end_, -1); }
    /// Sends its end along with `text` and closes its own: the receiver has the last one, whose close waits.
    void send_along(int socket, std::string text) {
        ASSERT_NO_FATAL_FAILURE(test::send_along(socket, std::move(text), std::array{end_}));
        ::close(std::exchange(end_, -1));
    }

  private:
    int end_ = -1;
    int other_end_ = -1;
};

class NestedConnection {
  public:
    NestedConnection() {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
        inner_.send_along(ends[0], "x");
        ::close(ends[0]);
        outer_ = ends[1];
    }
    ~NestedConnection() {
        inner_.end();
        if (outer_ >= 0) ::close(outer_);
    }
    NestedConnection(const NestedConnection&) = delete;
    NestedConnection& operator=(const NestedConnection&) = delete;

    [[nodiscard]] int release() { return std::exchange(outer_, -1); }
    /// As LingeringConnection::send_along.
    void send_along(int socket, std::string text) {
        ASSERT_NO_FATAL_FAILURE(test::send_along(socket, std::move(text), std::array{outer_}));
        ::close(std::exchange(outer_, -1));
    }

  private:
    LingeringConnection inner_;
    int outer_ = -1;
};

}  // namespace octoskin::test
