#include "hw/sim/can/simulated_can_bus.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace octoskin::sim {
namespace {

constexpr wire::BitRates kRates{.nominal = 1'000'000, .data = 5'000'000};

wire::CanFrame classical(std::uint32_t can_id, std::uint8_t payload_len = 8) {
    wire::CanFrame frame;
    frame.can_id = can_id;
    frame.payload_len = payload_len;
    return frame;
}

struct Heard {
    std::uint32_t can_id = 0;
    std::int64_t end_us = 0;
    friend bool operator==(const Heard&, const Heard&) = default;
};

FrameHandler noting(std::vector<Heard>& heard) {
    return [&heard](const wire::CanFrame& frame, SimTime end) { heard.push_back({frame.can_id, end.us}); };
}

/// Advances from event to event until nothing happens any more or `until`.
void run(SimulatedCanBus& bus, SimTime until) {
    while (const auto next = bus.next_event()) {
        if (*next > until) break;
        bus.advance(*next);
    }
    bus.advance(until);
}

TEST(SimulatedCanBus, takes_as_long_for_a_frame_as_its_bits) {
    // 135 bits of a classical frame with 8 bytes (Davis et al. 2007), 27 + 4 bits nominal each at 1 us.
    EXPECT_EQ(frame_duration_us(classical(1), kRates), 135);
    EXPECT_EQ(frame_duration_us(classical(1), {.nominal = 500'000, .data = 500'000}), 270);
    wire::CanFrame fd = classical(1, 64);
    fd.is_fd = true;
    const std::int64_t without_switch_us = frame_duration_us(fd, kRates);
    fd.has_bit_rate_switch = true;
    const std::int64_t with_switch_us = frame_duration_us(fd, kRates);
    EXPECT_GT(without_switch_us, 600);  // 512 bits of payload alone at 1 Mbit/s
    EXPECT_GT(with_switch_us, 130);     // 512 bits at 5 Mbit/s and the arbitration at 1 Mbit/s
    EXPECT_LT(with_switch_us, 200);
}

TEST(SimulatedCanBus, lets_everybody_but_the_sender_hear_a_frame_at_its_end) {
    SimulatedCanBus bus(kRates);
    std::vector<Heard> a;
    std::vector<Heard> b;
    std::vector<Heard> recorded;
    auto& sender = bus.attach(noting(a));
    bus.attach(noting(b));
    bus.tap(noting(recorded));
    bus.advance({1'000});
    EXPECT_TRUE(sender.send(classical(5)));
    run(bus, {5'000});
    EXPECT_TRUE(a.empty());
    EXPECT_EQ(b, (std::vector<Heard>{{5, 1'135}}));
    EXPECT_EQ(recorded, b);
}

TEST(SimulatedCanBus, sends_the_lowest_identifier_first_whoever_called_first) {
    for (const bool is_low_first : {true, false}) {
        SimulatedCanBus bus(kRates);
        std::vector<Heard> recorded;
        auto& one = bus.attach({});
        auto& two = bus.attach({});
        bus.tap(noting(recorded));
        EXPECT_TRUE((is_low_first ? one : two).send(classical(3)));
        EXPECT_TRUE((is_low_first ? two : one).send(classical(7)));
        run(bus, {1'000});
        EXPECT_EQ(recorded, (std::vector<Heard>{{3, 135}, {7, 270}}));
    }
}

TEST(SimulatedCanBus, does_not_interrupt_a_frame_under_way) {
    SimulatedCanBus bus(kRates);
    std::vector<Heard> recorded;
    auto& one = bus.attach({});
    auto& two = bus.attach({});
    bus.tap(noting(recorded));
    EXPECT_TRUE(one.send(classical(700)));
    bus.advance({10});
    EXPECT_TRUE(two.send(classical(1)));
    EXPECT_TRUE(one.send(classical(600)));
    run(bus, {1'000});
    EXPECT_EQ(recorded, (std::vector<Heard>{{700, 135}, {1, 270}, {600, 405}}));
}

TEST(SimulatedCanBus, refuses_a_frame_when_all_mailboxes_are_taken) {
    SimulatedCanBus bus(kRates);
    auto& sender = bus.attach({}, 2);
    EXPECT_TRUE(sender.send(classical(1)));
    EXPECT_TRUE(sender.send(classical(2)));
    EXPECT_FALSE(sender.send(classical(3)));
    bus.advance({1});  // the first is under way and has left its mailbox
    EXPECT_TRUE(sender.send(classical(3)));
}

TEST(SimulatedCanBus, keeps_the_order_of_equal_identifiers) {
    SimulatedCanBus bus(kRates);
    std::vector<std::uint8_t> recorded;
    auto& sender = bus.attach({});
    bus.tap([&](const wire::CanFrame& frame, SimTime) { recorded.push_back(frame.data[0]); });
    for (std::uint8_t i = 0; i < 3; ++i) {
        wire::CanFrame frame = classical(9);
        frame.data[0] = i;
        EXPECT_TRUE(sender.send(frame));
    }
    run(bus, {1'000});
    EXPECT_EQ(recorded, (std::vector<std::uint8_t>{0, 1, 2}));
}

TEST(SimulatedCanBus, lets_a_handler_answer_in_the_next_frame) {
    SimulatedCanBus bus(kRates);
    std::vector<Heard> recorded;
    node::CanTransmitter* answering = nullptr;
    answering = &bus.attach([&](const wire::CanFrame& frame, SimTime) {
        if (frame.can_id == 10) {
            EXPECT_TRUE(answering->send(classical(20)));
        }
    });
    auto& asking = bus.attach({});
    bus.tap(noting(recorded));
    EXPECT_TRUE(asking.send(classical(10)));
    run(bus, {1'000});
    EXPECT_EQ(recorded, (std::vector<Heard>{{10, 135}, {20, 270}}));
}

TEST(SimulatedCanBus, tells_how_busy_it_was) {
    SimulatedCanBus bus(kRates);
    auto& sender = bus.attach({});
    EXPECT_DOUBLE_EQ(bus.busy_fraction(), 0.0);
    EXPECT_TRUE(sender.send(classical(1)));
    run(bus, {1'350});
    EXPECT_DOUBLE_EQ(bus.busy_fraction(), 0.1);
}

class CanFaultTest : public testing::Test {
  protected:
    /// The payload's first bytes as heard when frames 0..4 of identifier 9 and one of identifier 8 are sent.
    std::vector<Heard> send_five_and_one(const CanFault& fault) {
        SimulatedCanBus bus(kRates);
        std::vector<Heard> heard;
        auto& sender = bus.attach({}, 6);
        bus.tap([&](const wire::CanFrame& frame, SimTime end) { heard.push_back({frame.data[0], end.us}); });
        bus.add_fault(fault);
        for (std::uint8_t i = 0; i < 5; ++i) {
            wire::CanFrame frame = classical(9);
            frame.data[0] = i;
            EXPECT_TRUE(sender.send(frame));
        }
        wire::CanFrame other = classical(8);
        other.data[0] = 100;
        EXPECT_TRUE(sender.send(other));
        run(bus, {10'000});
        return heard;
    }
};

TEST_F(CanFaultTest, drops_the_frames_it_names) {
    const auto heard =
        send_five_and_one({.kind = CanFaultKind::drop, .can_id = 9, .after = 1, .count = 2, .every = 2});
    EXPECT_EQ(heard, (std::vector<Heard>{{100, 135}, {0, 270}, {2, 540}, {4, 810}}));
}

TEST_F(CanFaultTest, duplicates_a_frame) {
    const auto heard = send_five_and_one({.kind = CanFaultKind::duplicate, .can_id = 8});
    ASSERT_EQ(heard.size(), 7U);
    EXPECT_EQ(heard[0], (Heard{100, 135}));
    EXPECT_EQ(heard[1], (Heard{100, 135}));
}

TEST_F(CanFaultTest, flips_the_bit_it_names) {
    const auto heard = send_five_and_one({.kind = CanFaultKind::corrupt, .can_id = 9, .after = 4, .bit = 7});
    EXPECT_EQ(heard.back(), (Heard{4 + 128, 810}));
}

TEST_F(CanFaultTest, delays_a_frame_past_later_ones) {
    const auto heard = send_five_and_one({.kind = CanFaultKind::delay, .can_id = 8, .delay_us = 200});
    EXPECT_EQ(heard[0], (Heard{0, 270}));
    EXPECT_EQ(heard[1], (Heard{100, 335}));
}

}  // namespace
}  // namespace octoskin::sim
