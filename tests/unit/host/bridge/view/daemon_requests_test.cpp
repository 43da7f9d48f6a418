// Requests to a daemon that answers, hangs, refuses or has gone.
#include "host/bridge/view/daemon_requests.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "host/apps/daemon/unix_socket.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::view {
namespace {

using namespace std::chrono_literals;

/// A socket that takes connections, reads their lines and gives the set answer.
class StandIn {
  public:
    StandIn(EventLoop& loop, const std::filesystem::path& place)
        : loop_(loop), bound_(bind_unix_socket(place, SOCK_STREAM).value()) {
        accepting_ = loop.on_readable(bound_.descriptor, [this] { accept(); });
    }
    ~StandIn() {
        for (const int one : connections) ::close(one);
        bound_.file.remove();
        ::close(bound_.descriptor);
    }
    StandIn(const StandIn&) = delete;
    StandIn& operator=(const StandIn&) = delete;

    std::string answer;  ///< to each line; empty: none
    bool hangs_up = false;
    std::vector<int> connections;
    std::vector<std::string> lines;

  private:
    void accept() {
        const int connection = ::accept(bound_.descriptor, nullptr, nullptr);
        if (connection < 0) return;
        connections.push_back(connection);
        reading_.emplace(connection, loop_.on_readable(connection, [this, connection] { read(connection); }));
    }
    void read(int connection) {
        std::array<char, 65536> bytes{};
        const ssize_t count = ::recv(connection, bytes.data(), bytes.size(), 0);
        if (count <= 0 || hangs_up) {
            reading_.erase(connection);
            std::erase(connections, connection);
            ::close(connection);
            return;
        }
        lines.emplace_back(bytes.data(), static_cast<std::size_t>(count));
        (void)::send(connection, answer.data(), answer.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    }
    EventLoop& loop_;
    BoundSocket bound_;
    EventSource accepting_;
    std::map<int, EventSource> reading_;
};

class DaemonRequestsTest : public ::testing::Test {
  protected:
    void ask(const std::string& line, Nanoseconds patience = 10s) {
        requests.ask(line, patience, [this](Result<std::string, std::string> outcome) {
            outcomes.push_back(outcome ? *outcome : "failed: " + outcome.error());
        });
    }
    void run_until(const std::function<bool()>& is_done) {
        int turns = 0;
        const EventSource look = loop.every(5ms, [&] {
            requests.attend();
            if (is_done() || ++turns > 2'000) loop.stop(0);
        });
        (void)loop.run();
        EXPECT_TRUE(is_done());
    }
    [[nodiscard]] std::size_t failures() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(outcomes, [](const auto& one) { return one.starts_with("failed"); }));
    }

    testing_support::ScratchFolder folder;
    std::filesystem::path place = folder / "control";
    EventLoop loop;
    DaemonRequests requests{loop, place};
    std::vector<std::string> outcomes;
};

TEST_F(DaemonRequestsTest, give_the_line_of_the_answer) {
    StandIn daemon(loop, place);
    daemon.answer = "{\"ok\":true}\n";
    ask("voxel {}");
    EXPECT_TRUE(outcomes.empty()) << "it did not wait";
    run_until([&] { return outcomes.size() == 1; });
    EXPECT_EQ(outcomes.front(), R"({"ok":true})");
    EXPECT_EQ(daemon.lines, std::vector<std::string>{"voxel {}\n"});
}

TEST_F(DaemonRequestsTest, fail_at_once_without_a_daemon) {
    ask("voxel {}");
    EXPECT_EQ(failures(), 1U);
}

TEST_F(DaemonRequestsTest, end_with_their_time_if_the_daemon_hangs) {
    StandIn daemon(loop, place);
    for (int i = 0; i < 6; ++i) ask("voxel {}", 50ms);
    run_until([&] { return failures() == 6; });
}

TEST_F(DaemonRequestsTest, are_a_few_at_once_and_the_rest_in_turn) {
    StandIn daemon(loop, place);
    for (int i = 0; i < 10; ++i) ask(std::to_string(i));
    int quiet_turns = 0;
    run_until([&] {
        if (daemon.lines.size() == DaemonRequests::kAtOnce && ++quiet_turns == 5) {  // no further one came
            EXPECT_TRUE(outcomes.empty());
            daemon.answer = "{}\n";
            for (const int one : daemon.connections) (void)::send(one, "{}\n", 3, MSG_NOSIGNAL);
        }
        return outcomes.size() == 10;
    });
    EXPECT_EQ(quiet_turns, 5);
    EXPECT_EQ(failures(), 0U);
    EXPECT_EQ(daemon.lines.front(), "0\n");
    EXPECT_EQ(daemon.lines.back(), "9\n");
}

TEST_F(DaemonRequestsTest, are_refused_beyond_a_bound) {
    StandIn daemon(loop, place);
    for (std::size_t i = 0; i < DaemonRequests::kAtOnce + DaemonRequests::kWaitingMax; ++i) ask("x");
    EXPECT_EQ(outcomes.size(), 0U);
    ask("x");
    EXPECT_EQ(failures(), 1U);
}

TEST_F(DaemonRequestsTest, fail_if_the_daemon_hangs_up) {
    StandIn daemon(loop, place);
    daemon.hangs_up = true;
    ask("voxel {}");
    run_until([&] { return failures() == 1; });
}

TEST_F(DaemonRequestsTest, take_no_answer_without_an_end) {
    StandIn daemon(loop, place);
    ask("voxel {}");
    std::size_t sent = 0;
    const std::string chunk(65'536, 'x');
    const EventSource flood = loop.every(1ms, [&] {
        if (daemon.lines.empty() || daemon.connections.empty()) return;
        const ssize_t count =
            ::send(daemon.connections[0], chunk.data(), chunk.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (count > 0) sent += static_cast<std::size_t>(count);
    });
    run_until([&] { return failures() == 1; });
    EXPECT_GT(sent, DaemonRequests::kAnswerBytesMax);
    EXPECT_LT(sent, 2 * DaemonRequests::kAnswerBytesMax);
}

}  // namespace
}  // namespace octoskin::view
