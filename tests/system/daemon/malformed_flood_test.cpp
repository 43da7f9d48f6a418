// A flood of packets that are no frames, beside a bus that is alive: whoever asks is answered, and the map
// goes on.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>
#include <vector>

#include "host/apps/daemon/daemon_client.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

/// Sends as quickly as the other end takes them: packets of these sizes, by turns.
class PacketFlood {
  public:
    PacketFlood(int socket, std::vector<std::size_t> sizes)
        : socket_(socket), thread_([this, sizes = std::move(sizes)](const std::stop_token& end) {
              const std::array<std::byte, 100> bytes{};
              for (std::size_t i = 0; !end.stop_requested(); ++i) {
                  if (::send(socket_, bytes.data(), sizes[i % sizes.size()], MSG_DONTWAIT | MSG_NOSIGNAL) >=
                      0) {
                      ++sent_;
                  } else {
                      std::this_thread::yield();
                  }
              }
          }) {}
    ~PacketFlood() {
        thread_ = {};
        ::close(socket_);
    }
    PacketFlood(const PacketFlood&) = delete;
    PacketFlood& operator=(const PacketFlood&) = delete;
    /// Ends it; how many it sent.
    int end() {
        thread_ = {};
        return sent_;
    }

  private:
    int socket_;
    std::atomic<int> sent_ = 0;
    std::jthread thread_;
};

TEST_F(DaemonTest, answers_within_a_second_in_a_flood_of_what_is_no_frame) {
    // Nothing, less than a frame, a classical one whose bytes are none, more than a frame.
    const std::vector<std::vector<std::size_t>> floods{{5}, {0, 1, 5, 15, 17, 71, 73, 100}};
    std::vector<int> ends;
    for (std::size_t i = 0; i < floods.size(); ++i) ends.push_back(::fcntl(our_end_, F_DUPFD_CLOEXEC, 0));
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const Json before = daemon_->status();
    std::chrono::steady_clock::duration slowest{};
    int sent = 0;
    {
        PacketFlood first(ends[0], floods[0]);
        PacketFlood second(ends[1], floods[1]);
        const auto begun = std::chrono::steady_clock::now();
        for (; std::chrono::steady_clock::now() - begun < 3s; std::this_thread::sleep_for(50ms)) {
            const auto asked = std::chrono::steady_clock::now();
            ASSERT_TRUE(daemon_->status().is_object()) << "no answer";
            slowest = std::max(slowest, std::chrono::steady_clock::now() - asked);
        }
        sent = first.end() + second.end();
    }
    ASSERT_TRUE(daemon_->wait_until(
        [&](const Json& now) { return now["can"]["malformed"].get<int>() >= sent; }, 10s));
    const Json after = daemon_->status();
    std::printf(
        "%d malformed packets a second, the slowest answer after %lld ms, %d readings used\n", sent / 3,
        static_cast<long long>(std::chrono::duration_cast<std::chrono::milliseconds>(slowest).count()),
        readings_used(after) - readings_used(before));
    EXPECT_LT(slowest, 1s);
    EXPECT_EQ(after["can"]["malformed"], sent) << "each is counted once";
    EXPECT_EQ(after["can"]["state"], "up") << "an empty packet is not the other end's last";
    EXPECT_GT(readings_used(after), readings_used(before)) << "the map does not go on";
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

// A remote frame in FD format, which no bus can carry, to a daemon that records.
TEST_F(DaemonTest, records_on_when_a_packet_is_no_frame_that_can_be_written_down) {
    const int end = ::fcntl(our_end_, F_DUPFD_CLOEXEC, 0);
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto answer = ask_daemon(folder_ / "control", "record start 0 " + (folder_ / "out").string());
    ASSERT_TRUE(answer) << answer.error().message();
    canfd_frame frame{};
    for (const std::uint32_t flags :
         {CAN_RTR_FLAG, CAN_RTR_FLAG | CAN_EFF_FLAG, CAN_ERR_FLAG, CAN_ERR_FLAG | CAN_RTR_FLAG}) {
        frame.can_id = flags | 0x241U;
        ASSERT_EQ(::send(end, &frame, CANFD_MTU, 0), static_cast<ssize_t>(CANFD_MTU));
    }
    ::close(end);
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["can"]["malformed"] == 4; }, 5s))
        << daemon_->log();
    EXPECT_EQ(daemon_->status().value(Json::json_pointer("/recording/state"), ""), "recording");
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / "meta.yaml"));
}

}  // namespace
}  // namespace octoskin::test
