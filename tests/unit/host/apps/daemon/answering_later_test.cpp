// Answers of the control socket that take their time.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/control_socket.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/query/query_answer.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

class AnsweringLater : public testing::Test {
  protected:
    AnsweringLater() {
        auto opened = ControlSocket::open(file(), loop_,
                                          [](const std::string& request) { return "you said " + request; });
        EXPECT_TRUE(opened) << opened.error().message();
        socket_ = std::move(opened).value();
        socket_->answer_later(
            [this](const std::string& request, std::uint64_t ticket, uid_t user) {
                if (request != "slow") return false;
                users_.push_back(user);
                tickets_.push_back(ticket);
                return true;
            },
            [this](std::uint64_t ticket) { gone_.push_back(ticket); });
    }
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "control"; }
    [[nodiscard]] int connect() const {
        const auto descriptor = connect_unix_socket(file(), SOCK_STREAM);
        EXPECT_TRUE(descriptor);
        return descriptor ? *descriptor : -1;
    }
    /// Runs the loop while `client` is at work in a thread of its own; it answers what it took once
    /// `may_answer_`.
    void serve(const std::function<void()>& client) {
        std::atomic<bool> is_done = false;
        std::thread thread([&] {
            client();
            is_done = true;
        });
        const auto watch = loop_.every(5ms, [&] {
            if (is_done) loop_.stop(0);
            if (!may_answer_) return;
            for (const std::uint64_t ticket : std::exchange(tickets_, {})) socket_->reply(ticket, "at last");
        });
        EXPECT_EQ(loop_.run(), 0);
        thread.join();
    }

    testing_support::ScratchFolder folder_;
    EventLoop loop_;
    std::unique_ptr<ControlSocket> socket_;
    std::vector<uid_t> users_;
    std::vector<std::uint64_t> tickets_;
    std::vector<std::uint64_t> gone_;
    std::atomic<bool> may_answer_ = false;
};

TEST_F(AnsweringLater, serves_others_meanwhile_and_reads_on_afterwards) {
    const int client = connect();
    EXPECT_EQ(::send(client, "slow\nnext\n", 10, MSG_NOSIGNAL), 10);
    serve([&] {
        EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
        std::array<char, 64> bytes{};
        EXPECT_LT(::recv(client, bytes.data(), bytes.size(), MSG_DONTWAIT), 0) << "answered out of order";
        may_answer_ = true;
        const std::string_view wanted = "at last\nyou said next\n";
        ASSERT_EQ(::recv(client, bytes.data(), wanted.size(), MSG_WAITALL),
                  static_cast<ssize_t>(wanted.size()));
        EXPECT_EQ(std::string_view(bytes.data(), wanted.size()), wanted);
    });
    EXPECT_EQ(users_, std::vector<uid_t>{::getuid()});
    ::close(client);
}

TEST_F(AnsweringLater, has_no_answer_for_who_has_gone_meanwhile) {
    const int client = connect();
    EXPECT_EQ(::send(client, "slow\n", 5, MSG_NOSIGNAL), 5);
    serve([&] {
        EXPECT_TRUE(ask_daemon(file(), "status"));  // the slow one came first, and was taken
        ::close(client);
        may_answer_ = true;
        EXPECT_EQ(ask_daemon(file(), "slow").value(), "at last");
    });
}

TEST_F(AnsweringLater, tells_that_nobody_waits_any_more_when_the_next_one_comes) {
    const int gone = connect();
    const int waiting = connect();
    EXPECT_EQ(::send(gone, "slow\n", 5, MSG_NOSIGNAL), 5);
    EXPECT_EQ(::send(waiting, "slow\n", 5, MSG_NOSIGNAL), 5);
    serve([&] {
        EXPECT_TRUE(ask_daemon(file(), "status"));  // after both
        ::shutdown(waiting, SHUT_WR);               // it still reads
        ::close(gone);
        EXPECT_TRUE(ask_daemon(file(), "status"));
    });
    EXPECT_EQ(tickets_.size(), 2U);
    EXPECT_EQ(gone_, std::vector<std::uint64_t>{tickets_.front()});
    ::close(waiting);
}

