// A network connection that takes long to close: what it still has to send nobody reads, and it is to wait
// for that.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <string>
#include <utility>

#include "tests/unit/host/apps/daemon/sent_along.hpp"

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
        ASSERT_NO_FATAL_FAILURE(test::send_along(socket, std::move(text), std::array{end_}));
        ::close(std::exchange(end_, -1));
    }

  private:
    int end_ = -1;
    int other_end_ = -1;
};

}  // namespace octoskin::test
