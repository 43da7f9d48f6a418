// Nothing that a program sends along is taken, and nothing of it is waited for.
#include "host/io/socketcan/passed_descriptors.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include "host/io/socketcan/can_socket.hpp"
#include "host/io/socketcan/short_waits.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"
#include "tests/support/lingering_connection.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::socketcan {
namespace {

using namespace std::chrono_literals;

/// So long nothing that does not wait for one of them takes; each lingers for 20 s.
constexpr std::chrono::milliseconds kSoon{1000};

template <class Call>
std::chrono::milliseconds time_of(Call call) {
    const auto begun = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begun);
}

std::ptrdiff_t open_descriptors() {
    const std::filesystem::directory_iterator open_now("/proc/self/fd");
    return std::distance(begin(open_now), end(open_now));
}

class PassedDescriptorsTest : public testing::Test {
  protected:
    ~PassedDescriptorsTest() override {
        for (const int end : ends_)
            if (end >= 0) ::close(end);
    }
    void make_pair(int type) {
        ASSERT_EQ(::socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends_.data()), 0);
        if (type == SOCK_STREAM) return;
        ASSERT_TRUE(want_stamps(ends_[1]) && want_senders(ends_[1]));
    }
    void send_lingering(std::size_t count, int flags = 0) {
        std::vector<int> sent;
        for (std::size_t i = 0; i < count; ++i) sent.push_back(lingering_.emplace_back().release());
        ASSERT_NO_FATAL_FAILURE(test::send_along(ends_[0], "x", sent, flags));
        for (const int descriptor : sent) ::close(descriptor);
    }
    void close(int& end) { ::close(std::exchange(end, -1)); }

    std::array<int, 2> ends_{-1, -1};
    std::list<test::LingeringConnection> lingering_;
};

TEST_F(PassedDescriptorsTest, drops_all_that_a_datagram_may_have_beside_it_and_waits_for_none) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_DGRAM));
    ASSERT_NO_FATAL_FAILURE(send_lingering(250));
    const std::ptrdiff_t before = open_descriptors();
    std::array<std::byte, 8> bytes{};
    StampedDatagram received;
    const auto taken = time_of([&] {
        EXPECT_TRUE(has_descriptors_beside(ends_[1]));
        EXPECT_TRUE(has_descriptors_beside(ends_[1])) << "it stays there";
        const ShortWaits none_long;
        received = receive_stamped(ends_[1], bytes);
    });
    EXPECT_LT(taken, kSoon);
    EXPECT_EQ(received.count, 1);
    EXPECT_NE(received.flags & MSG_CTRUNC, 0);
    EXPECT_TRUE(received.stamp && received.sender);
    EXPECT_EQ(open_descriptors(), before);
    RecordProperty("taken_ms", static_cast<int>(taken.count()));
}

TEST_F(PassedDescriptorsTest, says_of_a_datagram_without_that_it_has_none) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_DGRAM));
    EXPECT_FALSE(has_descriptors_beside(ends_[1])) << "there is none";
    ASSERT_EQ(::send(ends_[0], "x", 1, 0), 1);
    EXPECT_FALSE(has_descriptors_beside(ends_[1]));
}

// In a thread that signals are kept from, as those of the daemon are.
TEST_F(PassedDescriptorsTest, waits_for_none_in_a_thread_without_signals) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    ASSERT_NO_FATAL_FAILURE(send_lingering(3));
    std::thread quiet([&] {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, nullptr);
        std::array<char, 8> bytes{};
        EXPECT_LT(time_of([&] { EXPECT_EQ(receive_text(ends_[1], bytes), 1); }), kSoon);
        sigset_t after;
        pthread_sigmask(SIG_SETMASK, nullptr, &after);
        EXPECT_EQ(sigismember(&after, ShortWaits::signal()), 1);
    });
    quiet.join();
}