TEST_F(AnsweringLater, tells_it_in_time_though_nobody_else_comes) {
    auto quick = ControlSocket::open(
        folder_ / "quick", loop_, [](const std::string&) { return std::string("yes"); }, 40ms);
    ASSERT_TRUE(quick);
    std::atomic<std::uint64_t> gone = 0;
    std::atomic<std::uint64_t> taken = 0;
    (*quick)->answer_later(
        [&](const std::string&, std::uint64_t ticket, uid_t) {
            taken = ticket;
            return true;
        },
        [&](std::uint64_t ticket) { gone = ticket; });
    const int client = *connect_unix_socket(folder_ / "quick", SOCK_STREAM);
    EXPECT_EQ(::send(client, "slow\n", 5, MSG_NOSIGNAL), 5);
    serve([&] {
        for (int i = 0; i < 400 && taken == 0; ++i) std::this_thread::sleep_for(5ms);
        ::close(client);
        for (int i = 0; i < 400 && gone == 0; ++i) std::this_thread::sleep_for(5ms);
    });
    EXPECT_NE(gone, 0U);
    EXPECT_EQ(gone, taken);
}

/// The answer to a question too many.
std::string too_many(const std::string& waiting) {
    return query_refused({ExitCode::unavailable,
                          {.code = ErrorCode::limit_exceeded,
                           .what = "too many questions: " + waiting,
                           .remedy = "ask again later"}})
        .dump();
}

TEST_F(AnsweringLater, is_not_given_up_for_others_however_many_come_and_keeps_nobody_out) {
    std::vector<int> waiting;
    for (std::size_t i = 0; i < ControlSocket::kWaitingOfUserMax; ++i) {
        waiting.push_back(connect());
        EXPECT_EQ(::send(waiting.back(), "slow\n", 5, MSG_NOSIGNAL), 5);
    }
    serve([&] {
        for (int i = 0; i < 40; ++i) EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
        EXPECT_EQ(ask_daemon(file(), "slow").value(), too_many("4 of this user wait"));
        may_answer_ = true;
        const std::string_view wanted = "at last\n";
        for (const int client : waiting) {
            std::array<char, 64> bytes{};
            ASSERT_EQ(::recv(client, bytes.data(), wanted.size(), MSG_WAITALL),
                      static_cast<ssize_t>(wanted.size()));
            EXPECT_EQ(std::string_view(bytes.data(), wanted.size()), wanted);
        }
    });
    EXPECT_EQ(gone_.size(), 1U) << "the question too many";
    for (const int client : waiting) ::close(client);
}

/// Connects as another user, which only root can.
int connect_as(uid_t user, const std::filesystem::path& file) {
    int connected = -1;
    std::thread thread([&] {  // the raw call is of this thread alone
        if (::syscall(SYS_setresuid, -1, user, -1) != 0) return;
        const auto descriptor = connect_unix_socket(file, SOCK_STREAM);
        connected = descriptor ? *descriptor : -1;
    });
    thread.join();
    return connected;
}

TEST_F(AnsweringLater, lets_four_of_each_user_wait_and_sixteen_in_all) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root connects as other users";
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::all);
    std::filesystem::permissions(file(), std::filesystem::perms::all);
    std::vector<int> clients;
    std::string of_root;
    serve([&] {
        for (uid_t user = 3'000; user < 3'004; ++user) {
            for (int i = 0; i < 5; ++i) {
                clients.push_back(connect_as(user, file()));
                EXPECT_EQ(::send(clients.back(), "slow\n", 5, MSG_NOSIGNAL), 5);
                std::this_thread::sleep_for(20ms);
            }
        }
        const auto reported = ask_daemon(file(), "slow");
        of_root = reported ? *reported : reported.error().message();
    });
    EXPECT_EQ(gone_.size(), 5U) << "the fifth of each user, and the one of root";
    EXPECT_EQ(tickets_.size(), 21U);
    EXPECT_EQ(of_root, too_many("16 wait"));
    for (const int client : clients) ::close(client);
}

TEST_F(AnsweringLater, takes_nobody_for_idle_who_waits) {
    auto quick = ControlSocket::open(
        folder_ / "quick", loop_, [](const std::string&) { return std::string("yes"); }, 40ms);
    ASSERT_TRUE(quick);
    std::uint64_t taken = 0;
    (*quick)->answer_later(
        [&](const std::string&, std::uint64_t ticket, uid_t) {
            taken = ticket;
            return true;
        },
        [](std::uint64_t) {});
    const auto answering = loop_.every(200ms, [&] { (*quick)->reply(taken, "after all"); });
    serve([&] { EXPECT_EQ(ask_daemon(folder_ / "quick", "anything").value(), "after all"); });
    EXPECT_EQ((*quick)->dropped(), 0U);
}

}  // namespace
}  // namespace octoskin
