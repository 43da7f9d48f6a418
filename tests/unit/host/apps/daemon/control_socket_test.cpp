#include "host/apps/daemon/control_socket.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/apps/query/query_answer.hpp"
#include "tests/support/lingering_connection.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

class ControlSocketTest : public testing::Test {
  protected:
    ControlSocketTest() {
        auto opened = ControlSocket::open(file(), loop_, [this](const std::string& request) {
            ++asked_;
            return request == "large" ? std::string(100'000, 'x') : "you said " + request;
        });
        EXPECT_TRUE(opened) << opened.error().message();
        if (opened) socket_ = std::move(opened).value();
    }
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "control"; }
    /// Runs the loop while `client` is at work in a thread of its own.
    void serve(const std::function<void()>& client) {
        std::atomic<bool> is_done = false;
        std::thread thread([&] {
            client();
            is_done = true;
        });
        const auto watch = loop_.every(5ms, [&] {
            if (is_done) loop_.stop(0);
        });
        EXPECT_EQ(loop_.run(), 0);
        thread.join();
    }
    [[nodiscard]] int connect() const {
        const auto descriptor = connect_unix_socket(file(), SOCK_STREAM);
        EXPECT_TRUE(descriptor);
        return descriptor ? *descriptor : -1;
    }

    testing_support::ScratchFolder folder_;
    EventLoop loop_;
    int asked_ = 0;
    std::unique_ptr<ControlSocket> socket_;
};

TEST_F(ControlSocketTest, lets_no_client_send_a_descriptor_along) {
    const std::array<int, 2> clients{connect(), connect()};
    const bool can_refuse = test::can_refuse_descriptors(clients[0]);
    if (can_refuse) {
        EXPECT_EQ(test::try_to_send_along(clients[0], "a\n", std::array{STDERR_FILENO}), EPERM);
        serve([&] {
            EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
            EXPECT_EQ(test::try_to_send_along(clients[1], "a\n", std::array{STDERR_FILENO}), EPERM)
                << "it was let in";
        });
    }
    for (const int client : clients) ::close(client);
    if (!can_refuse) GTEST_SKIP() << "Linux before 6.16";
}

/// A kernel that lets descriptors through.
class OlderControlSocketTest : public ControlSocketTest {
  protected:
    OlderControlSocketTest() { test::let_descriptors_through(file()); }
};

// Closed as they are, they would hold up the daemon for as long as they linger.
TEST_F(OlderControlSocketTest, waits_for_no_connection_that_a_client_sends_along_and_keeps_none) {
    const auto descriptors = [] {
        const std::filesystem::directory_iterator open_now("/proc/self/fd");
        return std::distance(begin(open_now), end(open_now));
    };
    const auto before = descriptors();
    {
        test::LingeringConnection beside_a_request;
        test::LingeringConnection behind_too_long_a_one;  // which is not read to its end
        const std::array<int, 2> clients{connect(), connect()};
        beside_a_request.send_along(clients[0], "hello\n");
        const std::string too_long(ControlSocket::kRequestMax + 1, 'x');
        EXPECT_EQ(::send(clients[1], too_long.data(), too_long.size(), 0),
                  static_cast<ssize_t>(too_long.size()));
        behind_too_long_a_one.send_along(clients[1], "\n");
        const auto begun = std::chrono::steady_clock::now();
        serve([&] {
            for (const int client : clients) {
                std::array<char, 256> answer{};
                EXPECT_GT(::recv(client, answer.data(), answer.size(), 0), 0);
                ::close(client);
            }
            std::this_thread::sleep_for(50ms);  // for the daemon to see it
        });
        EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
    }
    EXPECT_EQ(descriptors(), before);
}

