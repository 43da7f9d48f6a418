// What programs of this machine may send, and what nobody should.
#include "host/apps/daemon/joint_socket.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

class JointSocketTest : public testing::Test {
  protected:
    void send(std::string_view text) const {
        const auto sender = connect_unix_socket(file_, SOCK_DGRAM);
        ASSERT_TRUE(sender) << sender.error().message;
        EXPECT_EQ(::send(*sender, text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
        ::close(*sender);
    }
    static std::uint64_t faults(const JointSocket& socket, JointTextFault fault) {
        return socket.faults().at(static_cast<std::size_t>(fault));
    }

    testing_support::ScratchFolder folder_;
    std::filesystem::path file_ = folder_ / "joints";
    JointSocket socket_ = JointSocket::open(file_, 3).value();
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

TEST_F(JointSocketTest, takes_as_many_joints_as_the_rig_that_is_loaded_anew) {
    socket_.expect(2);
    send("1 2 3");
    send("1 2");
    std::optional<JointSample> sample;
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_FALSE(sample) << "two joints and a time that is off";
    EXPECT_EQ(faults(socket_, JointTextFault::time_off), 1U);
    EXPECT_TRUE(socket_.receive(sample));
    EXPECT_TRUE(sample);
}

TEST_F(JointSocketTest, is_one_to_a_file_and_takes_its_file_away) {
    EXPECT_FALSE(JointSocket::open(file_, 3)) << "somebody listens";
    {
        const JointSocket moved = std::move(socket_);
        EXPECT_TRUE(std::filesystem::exists(file_));
    }
    EXPECT_FALSE(std::filesystem::exists(file_));
}

}  // namespace
}  // namespace octoskin
