// What programs of this machine may send, and what nobody should.
#include "host/apps/daemon/joint_socket.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <list>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/sender_shares.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/socketcan/stamped_datagram.hpp"
#include "tests/support/bus/line_joints.hpp"
#include "tests/support/lingering_connection.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

/// A program that tells joint states, and waits while there is no room for one: 20 s at most. The kernel
/// keeps few of its datagrams, whatever net.unix.max_dgram_qlen is here.
class Teller {
  public:
    explicit Teller(const std::filesystem::path& file)
        : socket_(connect_unix_socket(file, SOCK_DGRAM).value()) {
        const int room = 1;  // raised by the kernel to the least there is
        const timeval patience{20, 0};
        EXPECT_EQ(::setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &room, sizeof(room)), 0);
        EXPECT_EQ(::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof(patience)), 0);
    }
    ~Teller() { ::close(socket_); }
    Teller(const Teller&) = delete;
    Teller& operator=(const Teller&) = delete;

    /// False if nobody made room.
    [[nodiscard]] bool tell(std::string_view text) const {
        return ::send(socket_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
    }
    /// The number of a sample is its first joint's position, in mrad.
    [[nodiscard]] bool tell(int number) const { return tell(fmt::format("{} 0 0", number * 1e-3)); }

  private:
    int socket_;
};

int number_of(const JointSample& sample) {
    return static_cast<int>(std::lround(sample.position.front() * 1e3));
}

class JointSocketTest : public testing::Test {
  protected:
    void send(std::string_view text) const {
        const auto sender = connect_unix_socket(file_, SOCK_DGRAM);
        ASSERT_TRUE(sender) << sender.error().message();
        EXPECT_EQ(::send(*sender, text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
        ::close(*sender);
    }
    static std::uint64_t faults(const JointSocket& socket, JointTextFault fault) {
        return socket.faults().at(static_cast<std::size_t>(fault));
    }

    testing_support::ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "joints";
    JointSocket socket_ = JointSocket::open(file_, testing_support::one_source(3)).value();
};

TEST_F(JointSocketTest, dates_a_sample_by_when_it_came_and_not_by_when_it_is_read) {
    const HostTime before = monotonic_now();
    send("1 2 3");
    const HostTime after = monotonic_now();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::optional<JointSample> sample;
    ASSERT_TRUE(socket_.receive(sample));
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->position, (std::vector<double>{1, 2, 3}));
    constexpr Nanoseconds kClocksApart{2'000'000};
    EXPECT_GT(sample->sampled, before - kClocksApart);
    EXPECT_LT(sample->sampled, after + kClocksApart);
    EXPECT_TRUE(monotonic_of(sample->came));
    EXPECT_FALSE(socket_.receive(sample)) << "there was one";
    EXPECT_FALSE(sample);
    EXPECT_EQ(socket_.samples(), 1U);
}

TEST_F(JointSocketTest, counts_what_is_no_sample_under_its_name_and_goes_on) {
    const std::pair<std::string, JointTextFault> wrong[] = {
        {"1 2 x", JointTextFault::not_a_number},
        {std::string("1 2 3\0", 6), JointTextFault::not_a_number},
        {"1 2", JointTextFault::wrong_count},
        {"", JointTextFault::wrong_count},
        {"1e9 1 2 3", JointTextFault::time_off},
        {"1 2 9", JointTextFault::too_large},
        {"1 2 3" + std::string(kJointTextMax, ' '), JointTextFault::too_long},
    };
    for (const auto& [text, fault] : wrong) {
        const std::uint64_t before = faults(socket_, fault);
        send(text);
        std::optional<JointSample> sample = JointSample{};
        EXPECT_TRUE(socket_.receive(sample)) << text;
        EXPECT_FALSE(sample) << text;
        EXPECT_EQ(faults(socket_, fault), before + 1) << text;
    }
    send("1 2 3");
    std::optional<JointSample> sample;
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_TRUE(sample);
    EXPECT_EQ(socket_.samples(), 1U);
}

TEST_F(JointSocketTest, lets_no_program_send_a_descriptor_along) {
    const int sender = connect_unix_socket(file_, SOCK_DGRAM).value();
    const bool can_refuse = test::can_refuse_descriptors(sender);
    if (can_refuse) {
        EXPECT_EQ(test::try_to_send_along(sender, "0.1 0.2 0.3", std::array{STDOUT_FILENO}), EPERM);
        send("0.1 0.2 0.3");
        std::optional<JointSample> sample;
        EXPECT_TRUE(socket_.receive(sample));
    }
    ::close(sender);
    if (!can_refuse) GTEST_SKIP() << "Linux before 6.16";
}

// Kept, they would be all that the process may have, some day.
TEST_F(JointSocketTest, keeps_no_descriptor_that_a_kernel_lets_through) {
    test::let_descriptors_through(file_);
    const auto descriptors = [] {
        const std::filesystem::directory_iterator open_now("/proc/self/fd");
        return std::distance(begin(open_now), end(open_now));
    };
    const auto before = descriptors();
    const int sender = connect_unix_socket(file_, SOCK_DGRAM).value();
    for (int i = 0; i < 10; ++i) {
        ASSERT_NO_FATAL_FAILURE(test::send_along(sender, "0.1 0.2 0.3", std::array{STDOUT_FILENO, sender}));
        std::optional<JointSample> sample;
        ASSERT_TRUE(socket_.receive(sample));
        EXPECT_TRUE(sample);
    }
    ::close(sender);
    EXPECT_EQ(descriptors(), before);
}

/// What is sent along is all in its queue before anything reads it: no other end of it is open then.
class DatagramFeedTest : public testing::Test {
  protected:
    DatagramFeedTest() : sender_(connect_unix_socket(file_, SOCK_DGRAM).value()) {
        EXPECT_TRUE(socketcan::want_stamps(socket_) && socketcan::want_senders(socket_));
        test::let_descriptors_through(file_);
    }
    ~DatagramFeedTest() override { ::close(sender_); }

