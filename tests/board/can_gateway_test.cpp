// The simulated bus tied to an interface, over a socketpair that carries frames as the kernel lays them out.
// A real interface is for a machine that has one.
#include "host/lab/octoskin_board/can_gateway.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <system_error>
#include <vector>

namespace octoskin::board {
namespace {

class CanGatewayTest : public testing::Test {
  protected:
    CanGatewayTest() {
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, ends.data()) != 0)
            throw std::system_error(errno, std::generic_category());
        gateway_.emplace(socketcan::CanSocket("can7", ends[0]), bus_);
        outside_.emplace("outside", ends[1]);
        board_ = &bus_.attach([this](const wire::CanFrame& frame, sim::SimTime) { heard_.push_back(frame); });
    }
    void run_for(std::int64_t us) {
        for (std::int64_t i = 0; i < us / 50; ++i) {
            now_.us += 50;
            bus_.advance(now_);
            if (is_well_) is_well_ = gateway_->poll().has_value();
        }
    }
    std::vector<wire::CanFrame> seen_outside() {
        std::vector<wire::CanFrame> all;
        while (true) {
            const auto received = outside_->receive();
            if (!received || !*received) return all;
            all.push_back((*received)->entry.frame);
        }
    }
    static wire::CanFrame frame_of(std::uint32_t id, std::uint8_t length, bool is_fd = false) {
        wire::CanFrame frame{
            .can_id = id, .is_fd = is_fd, .has_bit_rate_switch = is_fd, .payload_len = length};
        for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(id + i);
        return frame;
    }

    sim::SimulatedCanBus bus_{{.nominal = 1'000'000, .data = 5'000'000}};
    std::optional<CanGateway> gateway_;
    std::optional<socketcan::CanSocket> outside_;
    node::CanTransmitter* board_ = nullptr;
    std::vector<wire::CanFrame> heard_;
    sim::SimTime now_{};
    bool is_well_ = true;
};

TEST_F(CanGatewayTest, sends_out_what_the_board_says_and_lets_it_hear_what_comes_in_once_each) {
    const auto classical = frame_of(0x145, 8);
    const auto fd = frame_of(0x245, 64, true);
    const auto sync = frame_of(0x040, 3);
    ASSERT_TRUE(board_->send(classical));
    ASSERT_TRUE(board_->send(fd));
    run_for(2'000);
    EXPECT_EQ(seen_outside(), (std::vector{classical, fd}));
    EXPECT_TRUE(heard_.empty());
    ASSERT_TRUE(outside_->send(sync));
    run_for(2'000);
    EXPECT_EQ(heard_, std::vector{sync});
    EXPECT_TRUE(seen_outside().empty()) << "it does not go back where it came from";
    EXPECT_EQ(gateway_->counts().sent, 2U);
    EXPECT_EQ(gateway_->counts().received, 1U);
    EXPECT_EQ(gateway_->counts().not_sent + gateway_->counts().not_received, 0U);
    EXPECT_TRUE(is_well_);
}

TEST_F(CanGatewayTest, counts_what_a_flood_leaves_no_room_for) {
    std::uint64_t given = 0;
    for (int i = 0; i < 150; ++i) {
        const auto sent = outside_->send(frame_of(0x700, 8));
        if (sent && *sent) ++given;
    }
    ASSERT_GT(given, 100U);
    run_for(200'000);
    EXPECT_EQ(gateway_->counts().received + gateway_->counts().not_received, given);
    EXPECT_EQ(heard_.size(), gateway_->counts().received);
    EXPECT_GT(gateway_->counts().not_received, 0U);
}

TEST_F(CanGatewayTest, ends_when_the_other_side_is_gone) {
    outside_.reset();
    run_for(1'000);
    ASSERT_TRUE(board_->send(frame_of(0x145, 8)));
    run_for(2'000);
    EXPECT_FALSE(is_well_);
    EXPECT_EQ(gateway_->counts().sent, 0U);
}

TEST(OpenInterface, names_one_that_is_not_there) {
    const auto socket = open_interface("nocan7");
    ASSERT_FALSE(socket);
    EXPECT_EQ(socket.error().error.file, "nocan7");
    EXPECT_TRUE(socket.error().exit == ExitCode::unavailable ||
                socket.error().exit == ExitCode::no_permission);
}

}  // namespace
}  // namespace octoskin::board
