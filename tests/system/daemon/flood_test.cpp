// A flood of joint states beside a bus that is alive.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <thread>

#include "host/apps/daemon/unix_socket.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// A program that sends as quickly as it can: what a wrong loop in a driver does.
class Flood {
  public:
    explicit Flood(const std::filesystem::path& file)
        : socket_(connect_unix_socket(file, SOCK_DGRAM, 100ms).value()),
          thread_([this](const std::stop_token& end) {
              constexpr std::string_view kAtRest = "0 0 0 -1.5 0 1.5 0";
              while (!end.stop_requested()) {
                  // Each waits until there is room, but not for ever: this must end.
                  if (::send(socket_, kAtRest.data(), kAtRest.size(), MSG_NOSIGNAL) >= 0) ++sent_;
              }
          }) {}
    ~Flood() {
        thread_ = {};  // ended and joined before its socket goes
        ::close(socket_);
    }
    Flood(const Flood&) = delete;
    Flood& operator=(const Flood&) = delete;
    [[nodiscard]] int sent() const { return sent_; }

  private:
    int socket_;
    std::atomic<int> sent_ = 0;
    std::jthread thread_;
};

TEST_F(DaemonTest, maps_on_in_a_flood_of_joint_states_tells_of_it_and_ends_in_time) {
    start({"--no-camera", "--joints", (folder_ / "joints").string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const Flood flood(daemon_->joints());
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1) << daemon_->log();
    const auto is_told = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "quicker than they can be taken"); }, 5s);
    EXPECT_TRUE(is_told) << daemon_->status()["joints_socket"].dump();
    const Json before = daemon_->status();
    const auto begun = std::chrono::steady_clock::now();
    const int sent_before = flood.sent();
    int answers = 0;
    int told = 0;
    std::chrono::steady_clock::duration slowest{};
    for (; std::chrono::steady_clock::now() - begun < 4s; std::this_thread::sleep_for(50ms)) {
        const auto asked = std::chrono::steady_clock::now();
        const Json now = daemon_->status();
        slowest = std::max(slowest, std::chrono::steady_clock::now() - asked);
        ASSERT_TRUE(now.is_object()) << "no answer";
        ++answers;
        // On a busy machine the flood has its pauses; nothing else is wrong at any time.
        ASSERT_LE(now["problems"].size(), 1U) << now["problems"].dump(1);
        if (!now["problems"].empty()) ++told;
    }
    const Json after = daemon_->status();
    const int readings = readings_used(after) - readings_used(before);
    std::printf(
        "%d of a flood of %d a second, %d answers: %d readings used; %s\n",
        after["joints_socket"]["displaced"].get<int>() - before["joints_socket"]["displaced"].get<int>(),
        (flood.sent() - sent_before) / 4, answers, readings, after["clock"].dump().c_str());
    EXPECT_GT(told, answers / 2) << "the flood is told of as long as it lasts";
    EXPECT_GT(readings, 800);
    EXPECT_LT(slowest, 1s) << "what is wrong is named within a second";
    EXPECT_EQ(after["clock"]["steps_back"], 0) << after["clock"].dump();
    EXPECT_EQ(after["clock"]["stamps_ignored"], 0) << after["clock"].dump();
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

}  // namespace
}  // namespace octoskin::test
