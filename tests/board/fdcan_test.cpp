// The CAN controller on a bus with partners, without them, and on a broken one.
#include <gmock/gmock.h>

#include "hw/sim/stm32g474/board_on_bus.hpp"
#include "tests/board/tiny_board.hpp"

namespace octoskin::sim::stm32 {
namespace {

using testing::ElementsAre;

wire::CanFrame frame_of(std::uint32_t id, std::uint8_t length, std::uint8_t first, bool is_fd = false) {
    wire::CanFrame frame{.can_id = id, .is_fd = is_fd, .payload_len = length};
    for (std::uint8_t i = 0; i < length; ++i) frame.data[i] = static_cast<std::uint8_t>(first + i);
    return frame;
}

class FdcanTest : public testing::Test {
  protected:
    FdcanTest() {
        bus_.tap([this](const wire::CanFrame& frame, SimTime end) {
            heard_.push_back(frame);
            ends_.push_back(end.us);
        });
    }
    bool run(std::uint32_t stage = 1) {
        const std::int64_t limit = now_ + 500'000;
        while (tiny_.state() != stage && now_ < limit) on_bus_.run_until({now_ += 100});
        return tiny_.state() == stage;
    }

    TinyBoard tiny_{"can_traffic"};
    SimulatedCanBus bus_{{1'000'000, 5'000'000}};
    BoardOnBus on_bus_{tiny_.board(), bus_};
    std::vector<wire::CanFrame> heard_;
    std::vector<std::int64_t> ends_;
    std::int64_t now_ = 0;
};

TEST_F(FdcanTest, sends_classical_and_fd_frames_in_the_order_given) {
    tiny_.jump("transmit");
    ASSERT_TRUE(run());
    wire::CanFrame fast = frame_of(0x123, 64, 0, true);
    fast.has_bit_rate_switch = true;
    EXPECT_THAT(heard_, ElementsAre(frame_of(0x321, 8, 0), fast, frame_of(0x222, 12, 0, true)));
    EXPECT_EQ(tiny_.result(0) >> 21U & 1U, 1U) << "three requests fill the FIFO";
    EXPECT_EQ(tiny_.result(0) & 7U, 0U);
    EXPECT_EQ(tiny_.result(1), 7U) << "all three were sent";
    EXPECT_EQ(tiny_.result(2), 1U);
    EXPECT_EQ(tiny_.result(3) & 7U, 3U) << "and all places are free";
    EXPECT_EQ(tiny_.violations(), "");
}

TEST_F(FdcanTest, as_a_queue_sends_the_lowest_identifier_first) {
    tiny_.jump("transmit_by_identifier");
    ASSERT_TRUE(run());
    EXPECT_THAT(heard_, ElementsAre(frame_of(0x321, 8, 0), frame_of(0x123, 8, 0), frame_of(0x045, 8, 0),
                                    frame_of(0x222, 8, 0)));
    EXPECT_EQ(tiny_.result(0) >> 21U & 1U, 1U) << "three requests fill the queue";
    EXPECT_EQ(tiny_.result(1) >> 16U & 3U, 0U) << "the lowest free place";
    EXPECT_EQ(tiny_.violations(), "");
}

TEST_F(FdcanTest, filters_decide_and_a_full_fifo_loses_the_newest) {
    node::CanTransmitter& host = bus_.attach({}, 16);
    tiny_.jump("receive");
    ASSERT_TRUE(run(2));
    const wire::CanFrame to_fifo_1 = frame_of(0x201, 1, 0x77);
    for (const wire::CanFrame& frame :
         {frame_of(0x120, 4, 0x10), frame_of(0x300, 4, 0x20), frame_of(0x12F, 12, 0x30, true),
          frame_of(0x130, 4, 0x40), to_fifo_1, frame_of(0x121, 8, 0x50), frame_of(0x122, 8, 0x60)}) {
        ASSERT_TRUE(host.send(frame));
        on_bus_.run_until({now_ += 300});  // one by one: the bus would sort them
    }
    ASSERT_TRUE(run());
    EXPECT_EQ(tiny_.result(0) & 0xFU, 3U);
    EXPECT_EQ(tiny_.result(0) >> 24U & 3U, 3U) << "full, and one was lost";
    EXPECT_EQ(tiny_.result(1), 0x120U);
    EXPECT_EQ(tiny_.result(2), 0x004U) << "filter 0, classical, 4 bytes";
    EXPECT_EQ(tiny_.result(3), 0x13121110U);
    EXPECT_EQ(tiny_.result(4), 0x12FU);
    EXPECT_EQ(tiny_.result(5), 0x029U) << "FD, length code 9: 12 bytes";
    EXPECT_EQ(tiny_.result(7), 0x121U);
    EXPECT_EQ(tiny_.result(10), 0x201U) << "in FIFO 1";
    EXPECT_EQ(tiny_.result(11) & 0xFU, 0xFU) << "RF0N, RF0F, RF0L, RF1N";
    EXPECT_EQ(tiny_.result(12), 0U);
    EXPECT_EQ(tiny_.violations(), "");
}

TEST_F(FdcanTest, alone_becomes_error_passive_and_never_bus_off) {
    tiny_.board().can().set_link(CanLink::unacknowledged);
    tiny_.jump("alone");
    ASSERT_TRUE(run());
    EXPECT_EQ(tiny_.result(0), 0x60U) << "passive and warning";
    EXPECT_EQ(tiny_.result(1), 128U);
    EXPECT_EQ(tiny_.result(2), 1U) << "still pending";
    EXPECT_EQ(tiny_.result(3), 0U);
    EXPECT_EQ(tiny_.result(4), 1U) << "cancelled";
    EXPECT_TRUE(heard_.empty());
}

TEST_F(FdcanTest, bus_off_waits_for_software_and_then_for_129_times_11_bits) {
    tiny_.board().can().set_link(CanLink::broken);
    tiny_.jump("bus_off");
    ASSERT_TRUE(run(2));
    tiny_.board().can().set_link(CanLink::good);
    ASSERT_TRUE(run(3));
    const std::int64_t asked = now_ - 100;  // within the last step
    ASSERT_TRUE(run());
    EXPECT_EQ(tiny_.result(0), 1U) << "INIT was set by the hardware";
    EXPECT_EQ(tiny_.result(1), 1U) << "IR.BO on entry";
    EXPECT_EQ(tiny_.result(2), 0U) << "the counters start anew";
    EXPECT_EQ(tiny_.result(3), 1U) << "IR.BO on leaving";
    EXPECT_THAT(heard_, ElementsAre(frame_of(0x100, 1, 0)));
    EXPECT_GE(ends_.front() - asked, 129 * 11);
}

TEST_F(FdcanTest, thirty_two_disturbed_frames_are_bus_off) {
    bus_.add_fault({.kind = CanFaultKind::disturb, .can_id = 0x321, .count = 1000});
    tiny_.jump("bus_off");
    ASSERT_TRUE(run(2));
    EXPECT_EQ(tiny_.result(0), 1U);
    EXPECT_TRUE(heard_.empty());
    ASSERT_TRUE(run()) << "the cancelled frame is gone, the next one is not disturbed";
    EXPECT_THAT(heard_, ElementsAre(frame_of(0x100, 1, 0)));
}

TEST_F(FdcanTest, who_only_monitors_hears_tells_errors_and_says_nothing) {
    node::CanTransmitter& host = bus_.attach({}, 16);
    tiny_.jump("overhear");
    ASSERT_TRUE(run(2));
    wire::CanFrame fast = frame_of(0x123, 12, 0, true);
    fast.has_bit_rate_switch = true;
    ASSERT_TRUE(host.send(frame_of(0x555, 4, 0)));
    on_bus_.run_until({now_ += 300});
    ASSERT_TRUE(host.send(fast));
    ASSERT_TRUE(run());
    EXPECT_EQ(tiny_.result(0), 1U << 22U | 1U) << "an error in the data, none in the arbitration, one frame";
    EXPECT_EQ(tiny_.result(1), 1U);
    EXPECT_EQ(tiny_.result(2), 0x555U);
    EXPECT_EQ(tiny_.result(3), 0U) << "the counters stand still";
    EXPECT_EQ(tiny_.result(4), 1U) << "what was asked for stays";
    EXPECT_THAT(heard_, ElementsAre(frame_of(0x555, 4, 0), fast)) << "nothing of its own";
    EXPECT_THAT(tiny_.violations(), testing::HasSubstr("only monitoring"));
}

}  // namespace
}  // namespace octoskin::sim::stm32