// It is not read as text: what is read instead drops it.
TEST_F(PassedDescriptorsTest, waits_for_none_beside_a_byte_that_is_out_of_band) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    test::LingeringConnection one;
    const int descriptor = one.release();
    if (test::try_to_send_along(ends_[0], "x", std::array{descriptor}, MSG_OOB) != 0) {
        lingering_.clear();
        one.end();
        ::close(descriptor);
        GTEST_SKIP() << "no such bytes here";
    }
    ::close(descriptor);
    ASSERT_EQ(::send(ends_[0], "y", 1, 0), 1);
    std::array<char, 8> bytes{};
    EXPECT_LT(time_of([&] { EXPECT_EQ(receive_text(ends_[1], bytes), 1); }), kSoon);
}

TEST_F(PassedDescriptorsTest, waits_for_none_that_is_read_and_thrown_away) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    for (int i = 0; i < 5; ++i) ASSERT_NO_FATAL_FAILURE(send_lingering(2));
    EXPECT_LT(time_of([&] { read_the_rest(ends_[1]); }), kSoon);
    std::array<char, 8> bytes{};
    EXPECT_LT(receive_text(ends_[1], bytes), 0) << "none is left";
}

TEST_F(PassedDescriptorsTest, closes_a_connection_with_what_was_not_read_and_waits_for_none) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    for (int i = 0; i < 3; ++i) ASSERT_NO_FATAL_FAILURE(send_lingering(50));
    close(ends_[0]);
    EXPECT_LT(time_of([&] { close_socket(std::exchange(ends_[1], -1)); }), kSoon);
}

// Such a connection cannot take its SO_LINGER from it: it is another one's, which is in none's hands.
TEST_F(PassedDescriptorsTest, waits_for_none_in_another_connection) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    std::list<test::NestedConnection> nested;
    for (int i = 0; i < 6; ++i) ASSERT_NO_FATAL_FAILURE(nested.emplace_back().send_along(ends_[0], "x"));
    std::array<char, 8> bytes{};
    EXPECT_LT(time_of([&] {
                  for (int i = 0; i < 6; ++i) EXPECT_EQ(receive_text(ends_[1], bytes), 1);
              }),
              kSoon);
}

TEST_F(PassedDescriptorsTest, disturbs_no_call_behind_it) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_STREAM));
    std::array<char, 8> bytes{};
    for (int i = 0; i < 100; ++i) EXPECT_LT(receive_text(ends_[1], bytes), 0);
    { const ShortWaits none_long; }
    EXPECT_EQ(::poll(nullptr, 0, 50), 0) << std::strerror(errno);
    const ShortWaits none_long;
    EXPECT_EQ(::poll(nullptr, 0, 2000), -1) << "within one it is ended early";
    EXPECT_EQ(errno, EINTR);
}

TEST_F(PassedDescriptorsTest, refuses_them_to_their_sender_where_the_kernel_can) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_DGRAM));
    if (!test::can_refuse_descriptors(ends_[1])) GTEST_SKIP() << "Linux before 6.16";
    refuse_descriptors(ends_[1]);
    EXPECT_EQ(test::try_to_send_along(ends_[0], "x", std::array{STDERR_FILENO}), EPERM);
    EXPECT_EQ(::send(ends_[0], "x", 1, 0), 1);
}

TEST_F(PassedDescriptorsTest, takes_none_from_a_bus_whose_other_end_sends_them) {
    ASSERT_NO_FATAL_FAILURE(make_pair(SOCK_SEQPACKET));
    const int other_end = ends_[0];
    CanSocket bus("fd:3", std::exchange(ends_[1], -1));
    if (test::can_refuse_descriptors(bus.descriptor())) {
        EXPECT_EQ(test::try_to_send_along(other_end, "x", std::array{STDERR_FILENO}), EPERM);
        const int yes = 1;
        ASSERT_EQ(::setsockopt(bus.descriptor(), SOL_SOCKET, test::kPassRights, &yes, sizeof(yes)), 0);
    }
    const std::ptrdiff_t before = open_descriptors();
    ASSERT_NO_FATAL_FAILURE(test::send_along(other_end, "x", std::array{STDERR_FILENO, STDOUT_FILENO}));
    EXPECT_FALSE(bus.receive().value());
    EXPECT_EQ(bus.malformed(), 1U);
    EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace octoskin::socketcan
