#include "host/apps/playback/onto_bus.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/io/candump/log_line.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Frames of every kind: classical of each length, remote, extended, FD of each length with and without BRS.
std::vector<std::string> every_kind() {
    std::vector<std::string> lines;
    const std::string bytes =
        "00112233445566778899AABBCCDDEEFF00112233445566778899AABBCCDDEEFF"
        "00112233445566778899AABBCCDDEEFF00112233445566778899AABBCCDDEEFF";
    const auto add = [&lines](const std::string& frame) {
        lines.push_back("(1750000000.000000) can7 " + frame);
    };
    for (std::size_t length = 0; length <= 8; ++length) add("123#" + bytes.substr(0, 2 * length));
    for (const std::size_t length : {0U, 1U, 8U, 12U, 16U, 20U, 24U, 32U, 48U, 64U}) {
        add("7FF##0" + bytes.substr(0, 2 * length));
        add("001##1" + bytes.substr(0, 2 * length));
    }
    add("044#R4");
    add("1ABCDEF0#DEADBEEF");
    return lines;
}

class OntoBusTest : public testing::Test {
  protected:
    OntoBusTest() {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
        socket_.emplace("fd:9", ends[0]);
        bus_.emplace("bus", ends[1]);
    }
    Result<OntoBus, AppError> play(const std::vector<std::string>& lines, Pace pace = {}) {
        std::string text;
        for (const std::string& line : lines) text += line + '\n';
        return play_onto(folder_.write("can.log", text), *socket_, std::move(pace));
    }
    std::vector<wire::CanFrame> heard() {
        std::vector<wire::CanFrame> frames;
        while (true) {
            const auto received = bus_->receive();
            if (!received || !received->has_value()) return frames;
            frames.push_back((*received)->entry.frame);
        }
    }
    testing_support::ScratchFolder folder_;
    std::optional<socketcan::CanSocket> socket_;
    std::optional<socketcan::CanSocket> bus_;
};

TEST_F(OntoBusTest, sends_frames_of_every_kind_as_they_are) {
    const auto lines = every_kind();
    const auto played = play(lines);
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_EQ(played->sent, lines.size());
    const auto frames = heard();
    ASSERT_EQ(frames.size(), lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i)
        EXPECT_EQ(frames[i], candump::parse_line(lines[i])->frame) << lines[i];
}

TEST_F(OntoBusTest, keeps_the_gaps_at_the_speed_asked_for) {
    const auto begin = Clock::now();
    std::vector<Clock::duration> came;
    std::thread listener([&] {
        while (came.size() < 3 && Clock::now() - begin < 10s) {
            const auto received = bus_->receive();
            if (received && received->has_value()) came.push_back(Clock::now() - begin);
            std::this_thread::sleep_for(200us);
        }
    });
    const auto played = play(
        {"(1750000000.000000) can0 001#", "(1750000000.600000) can0 002#", "(1750000001.000000) can0 003#"},
        Pace::times(4.0));
    listener.join();
    ASSERT_TRUE(played);
    ASSERT_EQ(came.size(), 3U);
    // 150 and 250 ms after the first, which may itself be late: a busy machine never makes one early.
    EXPECT_GE(came[1], 150ms);
    EXPECT_GE(came[2], 250ms);
    EXPECT_LT(came[2] - came[0], 900ms) << "real time in place of four times as fast";
}

TEST_F(OntoBusTest, leaves_out_and_counts_what_is_no_frame_of_the_first_interface) {
    const auto played = play({"# a remark", "(1750000000.000000) can0 001#", "(1750000000.000000) can1 002#",
                              "(1750000000.000000) can0 20000004#0000000000000000"});
    ASSERT_TRUE(played);
    EXPECT_EQ(played->sent, 1U);
    EXPECT_EQ(played->interface, "can0");
    EXPECT_EQ(played->other_interface, 1U);
    EXPECT_EQ(played->error_frames, 1U);
    EXPECT_EQ(played->lines_refused, 1U);
    EXPECT_EQ(heard().size(), 1U);
}

TEST_F(OntoBusTest, says_that_the_other_end_is_gone_and_that_a_log_has_no_frame) {
    const auto empty = play({"nothing"});
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().exit, ExitCode::bad_data);
    EXPECT_EQ(empty.error().error.code, ErrorCode::foreign_format);
    EXPECT_EQ(empty.error().error.file, folder_ / "can.log");
    EXPECT_EQ(empty.error().error.line, 1);
    bus_.reset();
    const auto gone = play({"(1750000000.000000) can0 001#"});
    ASSERT_FALSE(gone);
    EXPECT_EQ(gone.error().exit, ExitCode::io_failed);
    EXPECT_EQ(gone.error().error.code, ErrorCode::no_device);
    EXPECT_EQ(gone.error().error.file, "fd:9");
}

}  // namespace
}  // namespace octoskin