// However many there are: there is no number from which on it lets no client in.
TEST_F(OlderControlSocketTest, answers_everybody_whatever_clients_send_along) {
    std::list<test::NestedConnection> nested;
    const int client = connect();
    for (int i = 0; i < 80; ++i) ASSERT_NO_FATAL_FAILURE(nested.emplace_back().send_along(client, "a\n"));
    std::array<int, 25> many{};  // in all, on their way, well below the 1024 that a user may have
    many.fill(STDERR_FILENO);
    std::array<int, 8> idle{};
    for (int& one : idle) {
        one = connect();
        ASSERT_NO_FATAL_FAILURE(test::send_along(one, "h", many));
    }
    const auto begun = std::chrono::steady_clock::now();
    serve([&] {
        for (int i = 0; i < 20; ++i) EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
        std::string answers;
        std::array<char, 256> bytes{};
        while (std::ranges::count(answers, '\n') < 80) {
            const ssize_t count = ::recv(client, bytes.data(), bytes.size(), 0);
            ASSERT_GT(count, 0);
            answers.append(bytes.data(), static_cast<std::size_t>(count));
        }
    });
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    EXPECT_EQ(socket_->dropped(), 0U);
    ::close(client);
    for (const int one : idle) ::close(one);
}

TEST_F(OlderControlSocketTest, ends_without_a_wait_for_what_clients_sent_along) {
    std::list<test::NestedConnection> nested;
    const int let_in = connect();
    serve([&] { EXPECT_TRUE(ask_daemon(file(), "status")); });
    const int waiting = connect();
    for (const int client : {let_in, waiting})
        for (int i = 0; i < 5; ++i) ASSERT_NO_FATAL_FAILURE(nested.emplace_back().send_along(client, "a"));
    ::close(let_in);
    ::close(waiting);
    const auto begun = std::chrono::steady_clock::now();
    socket_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
}

