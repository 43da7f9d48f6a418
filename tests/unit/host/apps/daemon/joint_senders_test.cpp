// Who is heard, for how long, and what the kernel tells of a process that sends joint states.
#include "host/apps/daemon/joint_senders.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/daemon/joint_socket.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "tests/support/bus/line_joints.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

HostTime at_ms(std::int64_t ms) {
    return HostTime{ms * 1'000'000};
}
const JointSender kDriver{4'000'001, 1000, ""};  // no process has this number
const JointSender kOther{4'000'002, 1000, ""};

TEST(JointSenders, are_several_until_all_but_one_were_silent_for_a_second) {
    JointSenders senders;
    EXPECT_FALSE(senders.are_several(at_ms(0)));
    senders.hear(kDriver, at_ms(0));
    senders.hear(kDriver, at_ms(10));
    EXPECT_FALSE(senders.are_several(at_ms(10)));
    senders.hear(kOther, at_ms(15));
    EXPECT_TRUE(senders.are_several(at_ms(15)));
    for (int ms = 20; ms < 2'000; ms += 10) {
        senders.hear(kDriver, at_ms(ms));
        EXPECT_EQ(senders.are_several(at_ms(ms)), ms < 1'015) << ms;
    }
    EXPECT_EQ(senders.several_at(), at_ms(1'010));
    ASSERT_EQ(senders.newest_several().size(), 2U);
    EXPECT_EQ(senders.newest_several()[0].sender, kDriver);
    EXPECT_EQ(senders.newest_several()[1].sender, kOther);
    EXPECT_EQ(senders.newest_several()[1].samples, 1U);
}

// As a driver does that is started anew: it costs a second.
TEST(JointSenders, of_which_one_takes_the_others_place_are_several_for_a_second) {
    JointSenders senders;
    for (int ms = 0; ms <= 500; ms += 10) senders.hear(kDriver, at_ms(ms));
    for (int ms = 700; ms < 3'000; ms += 10) {
        senders.hear(kOther, at_ms(ms));
        EXPECT_EQ(senders.are_several(at_ms(ms)), ms < 1'500) << ms;
    }
}

TEST(JointSenders, that_cannot_be_seen_are_one) {
    JointSenders senders;
    senders.hear({}, at_ms(0));
    senders.hear({}, at_ms(10));
    EXPECT_FALSE(senders.are_several(at_ms(10)));
    senders.hear({0, 0, "@bound"}, at_ms(20));
    EXPECT_TRUE(senders.are_several(at_ms(20))) << "but for their addresses";
}

TEST(JointSenders, are_told_by_process_program_user_and_address) {
    EXPECT_EQ(describe(JointSender{4711, 1000, ""}, "python3"), "process 4711 (python3, user 1000)");
    EXPECT_EQ(describe(JointSender{4711, 0, "/run/driver"}, ""), "process 4711 (user 0) at /run/driver");
    EXPECT_EQ(describe(JointSender{}, ""), "a process that is not visible from here");
}

TEST(JointSenders, keep_no_more_than_a_few_of_a_flood_of_processes) {
    JointSenders senders;
    for (int i = 1; i < 1'000; ++i) senders.hear({4'000'000 + i, 1000, ""}, at_ms(i));
    EXPECT_TRUE(senders.are_several(at_ms(1'000)));
    EXPECT_EQ(senders.heard(at_ms(1'000)).size(), JointSenders::kKept);
}

class JointSocketSenders : public testing::Test {
  protected:
    /// From a process of its own, whose number is returned.
    [[nodiscard]] pid_t send_from_another(const char* text) const {
        const std::vector<pid_t> one = send_at_once_from(1, text);
        expect_end_of(one);
        return one.front();
    }
    /// From so many processes, which send once all have begun. Their datagrams are to be received before
    /// their end is waited for: the kernel keeps only some.
    [[nodiscard]] std::vector<pid_t> send_at_once_from(std::size_t count, const char* text) const {
        std::array<int, 2> start{};
        EXPECT_EQ(::pipe2(start.data(), O_CLOEXEC), 0);
        std::vector<pid_t> programs;
        while (programs.size() < count) {
            const pid_t child = ::fork();
            if (child == 0) {
                ::close(start[1]);
                char byte = 0;
                const bool is_started = ::read(start[0], &byte, 1) == 0;
                const auto sender = connect_unix_socket(file_, SOCK_DGRAM);
                const bool is_sent = sender && ::send(*sender, text, std::strlen(text), 0) > 0;
                ::_exit(is_started && is_sent ? 0 : 1);
            }
            programs.push_back(child);
        }
        for (const int end : start) ::close(end);
        return programs;
    }
    static void expect_end_of(const std::vector<pid_t>& programs) {
        for (const pid_t program : programs) {
            int outcome = -1;
            EXPECT_EQ(::waitpid(program, &outcome, 0), program);
            EXPECT_EQ(outcome, 0);
        }
    }
    void send(const char* text) const {
        const auto sender = connect_unix_socket(file_, SOCK_DGRAM);
        ASSERT_TRUE(sender);
        EXPECT_GT(::send(*sender, text, std::strlen(text), 0), 0);
        ::close(*sender);
    }
    [[nodiscard]] JointSample receive() {
        std::optional<JointSample> sample;
        EXPECT_TRUE(socket_.receive(sample));
        return sample.value_or(JointSample{});
    }

    testing_support::ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "joints";
    JointSocket socket_ = JointSocket::open(file_, testing_support::one_source(3)).value();
};

TEST_F(JointSocketSenders, are_told_apart_by_what_the_kernel_says_of_them) {
    send("1 2 3");
    EXPECT_FALSE(receive().is_of_several);
    send("1 2 3");
    EXPECT_FALSE(receive().is_of_several) << "another socket of the same process";
    const pid_t other = send_from_another("0.5 0.5 0.5");
    EXPECT_TRUE(receive().is_of_several);
    send("1 2 3");
    EXPECT_TRUE(receive().is_of_several) << "neither is used";
    const auto& heard = socket_.senders(0).newest_several();
    ASSERT_EQ(heard.size(), 2U);
    EXPECT_EQ(heard[0].sender.pid, ::getpid());
    EXPECT_EQ(heard[0].sender.uid, ::getuid());
    EXPECT_EQ(heard[0].samples, 3U);
    EXPECT_NE(heard[0].program, "");
    EXPECT_EQ(heard[1].sender.pid, other);
}

TEST_F(JointSocketSenders, that_send_no_sample_are_not_heard) {
    send("1 2 3");
    EXPECT_FALSE(receive().is_of_several);
    (void)send_from_another("half a turn");
    std::optional<JointSample> sample;
    EXPECT_TRUE(socket_.receive(sample));
    send("1 2 3");
    EXPECT_FALSE(receive().is_of_several);
}

// All send within a moment, however long it takes to start them: a share is a second's.
TEST_F(JointSocketSenders, that_send_no_sample_keep_no_driver_out_however_many_they_are) {
    const auto programs = send_at_once_from(2 * SenderShares::kSendersMax, "x");
    std::optional<JointSample> sample;
    for (std::size_t i = 0; i < programs.size(); ++i) {
        pollfd readable{socket_.descriptor(), POLLIN, 0};
        constexpr int kLongMs = 10'000;
        ASSERT_EQ(::poll(&readable, 1, kLongMs), 1);
        EXPECT_TRUE(socket_.receive(sample));
    }
    expect_end_of(programs);
    ASSERT_TRUE(socket_.newest_refused());
    EXPECT_EQ(std::ranges::count(programs, socket_.newest_refused()->pid), 1);
    send("1 2 3");
    EXPECT_EQ(receive().position.size(), 3U);
    EXPECT_EQ(socket_.surplus(), 0U);
}

TEST_F(JointSocketSenders, of_one_process_are_told_apart_by_the_addresses_that_they_bind) {
    for (const char* const name : {"one", "two"}) {
        const int sender = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        sockaddr_un mine{};
        mine.sun_family = AF_UNIX;
        std::strcpy(mine.sun_path, (folder_ / name).c_str());
        ASSERT_EQ(::bind(sender, reinterpret_cast<const sockaddr*>(&mine), sizeof(mine)), 0);
        sockaddr_un daemon{};
        daemon.sun_family = AF_UNIX;
        std::strcpy(daemon.sun_path, file_.c_str());
        ASSERT_GT(::sendto(sender, "1 2 3", 5, 0, reinterpret_cast<const sockaddr*>(&daemon), sizeof(daemon)),
                  0);
        ::close(sender);
        EXPECT_EQ(receive().is_of_several, name == std::string("two"));
    }
    EXPECT_EQ(socket_.senders(0).newest_several()[1].sender.address, (folder_ / "two").string());
}

}  // namespace
}  // namespace octoskin
