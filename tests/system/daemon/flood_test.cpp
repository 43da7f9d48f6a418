// A flood of joint states beside a bus that is alive.
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <set>
#include <string>
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

/// A process of its own that sends one text as quickly as it can: what any member of the group can do.
class FloodingProcess {
  public:
    FloodingProcess(const std::filesystem::path& file, const std::string& text)
        : socket_(connect_unix_socket(file, SOCK_DGRAM, 100ms).value()), process_(::fork()) {
        if (process_ != 0) return;
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        while (true) (void)!::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    }
    ~FloodingProcess() {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
        ::close(socket_);
    }
    FloodingProcess(const FloodingProcess&) = delete;
    FloodingProcess& operator=(const FloodingProcess&) = delete;

  private:
    int socket_;
    pid_t process_;
};

/// The arm's driver: 100 samples a second.
class Driver {
  public:
    explicit Driver(const std::filesystem::path& file)
        : socket_(connect_unix_socket(file, SOCK_DGRAM, 100ms).value()),
          thread_([this](const std::stop_token& end) {
              constexpr std::string_view kAtRest = "0 0 0 -1.5 0 1.5 0";
              for (auto due = std::chrono::steady_clock::now(); !end.stop_requested(); due += 10ms) {
                  std::this_thread::sleep_until(due);
                  (void)!::send(socket_, kAtRest.data(), kAtRest.size(), MSG_NOSIGNAL);
              }
          }) {}
    ~Driver() {
        thread_ = {};
        ::close(socket_);
    }
    Driver(const Driver&) = delete;
    Driver& operator=(const Driver&) = delete;

  private:
    int socket_;
    std::jthread thread_;
};

/// Of what came between two looks, what was refused for want of a pose, a time or room: not for what the
/// reading itself says.
int readings_lost(const Json& before, const Json& after) {
    const std::set<std::string> of_the_reading = {"no_return",         "below_range_min", "above_range_max",
                                                  "self_hit",          "status_fault",    "sigma_above_max",
                                                  "contradicts_camera"};
    int lost = 0;
    const Json& rejected = after["inputs"]["readings"]["rejected"];
    for (const auto& [reason, count] : rejected.items()) {
        if (of_the_reading.contains(reason)) continue;
        lost += count.get<int>() - before["inputs"]["readings"]["rejected"].value(reason, 0);
    }
    return lost;
}
int readings_in(const Json& status) {
    return status["inputs"]["readings"]["in"].get<int>();
}
std::uint64_t taken_from_flood(const Json& status) {
    std::uint64_t sum = 0;
    for (const char* key : {"displaced", "surplus", "not_a_number", "wrong_count", "time_off", "too_large"})
        sum += status["joints_socket"][key].get<std::uint64_t>();
    return sum;
}

TEST_F(DaemonTest, uses_the_readings_of_the_bus_while_another_program_floods_the_socket) {
    start({"--no-camera", "--joints", (folder_ / "joints").string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const Driver driver(daemon_->joints());
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1) << daemon_->log();
    for (const std::string& text : {std::string("x"), std::string(1'000, '1'), std::string("9 9 9 9 9 9 9"),
                                    std::string("0 0 0 -1.5 0 1.5 0 1")}) {
        const FloodingProcess flood(daemon_->joints(), text);
        const Json before = daemon_->status();
        std::this_thread::sleep_for(2s);
        const Json after = daemon_->status();
        const int came = readings_in(after) - readings_in(before);
        const int lost = readings_lost(before, after);
        std::printf("flood of '%.10s': %.0f a second, %d of %d readings lost\n", text.c_str(),
                    static_cast<double>(taken_from_flood(after) - taken_from_flood(before)) / 2.0, lost,
                    came);
        EXPECT_GT(came, 1'900) << "34 sensors at 30 Hz, 2 s";
        EXPECT_LE(lost, came / 100) << after["inputs"]["readings"].dump();
        EXPECT_GT(taken_from_flood(after) - taken_from_flood(before), 10'000U) << "that was no flood";
        EXPECT_GT(after["joints_socket"]["surplus"], before["joints_socket"]["surplus"]);
        EXPECT_TRUE(has_problem(after, "joints_flood")) << after["problems"].dump();
    }
}

TEST_F(DaemonTest, maps_on_in_a_flood_of_joint_states_tells_of_it_and_ends_in_time) {
    start({"--no-camera", "--joints", (folder_ / "joints").string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const Flood flood(daemon_->joints());
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1) << daemon_->log();
    const auto is_reported =
        daemon_->wait_until([](const Json& now) { return has_problem(now, "joints_flood"); }, 5s);
    EXPECT_TRUE(is_reported) << daemon_->status()["joints_socket"].dump();
    const Json before = daemon_->status();
    const auto begun = std::chrono::steady_clock::now();
    const int sent_before = flood.sent();
    int answers = 0;
    int reported = 0;
    std::chrono::steady_clock::duration slowest{};
    for (; std::chrono::steady_clock::now() - begun < 4s; std::this_thread::sleep_for(50ms)) {
        const auto asked = std::chrono::steady_clock::now();
        const Json now = daemon_->status();
        slowest = std::max(slowest, std::chrono::steady_clock::now() - asked);
        ASSERT_TRUE(now.is_object()) << "no answer";
        ++answers;
        // On a busy machine the flood has its pauses; nothing else is wrong at any time.
        ASSERT_LE(now["problems"].size(), 1U) << now["problems"].dump(1);
        if (!now["problems"].empty()) ++reported;
    }
    const Json after = daemon_->status();
    const int readings = readings_used(after) - readings_used(before);
    std::printf(
        "%d of a flood of %d a second, %d answers: %d readings used; %s\n",
        after["joints_socket"]["displaced"].get<int>() - before["joints_socket"]["displaced"].get<int>(),
        (flood.sent() - sent_before) / 4, answers, readings, after["clock"].dump().c_str());
    EXPECT_GT(reported, answers / 2) << "the flood is told of as long as it lasts";
    EXPECT_GT(readings, 800);
    EXPECT_LE(readings_lost(before, after), (readings_in(after) - readings_in(before)) / 100)
        << after["inputs"]["readings"].dump();
    EXPECT_LT(slowest, 1s) << "what is wrong is named within a second";
    EXPECT_EQ(after["clock"]["steps_back"], 0) << after["clock"].dump();
    EXPECT_EQ(after["clock"]["stamps_ignored"], 0) << after["clock"].dump();
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

}  // namespace
}  // namespace octoskin::test