TEST_F(ControlSocketTest, answers_each_line_with_one) {
    serve([&] {
        EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
        EXPECT_EQ(ask_daemon(file(), "large").value(), std::string(100'000, 'x'));
        EXPECT_EQ(ask_daemon(file(), "").value(), "you said ");
    });
    EXPECT_EQ(asked_, 3);
}

// Of seventy answers in a row the last reading would be as late as they take.
TEST_F(ControlSocketTest, answers_one_request_and_lets_everybody_else_have_a_turn_before_the_next) {
    const int client = connect();
    std::string requests;
    for (int i = 0; i < 70; ++i) requests += "status\n";
    ASSERT_EQ(::send(client, requests.data(), requests.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(requests.size()));
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    ASSERT_EQ(::write(pipe[1], "a", 1), 1);  // always readable, as a bus that is never silent
    int asked_before = 0;
    int in_a_row_max = 0;
    const auto bus = loop_.on_readable(pipe[0], [&] {
        in_a_row_max = std::max(in_a_row_max, asked_ - std::exchange(asked_before, asked_));
    });
    std::string answers;
    serve([&] {
        std::array<char, 4096> bytes{};
        while (std::ranges::count(answers, '\n') < 70) {
            const ssize_t count = ::recv(client, bytes.data(), bytes.size(), 0);
            ASSERT_GT(count, 0);
            answers.append(bytes.data(), static_cast<std::size_t>(count));
        }
    });
    EXPECT_EQ(asked_, 70);
    EXPECT_EQ(in_a_row_max, 1);
    for (const int descriptor : {client, pipe[0], pipe[1]}) ::close(descriptor);
}

TEST_F(ControlSocketTest, puts_a_request_together_that_comes_in_pieces) {
    serve([&] {
        const int client = connect();
        for (const char* piece : {"sta", "tus\nand", " more\n"}) {
            EXPECT_GT(::send(client, piece, std::char_traits<char>::length(piece), MSG_NOSIGNAL), 0);
            std::this_thread::sleep_for(5ms);
        }
        const std::string_view wanted = "you said status\nyou said and more\n";
        std::array<char, 64> bytes{};
        ASSERT_EQ(::recv(client, bytes.data(), wanted.size(), MSG_WAITALL),
                  static_cast<ssize_t>(wanted.size()));
        EXPECT_EQ(std::string_view(bytes.data(), wanted.size()), wanted);
        ::close(client);
    });
}

// It would be told of nothing that it has begun.
TEST_F(ControlSocketTest, is_not_asked_by_a_client_that_gave_up_before_it_was_let_in) {
    const int client = connect();
    EXPECT_EQ(::send(client, "status\n", 7, MSG_NOSIGNAL), 7);
    ::close(client);
    serve([&] { EXPECT_TRUE(ask_daemon(file(), "still there")); });
    EXPECT_EQ(asked_, 1);
}

/// All that is said until the other end closes; empty at once if it does not say why.
std::string said_until_the_end(int client) {
    std::string said;
    std::array<char, 256> bytes{};
    while (true) {
        const ssize_t count = ::recv(client, bytes.data(), bytes.size(), 0);
        if (count <= 0) return count == 0 ? said : said + " and a broken connection";
        said.append(bytes.data(), static_cast<std::size_t>(count));
    }
}

/// The line of an answer with this error.
std::string refusal_line(ExitCode exit, const Error& error) {
    return query_refused({exit, error}).dump() + "\n";
}

std::string too_long() {
    return refusal_line(ExitCode::usage, {.code = ErrorCode::limit_exceeded,
                                          .what = "a request has at most 49152 bytes, and this one has more",
                                          .remedy = "ask about parts of it"});
}

TEST_F(ControlSocketTest, refuses_a_request_without_end_and_goes_on) {
    serve([&] {
        const int client = connect();
        const std::string endless(64 << 10, 'a');
        (void)!::send(client, endless.data(), endless.size(), MSG_NOSIGNAL);
        EXPECT_EQ(said_until_the_end(client), too_long());
        ::close(client);
        EXPECT_TRUE(ask_daemon(file(), "still there"));
    });
    EXPECT_EQ(socket_->dropped(), 1U);
    EXPECT_EQ(asked_, 1);
}

// More than a socket has room for: who sends it all before it reads must be let finish.
TEST_F(ControlSocketTest, hears_a_long_request_out_before_it_closes) {
    serve([&] {
        const int client = connect();
        std::string request(1 << 20, 'a');
        request += "\nstatus\n";
        EXPECT_EQ(::send(client, request.data(), request.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(request.size()));
        EXPECT_EQ(said_until_the_end(client), too_long());
        ::close(client);
    });
    EXPECT_EQ(asked_, 0) << "what follows is not asked on a connection that is given up";
}

TEST_F(ControlSocketTest, takes_a_request_of_just_the_length_that_there_may_be) {
    const std::string longest(ControlSocket::kRequestMax, 'a');
    serve([&] {
        EXPECT_EQ(ask_daemon(file(), longest).value(), "you said " + longest);
        EXPECT_EQ(ask_daemon(file(), longest + "a").value() + "\n", too_long());
    });
    EXPECT_EQ(asked_, 1);
}

TEST_F(ControlSocketTest, is_not_stopped_by_clients_that_ask_and_never_read) {
    serve([&] {
        std::vector<int> clients;
        for (int i = 0; i < 4; ++i) {
            clients.push_back(connect());
            for (int k = 0; k < 40; ++k) (void)!::send(clients.back(), "large\n", 6, MSG_NOSIGNAL);
        }
        EXPECT_TRUE(ask_daemon(file(), "status"));
        for (const int client : clients) ::close(client);
    });
}

TEST_F(ControlSocketTest, takes_so_many_clients_and_no_more) {
    serve([&] {
        std::vector<int> clients;
        for (std::size_t i = 0; i < ControlSocket::kClientsMax + 4; ++i) clients.push_back(connect());
        std::this_thread::sleep_for(50ms);
        for (const int client : clients) ::close(client);
        std::this_thread::sleep_for(50ms);
        EXPECT_TRUE(ask_daemon(file(), "room again"));
    });
    EXPECT_EQ(socket_->dropped(), 4U);
}

std::string too_many() {
    return refusal_line(ExitCode::unavailable, {.code = ErrorCode::limit_exceeded,
                                                .what = "too many clients: 16 are served at once",
                                                .remedy = "ask again later"});
}

TEST_F(ControlSocketTest, refuses_who_comes_while_all_others_have_asked) {
    serve([&] {
        std::vector<int> clients;
        std::array<char, 64> bytes{};
        for (std::size_t i = 0; i < ControlSocket::kClientsMax; ++i) {
            clients.push_back(connect());
            EXPECT_EQ(::send(clients.back(), "a\n", 2, MSG_NOSIGNAL), 2);
            EXPECT_GT(::recv(clients.back(), bytes.data(), bytes.size(), 0), 0);
        }
        EXPECT_EQ(ask_daemon(file(), "status").value() + "\n", too_many());
        const int slow = connect();
        EXPECT_EQ(said_until_the_end(slow), too_many());
        EXPECT_EQ(::send(slow, "status\n", 7, MSG_NOSIGNAL), 7) << "let finish what it says";
        ::close(slow);
        // However many knock and stay.
        std::vector<int> knocking;
        for (std::size_t i = 0; i < 3 * ControlSocket::kRefusedMax; ++i) {
            knocking.push_back(connect());
            EXPECT_EQ(said_until_the_end(knocking.back()), too_many());
        }
        for (const int client : clients) {
            EXPECT_EQ(::send(client, "b\n", 2, MSG_NOSIGNAL), 2);
            EXPECT_GT(::recv(client, bytes.data(), bytes.size(), 0), 0) << "given up for another";
        }
        ::close(clients.back());
        clients.pop_back();
        EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status") << "room again";
        for (const int client : clients) ::close(client);
        for (const int client : knocking) ::close(client);
    });
}

TEST_F(ControlSocketTest, drops_the_one_that_was_silent_longest_for_a_new_one) {
    serve([&] {
        std::vector<int> clients;
        for (std::size_t i = 0; i < ControlSocket::kClientsMax; ++i) {
            clients.push_back(connect());
            std::this_thread::sleep_for(2ms);
        }
        EXPECT_TRUE(ask_daemon(file(), "status")) << "sixteen that say nothing keep everybody out";
        std::array<char, 8> bytes{};
        EXPECT_EQ(said_until_the_end(clients.front()), too_many());
        EXPECT_LT(::recv(clients.back(), bytes.data(), bytes.size(), MSG_DONTWAIT), 0);
        for (const int client : clients) ::close(client);
    });
    EXPECT_EQ(socket_->dropped(), 1U);
}

/// Another process that has so many connections on which it has sent this, and keeps them.
class OtherProcess {
  public:
    /// To be made before `serve`: what it forks has one thread.
    OtherProcess(const std::filesystem::path& file, int connections, std::string_view sends)
        : process_(::fork()) {
        if (process_ != 0) return;
        for (int i = 0; i < connections; ++i) {
            const auto connection = connect_unix_socket(file, SOCK_STREAM);
            if (!connection || ::send(*connection, sends.data(), sends.size(), MSG_NOSIGNAL) < 0) ::_exit(1);
        }
        while (true) ::pause();
    }
    ~OtherProcess() {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }
    OtherProcess(const OtherProcess&) = delete;
    OtherProcess& operator=(const OtherProcess&) = delete;

  private:
    pid_t process_;
};

TEST_F(ControlSocketTest, lets_in_who_comes_while_all_others_have_sent_half_a_request) {
    serve([&] {
        std::vector<int> clients;
        for (std::size_t i = 0; i < ControlSocket::kClientsMax; ++i) {
            clients.push_back(connect());
            EXPECT_EQ(::send(clients.back(), "sta", 3, MSG_NOSIGNAL), 3);
        }
        std::this_thread::sleep_for(20ms);
        const auto begun = std::chrono::steady_clock::now();
        EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
        EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
        EXPECT_EQ(said_until_the_end(clients.front()), too_many()) << "the one that came first";
        for (std::size_t i = 1; i < clients.size(); ++i) {
            EXPECT_EQ(::send(clients[i], "tus\n", 4, MSG_NOSIGNAL), 4);
            std::array<char, 16> bytes{};
            EXPECT_EQ(::recv(clients[i], bytes.data(), bytes.size(), 0), 16) << "one place was needed";
        }
        for (const int client : clients) ::close(client);
    });
    EXPECT_EQ(socket_->dropped(), 1U);
}

/// Whatever another one does that has hundreds of connections, one more than are let in at once.
TEST_F(ControlSocketTest, keeps_a_slow_client_beside_a_process_that_takes_all_places) {
    const int slow = connect();
    EXPECT_EQ(::send(slow, "sta", 3, MSG_NOSIGNAL), 3);
    const OtherProcess halves(file(), 300, "sta");
    serve([&] {
        auto slowest = std::chrono::steady_clock::duration::zero();
        for (int i = 0; i < 50; ++i) {
            const auto begun = std::chrono::steady_clock::now();
            EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
            slowest = std::max(slowest, std::chrono::steady_clock::now() - begun);
            std::this_thread::sleep_for(2ms);
        }
        EXPECT_LT(slowest, 1s);
        EXPECT_EQ(::send(slow, "tus\n", 4, MSG_NOSIGNAL), 4);
        std::array<char, 16> bytes{};
        EXPECT_EQ(::recv(slow, bytes.data(), bytes.size(), 0), 16);
    });
    ::close(slow);
    EXPECT_GE(socket_->dropped(), 300U - ControlSocket::kClientsMax);
}

TEST_F(ControlSocketTest, has_a_place_for_another_process_than_one_whose_questions_were_answered) {
    const OtherProcess answered(file(), 16, "status\n");
    serve([&] {
        std::this_thread::sleep_for(100ms);
        std::array<char, 16> bytes{};
        std::array<int, 3> late{};
        for (int& client : late) {
            client = connect();
            std::this_thread::sleep_for(10ms);  // let in before it says anything
        }
        for (const int client : late) {
            EXPECT_EQ(::send(client, "status\n", 7, MSG_NOSIGNAL), 7);
            EXPECT_EQ(::recv(client, bytes.data(), bytes.size(), 0), 16);
            ::close(client);
        }
        EXPECT_EQ(ask_daemon(file(), "status").value(), "you said status");
    });
    EXPECT_EQ(socket_->dropped(), 3U) << "so many places were needed at once";
}

/// What the rest of the process needs is not for clients: of 64 descriptors 24 are.
TEST_F(ControlSocketTest, takes_fewer_clients_of_fewer_descriptors) {
#ifdef OCTOSKIN_SANITIZED
    GTEST_SKIP() << "a sanitizer that looks at objects' types makes a pipe to do so";
#endif
    EXPECT_EQ(ControlSocket::clients_of_each_kind(0), 1U);
    EXPECT_EQ(ControlSocket::clients_of_each_kind(48), 2U);
    EXPECT_EQ(ControlSocket::clients_of_each_kind(64), 8U);
    EXPECT_EQ(ControlSocket::clients_of_each_kind(88), 16U);
    EXPECT_EQ(ControlSocket::clients_of_each_kind(RLIM_INFINITY), 16U);
    const int next = connect();
    ::close(next);
    if (next > 40) GTEST_SKIP() << "the tests before it left " << next << " descriptors open";
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
    const rlimit few{64, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    auto opened =
        ControlSocket::open(folder_ / "few", loop_, [](const std::string&) { return std::string("yes"); });
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    ASSERT_TRUE(opened);
    serve([&] {
        std::vector<int> clients;
        std::array<char, 128> bytes{};
        for (int i = 0; i < 9; ++i) {
            clients.push_back(*connect_unix_socket(folder_ / "few", SOCK_STREAM));
            EXPECT_EQ(::send(clients.back(), "a\n", 2, MSG_NOSIGNAL), 2);
            const auto count = ::recv(clients.back(), bytes.data(), bytes.size(), 0);
            const bool is_served = std::string_view(bytes.data(), static_cast<std::size_t>(count)) == "yes\n";
            EXPECT_EQ(is_served, i < 8) << i;
        }
        for (const int client : clients) ::close(client);
    });
}

/// The end of a daemon: what they hold is free, and nobody else has the name.
TEST_F(ControlSocketTest, closes_its_clients_before_it_goes) {
    std::vector<int> clients;
    for (int i = 0; i < 4; ++i) clients.push_back(connect());
    serve([&] { EXPECT_TRUE(ask_daemon(file(), "status")); });
    socket_->close_clients();
    for (const int client : clients) {
        std::array<char, 8> bytes{};
        EXPECT_EQ(::recv(client, bytes.data(), bytes.size(), MSG_DONTWAIT), 0);
        ::close(client);
    }
    EXPECT_TRUE(std::filesystem::exists(file()));
    EXPECT_FALSE(ControlSocket::open(file(), loop_, [](const std::string&) { return std::string(); }));
}

TEST_F(ControlSocketTest, drops_who_asks_nothing_and_keeps_who_does) {
    auto opened = ControlSocket::open(
        folder_ / "quick", loop_, [](const std::string&) { return std::string("yes"); }, 100ms);
    ASSERT_TRUE(opened);
    serve([&] {
        const int idle = *connect_unix_socket(folder_ / "quick", SOCK_STREAM);
        const int busy = *connect_unix_socket(folder_ / "quick", SOCK_STREAM);
        std::array<char, 8> bytes{};
        for (int i = 0; i < 8; ++i) {
            EXPECT_EQ(::send(busy, "ask\n", 4, MSG_NOSIGNAL), 4);
            EXPECT_EQ(::recv(busy, bytes.data(), bytes.size(), 0), 4);
            (void)::send(idle, "a", 1, MSG_NOSIGNAL);  // a line that never ends is no question
            std::this_thread::sleep_for(40ms);
        }
        EXPECT_LE(::recv(idle, bytes.data(), bytes.size(), 0), 0);
        ::close(idle);
        ::close(busy);
    });
    EXPECT_EQ((*opened)->dropped(), 1U);
}

/// New descriptors are refused while it lives; those that are there go on.
class NoDescriptors {
  public:
    NoDescriptors() {
        ::getrlimit(RLIMIT_NOFILE, &before_);
        const rlimit none{0, before_.rlim_max};
        ::setrlimit(RLIMIT_NOFILE, &none);
    }
    ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
    NoDescriptors(const NoDescriptors&) = delete;
    NoDescriptors& operator=(const NoDescriptors&) = delete;

  private:
    rlimit before_{};
};

TEST_F(ControlSocketTest, rests_without_descriptors_and_lets_in_who_waited) {
#ifdef OCTOSKIN_SANITIZED
    GTEST_SKIP() << "a sanitizer that looks at objects' types makes a pipe to do so";
#endif
    auto opened = ControlSocket::open(
        folder_ / "quick", loop_, [](const std::string&) { return std::string("yes"); }, 200ms);
    ASSERT_TRUE(opened);
    const int client = *connect_unix_socket(folder_ / "quick", SOCK_STREAM);
    ASSERT_EQ(::send(client, "ask\n", 4, MSG_NOSIGNAL), 4);
    std::optional<NoDescriptors> none(std::in_place);
    serve([&] {
        const std::clock_t before = std::clock();
        std::this_thread::sleep_for(500ms);
        const double busy_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
        EXPECT_LT(busy_s, 0.2) << "the loop turned all the time";
        none.reset();
        std::array<char, 8> bytes{};
        EXPECT_EQ(::recv(client, bytes.data(), bytes.size(), 0), 4);
        ::close(client);
    });
}

TEST_F(ControlSocketTest, is_one_at_a_place_and_takes_over_from_the_dead) {
    auto second = ControlSocket::open(file(), loop_, [](const std::string&) { return std::string(); });
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().error.file, file());
    EXPECT_NE(second.error().error.what.find("(process " + std::to_string(::getpid()) + ")"),
              std::string::npos)
        << second.error().message();
    EXPECT_NE(second.error().error.remedy.find("--socket"), std::string::npos) << second.error().message();
    socket_.reset();
    EXPECT_FALSE(std::filesystem::exists(file()));
    // As a killed one leaves it: a name, and nobody behind.
    const auto dead = bind_unix_socket(file(), SOCK_STREAM);
    ASSERT_TRUE(dead);
    ::close(dead->descriptor);
    EXPECT_TRUE(ControlSocket::open(file(), loop_, [](const std::string&) { return std::string(); }));
}

TEST_F(ControlSocketTest, takes_away_no_file_but_its_own) {
    std::filesystem::remove(file());
    auto second = ControlSocket::open(file(), loop_, [](const std::string&) { return std::string(); });
    ASSERT_TRUE(second) << second.error().message();
    socket_.reset();
    EXPECT_TRUE(connect_unix_socket(file(), SOCK_STREAM)) << "the name is the second's";
    std::filesystem::remove(file());
    folder_.write("control", "precious");
    second->reset();
    EXPECT_EQ(testing_support::ScratchFolder::read(file()), "precious");
}

}  // namespace
}  // namespace octoskin
