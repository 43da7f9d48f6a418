// What systemd is told, as it arrives at a socket like systemd's. Oracle: sd_notify(3),
// sd_watchdog_enabled(3).
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/port/linux/service_manager.hpp"

namespace octoskin::linux_port {
namespace {

/// An abstract socket of the name that systemd would give; the environment is as before afterwards.
class ServiceManagerTest : public testing::Test {
  protected:
    ServiceManagerTest() {
        name_ = "@octoskin-service-manager-test-" + std::to_string(::getpid());
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, name_.data(), name_.size());
        address.sun_path[0] = '\0';
        const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
        socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    }
    ~ServiceManagerTest() override {
        ::close(socket_);
        for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
    }

    std::vector<std::string> reported() const {
        std::vector<std::string> all;
        std::array<char, 256> text{};
        for (ssize_t size = 0; (size = ::recv(socket_, text.data(), text.size(), 0)) > 0;)
            all.emplace_back(text.data(), static_cast<std::size_t>(size));
        return all;
    }
    void set(const char* name, const std::string& value) const { ::setenv(name, value.c_str(), 1); }

    std::string name_;
    int socket_ = -1;
};

using Told = std::vector<std::string>;

TEST_F(ServiceManagerTest, is_told_of_the_start_of_turns_and_of_the_end) {
    set("NOTIFY_SOCKET", name_);
    set("WATCHDOG_USEC", "10000000");
    set("WATCHDOG_PID", std::to_string(::getpid()));
    ServiceManager manager = ServiceManager::from_environment();
    manager.started();
    manager.turned({.us = 4'294'000'000});
    manager.stopping();
    EXPECT_EQ(reported(), (Told{"READY=1", "WATCHDOG=1", "STOPPING=1"}));
}

TEST_F(ServiceManagerTest, is_told_of_turns_four_times_in_the_watchdogs_time_over_the_clocks_wrap) {
    ServiceManager manager(name_, Microseconds{10'000'000});
    EXPECT_EQ(manager.sleep_max(), Microseconds{2'500'000});
    const NodeTime begin{.us = 4'294'000'000};  // 967,296 us before the wrap
    for (int turn = 0; turn <= 1000; ++turn) manager.turned(begin + Microseconds{turn * 10'000});
    EXPECT_EQ(reported().size(), 5U);  // at 0, 2.5, 5, 7.5 and 10 s
}

TEST_F(ServiceManagerTest, that_does_not_watch_is_told_of_no_turn) {
    set("NOTIFY_SOCKET", name_);
    for (const char* time : {"", "0", "-5", "ten", "10000000 ", "99999999999999999999"}) {
        set("WATCHDOG_USEC", time);
        ServiceManager manager = ServiceManager::from_environment();
        manager.turned({.us = 1});
        EXPECT_EQ(manager.sleep_max(), std::nullopt) << time;
    }
    set("WATCHDOG_USEC", "10000000");
    set("WATCHDOG_PID", std::to_string(::getpid() + 1));
    ServiceManager::from_environment().turned({.us = 1});
    EXPECT_EQ(reported(), Told{});
}

TEST_F(ServiceManagerTest, may_be_absent_or_gone) {
    ServiceManager::from_environment().started();
    ServiceManager("/no/such/socket", std::nullopt).started();
    ServiceManager(std::string(200, 'x'), std::nullopt).started();
    EXPECT_EQ(reported(), Told{});
}

}  // namespace
}  // namespace octoskin::linux_port
