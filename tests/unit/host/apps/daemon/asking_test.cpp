#include "host/apps/daemon/daemon_client.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>

#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/apps/daemon/stopped_listener.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using testing_support::StoppedListener;

using Clock = std::chrono::steady_clock;

TEST(AskDaemon, says_how_to_begin_one_where_there_is_none) {
    const testing_support::ScratchFolder folder;
    const auto nobody = ask_daemon(folder / "nobody", "status");
    ASSERT_FALSE(nobody);
    EXPECT_EQ(nobody.error().exit, ExitCode::unavailable);
    EXPECT_EQ(nobody.error().error.code, ErrorCode::no_listener);
    EXPECT_EQ(nobody.error().error.file, folder / "nobody");
    EXPECT_NE(nobody.error().error.remedy.find("octoskin run"), std::string::npos);
}

TEST(AskDaemon, waits_no_longer_than_it_says_for_one_that_lets_nobody_in) {
    const testing_support::ScratchFolder folder;
    StoppedListener stopped(folder / "control");
    stopped.fill();
    const auto begun = Clock::now();
    const auto answer = ask_daemon(folder / "control", "status", 200ms);
    ASSERT_FALSE(answer);
    EXPECT_GE(Clock::now() - begun, 190ms);
    EXPECT_LE(Clock::now() - begun, 1s);
    EXPECT_EQ(answer.error().exit, ExitCode::io_failed);
    EXPECT_EQ(answer.error().error.code, ErrorCode::no_answer);
    EXPECT_EQ(answer.error().error.file, folder / "control");
    EXPECT_NE(answer.error().error.what.find("connection"), std::string::npos) << answer.error().message();
    EXPECT_NE(answer.error().error.remedy.find("stopped"), std::string::npos) << answer.error().message();
}

TEST(AskDaemon, waits_no_longer_than_it_says_for_one_that_let_us_in_and_is_silent) {
    const testing_support::ScratchFolder folder;
    const StoppedListener stopped(folder / "control");
    const auto begun = Clock::now();
    const auto answer = ask_daemon(folder / "control", "status", 200ms);
    ASSERT_FALSE(answer);
    EXPECT_GE(Clock::now() - begun, 190ms);
    EXPECT_LE(Clock::now() - begun, 1s);
    EXPECT_EQ(answer.error().error.code, ErrorCode::no_answer);
    EXPECT_NE(answer.error().error.what.find("in time"), std::string::npos) << answer.error().message();
}

/// A question to the map may take a minute; that nobody is there to answer it shows before.
TEST(AskDaemon, waits_no_longer_for_a_sign_of_life_however_long_the_answer_may_take) {
    const testing_support::ScratchFolder folder;
    const StoppedListener silent(folder / "silent");
    StoppedListener full(folder / "full");
    full.fill();
    const auto expect_bounded = [&folder](const char* socket, const char* says) {
        const auto begun = Clock::now();
        const auto answer = ask_daemon(folder / socket, "query {}", 60s);
        ASSERT_FALSE(answer);
        EXPECT_GE(Clock::now() - begun, 4900ms);
        EXPECT_LE(Clock::now() - begun, 6s);
        EXPECT_EQ(answer.error().exit, ExitCode::io_failed);
        EXPECT_EQ(answer.error().error.code, ErrorCode::no_answer);
        EXPECT_EQ(answer.error().error.file, folder / socket);
        EXPECT_NE(answer.error().error.what.find(says), std::string::npos) << answer.error().message();
    };
    std::thread beside([&] { expect_bounded("silent", "in time"); });  // both wait for 5 s
    expect_bounded("full", "connection");
    beside.join();
}

TEST(AskDaemon, asks_for_a_sign_of_life_before_what_may_take_long) {
    const testing_support::ScratchFolder folder;
    const StoppedListener daemon(folder / "control");
    std::string heard;
    std::thread answering([&] {
        const int client = daemon.accept();
        for (const std::string_view says : {"{\"ok\":true}\n", "an answer\n"}) {
            std::array<char, 64> request{};
            const ssize_t count = ::recv(client, request.data(), request.size(), 0);
            heard.append(request.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
            (void)!::send(client, says.data(), says.size(), MSG_NOSIGNAL);
        }
        ::close(client);
    });
    const auto answer = ask_daemon(folder / "control", "query {}", 60s);
    answering.join();
    ASSERT_TRUE(answer) << answer.error().message();
    EXPECT_EQ(*answer, "an answer");
    EXPECT_EQ(heard, "hello\nquery {}\n");
}

/// What reads and writes JSON calls itself for each level.
TEST(AskDaemon, takes_no_answer_that_is_nested_deeper_than_any_of_a_daemon) {
    const testing_support::ScratchFolder folder;
    const StoppedListener foreign(folder / "control");
    const auto ask_for = [&](const std::string& says) {
        std::thread answering([&] {
            const int client = foreign.accept();
            std::array<char, 64> request{};
            (void)!::recv(client, request.data(), request.size(), 0);
            (void)!::send(client, says.data(), says.size(), MSG_NOSIGNAL);
            ::close(client);
        });
        auto answer = ask_daemon(folder / "control", "status");
        answering.join();
        return answer;
    };
    const auto deep = ask_for(std::string(65, '[') + std::string(65, ']') + "\n");
    ASSERT_FALSE(deep);
    EXPECT_EQ(deep.error().exit, ExitCode::bad_data);
    EXPECT_EQ(deep.error().error.code, ErrorCode::foreign_format);
    EXPECT_TRUE(ask_for(std::string(64, '[') + std::string(64, ']') + "\n"));
    EXPECT_TRUE(ask_for("\"\\\"" + std::string(99, '{') + "\"\n")) << "of a text";
}

TEST(AskDaemon, says_when_the_daemon_closed_the_connection_and_does_not_wait_then) {
    const testing_support::ScratchFolder folder;
    const StoppedListener ending(folder / "control");
    for (const std::string said : {"", "half a li"}) {
        std::thread closing([&] {
            const int client = ending.accept();
            std::array<char, 64> request{};
            (void)!::recv(client, request.data(), request.size(), 0);
            (void)!::send(client, said.data(), said.size(), MSG_NOSIGNAL);
            ::close(client);
        });
        const auto begun = Clock::now();
        const auto answer = ask_daemon(folder / "control", "status");
        closing.join();
        ASSERT_FALSE(answer);
        EXPECT_LE(Clock::now() - begun, 2s);
        EXPECT_EQ(answer.error().error.code, ErrorCode::no_answer);
        EXPECT_EQ(answer.error().error.file, folder / "control");
        EXPECT_NE(answer.error().error.what.find(said.empty() ? "without an answer" : "in mid-answer"),
                  std::string::npos)
            << answer.error().message();
    }
}

}  // namespace
}  // namespace octoskin