    testing_support::ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "feed";
    int socket_ = bind_unix_socket(file_, SOCK_DGRAM).value().descriptor;
    int sender_;
};

TEST_F(DatagramFeedTest, reads_on_whatever_was_sent_along_and_however_long_that_lingers) {
    constexpr int kDatagrams = 5;
    constexpr int kBeside = 20;
    std::list<test::NestedConnection> nested;
    for (int i = 0; i < kDatagrams; ++i) {
        std::vector<int> sent;
        for (int j = 0; j < kBeside; ++j) sent.push_back(nested.emplace_back().release());
        ASSERT_NO_FATAL_FAILURE(test::send_along(sender_, "x", sent));
        for (const int descriptor : sent) ::close(descriptor);
    }
    ASSERT_EQ(::send(sender_, "last", 4, 0), 4);
    const auto begun = std::chrono::steady_clock::now();
    {
        DatagramFeed feed(socket_, 16);
        std::vector<std::string> taken;
        while (taken.size() < kDatagrams + 1 && std::chrono::steady_clock::now() < begun + 10s) {
            if (auto datagram = feed.take()) taken.push_back(datagram->bytes);
        }
        EXPECT_EQ(taken, (std::vector<std::string>{"x", "x", "x", "x", "x", "last"}));
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 1s);
}

TEST_F(JointSocketTest, keeps_the_senders_of_a_source_whose_place_in_the_rig_changes) {
    const auto source = [](const char* name) {
        return LineJoints::Source{.index = 0, .names = {name}, .rate_hz = 100.0, .turns = {}};
    };
    std::optional<JointSample> sample;
    socket_.expect({{source("rail"), source("finger")}});
    send("finger=0.1");
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_EQ(socket_.samples(1), 1U);
    socket_.expect({{source("finger"), source("lamp"), source("rail")}});
    EXPECT_EQ(socket_.samples(0), 1U);
    EXPECT_EQ(socket_.samples(1), 0U);
    EXPECT_EQ(socket_.samples(2), 0U);
}

TEST_F(JointSocketTest, takes_as_many_joints_as_the_rig_that_is_loaded_anew) {
    socket_.expect(testing_support::one_source(2));
    send("1 2 3");
    send("1 2");
    std::optional<JointSample> sample;
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_FALSE(sample) << "two joints and a time that is off";
    EXPECT_EQ(faults(socket_, JointTextFault::time_off), 1U);
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_TRUE(sample);
}

// 250 a second for 300 ms, and the loop is held up for as long as they take: not one waits for it.
TEST_F(JointSocketTest, loses_none_and_dates_each_while_the_loop_is_held_up) {
    constexpr std::size_t kCount = 75;
    constexpr auto kPeriod = 4ms;
    struct Told {
        HostTime before;
        HostTime after;
    };
    std::vector<Told> reported;
    std::vector<JointSample> samples;
    EventLoop loop;
    const HostTime end = monotonic_now() + Nanoseconds(30s);
    const EventSource joints = loop.on_readable(socket_.descriptor(), [&] {
        std::optional<JointSample> sample;
        while (socket_.receive(sample)) samples.push_back(sample.value());
        if (samples.size() == kCount) loop.stop(0);
    });
    const EventSource late = loop.every(1s, [&] {
        if (monotonic_now() > end) loop.stop(1);
    });
    bool was_held_up = false;
    const EventSource image = loop.every(1ms, [&] {
        if (std::exchange(was_held_up, true)) return;
        std::thread arm([&] {
            const Teller teller(file_);
            for (std::size_t i = 0; i < kCount; ++i) {
                const HostTime before = monotonic_now();
                if (!teller.tell(static_cast<int>(i))) return;
                reported.push_back({before, monotonic_now()});
                std::this_thread::sleep_for(kPeriod);
            }
        });
        arm.join();
        EXPECT_TRUE(samples.empty());
    });
    EXPECT_EQ(loop.run(), 0);
    ASSERT_EQ(reported.size(), kCount) << "it waited for the loop";
    ASSERT_EQ(samples.size(), kCount);
    constexpr Nanoseconds kClocksApart{2'000'000};
    for (std::size_t i = 0; i < kCount; ++i) {
        const JointSample& sample = samples.at(i);
        EXPECT_EQ(number_of(sample), static_cast<int>(i));
        EXPECT_GT(sample.sampled, reported.at(i).before - kClocksApart) << i;
        EXPECT_LT(sample.sampled, reported.at(i).after + kClocksApart) << i;
    }
    EXPECT_EQ(socket_.displaced(), 0U);
    EXPECT_EQ(socket_.samples(), kCount);
}

TEST_F(JointSocketTest, keeps_the_newest_of_a_flood_that_nobody_takes_and_counts_the_others) {
    constexpr int kBeyond = 500;
    constexpr int kCount = static_cast<int>(DatagramFeed::kWaitingMax) + kBeyond;
    const Teller teller(file_);
    for (int i = 0; i < kCount; ++i) ASSERT_TRUE(teller.tell(i)) << i;
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (socket_.displaced() < kBeyond && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(1ms);
    EXPECT_EQ(socket_.displaced(), kBeyond);
    std::optional<JointSample> sample;
    for (int i = kBeyond; i < kCount; ++i) {
        ASSERT_TRUE(socket_.receive(sample)) << i;
        EXPECT_EQ(number_of(sample.value()), i);
    }
    EXPECT_FALSE(socket_.receive(sample));
    EXPECT_EQ(socket_.samples(), DatagramFeed::kWaitingMax);
    EXPECT_EQ(socket_.displaced(), kBeyond);
}

/// A program of its own that sends so many without a pause, and ends.
class FloodingProgram {
  public:
    FloodingProgram(const std::filesystem::path& file, int count)
        : socket_(connect_unix_socket(file, SOCK_DGRAM).value()), process_(::fork()) {
        if (process_ != 0) return;
        constexpr std::string_view kText = "9 9 9";  // no sample: too large
        for (int i = 0; i < count; ++i) (void)!::send(socket_, kText.data(), kText.size(), MSG_NOSIGNAL);
        ::_exit(0);
    }
    ~FloodingProgram() {
        ::waitpid(process_, nullptr, 0);
        ::close(socket_);
    }
    FloodingProgram(const FloodingProgram&) = delete;
    FloodingProgram& operator=(const FloodingProgram&) = delete;

  private:
    int socket_;
    pid_t process_;
};

TEST_F(JointSocketTest, loses_none_of_a_driver_to_another_programs_flood_that_nobody_takes) {
    constexpr int kFlood = 5'000;
    constexpr int kSamples = 10;
    const Teller driver(file_);
    for (int i = 0; i < kSamples / 2; ++i) ASSERT_TRUE(driver.tell(i));
    const HostTime begin = monotonic_now();
    { const FloodingProgram flood(file_, kFlood); }
    for (int i = kSamples / 2; i < kSamples; ++i) ASSERT_TRUE(driver.tell(i));
    std::vector<int> numbers;
    std::optional<JointSample> sample;
    // Some may be on their way through the kernel still.
    for (const HostTime end = monotonic_now() + Nanoseconds(20s);
         monotonic_now() < end && numbers.size() < kSamples;)
        while (socket_.receive(sample))
            if (sample) numbers.push_back(number_of(*sample));
    std::vector<int> all(kSamples);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(numbers, all);
    EXPECT_EQ(socket_.samples(), kSamples);
    EXPECT_GE(socket_.displaced(), 1'000U) << "1024 of 2048 have room";
    // The longer it takes, as under a sanitizer, the more is within the program's share.
    const double took_s = std::chrono::duration<double>(monotonic_now() - begin).count();
    const double share = SenderShares::kAtOnce + SenderShares::kPerSecond * took_s;
    EXPECT_GE(static_cast<double>(socket_.surplus()), kFlood - share);
    EXPECT_EQ(faults(socket_, JointTextFault::too_large) + socket_.displaced() + socket_.surplus(), kFlood);
}

// Takes part of what the thread has read, part of what it has not: none is lost, twice here, or out of turn.
TEST_F(JointSocketTest, hands_over_each_once_and_in_turn_while_they_come) {
    constexpr int kCount = DatagramFeed::kWaitingMax;  // whoever has no time meanwhile has room for all
    std::atomic<bool> is_reported = false;
    std::thread arm([&] {
        const Teller teller(file_);
        for (int i = 0; i < kCount; ++i) EXPECT_TRUE(teller.tell(i)) << i;
        is_reported = true;
    });
    std::vector<int> numbers;
    std::optional<JointSample> sample;
    for (bool is_last = false; !is_last;) {
        is_last = is_reported;  // read before the socket: what is not there after that does not come any more
        while (socket_.receive(sample)) numbers.push_back(number_of(sample.value()));
    }
    arm.join();
    std::vector<int> all(kCount);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(numbers, all);
    EXPECT_EQ(socket_.displaced(), 0U);
}

TEST_F(JointSocketTest, is_readable_while_something_waits_and_only_then) {
    const auto is_readable = [this](int patience_ms) {
        pollfd watched{socket_.descriptor(), POLLIN, 0};
        return ::poll(&watched, 1, patience_ms) == 1;
    };
    constexpr int kPatienceMs = 20'000;
    EXPECT_FALSE(is_readable(0));
    const Teller teller(file_);
    for (int round = 0; round < 2; ++round) {
        ASSERT_TRUE(teller.tell("1 2 3"));
        ASSERT_TRUE(teller.tell("no numbers"));
        std::optional<JointSample> sample;
        ASSERT_TRUE(is_readable(kPatienceMs));
        EXPECT_TRUE(socket_.receive(sample));
        EXPECT_TRUE(is_readable(kPatienceMs)) << "what is no sample is counted in time, too";
        EXPECT_TRUE(socket_.receive(sample));
        EXPECT_FALSE(is_readable(0));
    }
}

TEST_F(JointSocketTest, ends_at_once_in_the_middle_of_a_flood) {
    std::atomic<bool> is_reported = false;
    std::thread arm([&] {
        const Teller teller(file_);
        while (teller.tell("1 2 3")) is_reported = true;
    });
    while (!is_reported) std::this_thread::sleep_for(1ms);
    const auto begun = std::chrono::steady_clock::now();
    { const JointSocket ending = std::move(socket_); }
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    arm.join();  // nobody has its name any more
}

TEST_F(JointSocketTest, without_room_for_its_thread_is_short_of_a_resource_and_leaves_no_file) {
    pthread_attr_t before;
    ASSERT_EQ(::pthread_getattr_default_np(&before), 0);
    pthread_attr_t huge;
    ASSERT_EQ(::pthread_getattr_default_np(&huge), 0);
    ASSERT_EQ(::pthread_attr_setstacksize(&huge, std::size_t{1} << 47U), 0);
    ASSERT_EQ(::pthread_setattr_default_np(&huge), 0);
    const auto opened = JointSocket::open(folder_ / "other", testing_support::one_source(3));
    ASSERT_EQ(::pthread_setattr_default_np(&before), 0);
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().exit, ExitCode::no_resources);
    EXPECT_EQ(opened.error().error.code, ErrorCode::no_resources);
    EXPECT_EQ(opened.error().error.file, folder_ / "other");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "other"));
}

TEST_F(JointSocketTest, is_one_to_a_file_and_takes_its_file_away) {
    EXPECT_FALSE(JointSocket::open(file_, testing_support::one_source(3))) << "somebody listens";
    {
        const JointSocket moved = std::move(socket_);
        EXPECT_TRUE(std::filesystem::exists(file_));
    }
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(JointSocketTest, takes_away_no_file_but_its_own) {
    std::filesystem::remove(file_);
    auto second = JointSocket::open(file_, testing_support::one_source(3));
    ASSERT_TRUE(second) << second.error().message();
    { const JointSocket moved = std::move(socket_); }
    EXPECT_TRUE(connect_unix_socket(file_, SOCK_DGRAM)) << "the name is the second's";
    std::filesystem::remove(file_);
    folder_.write(file_.filename().string(), "precious");
    { const JointSocket moved = *std::move(second); }
    EXPECT_EQ(testing_support::ScratchFolder::read(file_), "precious");
}

}  // namespace
}  // namespace octoskin
