#include "firmware/port/linux/frames_in_flight.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <vector>

namespace octoskin::linux_port {
namespace {

wire::CanFrame frame(std::uint8_t number) {
    wire::CanFrame frame;
    frame.can_id = 0x201;
    frame.payload_len = 8;
    frame.data[0] = number;
    return frame;
}

TEST(FramesInFlight, takes_four_and_no_more_until_one_is_confirmed) {
    FramesInFlight frames;
    for (std::uint8_t i = 0; i < 4; ++i) {
        ASSERT_TRUE(frames.has_room());
        frames.add(frame(i), NodeTime{100U + i});
    }
    EXPECT_FALSE(frames.has_room());
    EXPECT_EQ(frames.oldest(), NodeTime{100});
    frames.confirm(frame(0));
    EXPECT_TRUE(frames.has_room());
    EXPECT_EQ(frames.oldest(), NodeTime{101});
}

TEST(FramesInFlight, takes_those_before_a_confirmed_one_for_sent) {
    FramesInFlight frames;
    for (std::uint8_t i = 0; i < 3; ++i) frames.add(frame(i), NodeTime{i});
    frames.confirm(frame(1));
    EXPECT_EQ(frames.oldest(), NodeTime{2});
    frames.give_up_all();
    EXPECT_EQ(frames.take_given_up(), frame(2));
    EXPECT_EQ(frames.take_given_up(), std::nullopt);
}

TEST(FramesInFlight, gives_up_each_frame_once_in_order) {
    FramesInFlight frames;
    frames.add(frame(7), NodeTime{1});
    frames.add(frame(8), NodeTime{2});
    frames.give_up_all();
    EXPECT_EQ(frames.oldest(), std::nullopt);
    frames.add(frame(9), NodeTime{3});
    frames.confirm(frame(7));  // given up: too late
    EXPECT_EQ(frames.take_given_up(), frame(7));
    EXPECT_EQ(frames.take_given_up(), frame(8));
    EXPECT_EQ(frames.take_given_up(), std::nullopt);
    EXPECT_EQ(frames.oldest(), NodeTime{3});
}

TEST(FramesInFlight, forgets_only_what_was_not_given_up) {
    FramesInFlight frames;
    frames.add(frame(1), NodeTime{1});
    frames.give_up_all();
    frames.add(frame(2), NodeTime{2});
    frames.add(frame(3), NodeTime{3});
    EXPECT_EQ(frames.forget_all(), 2U);
    EXPECT_EQ(frames.oldest(), std::nullopt);
    EXPECT_EQ(frames.take_given_up(), frame(1));
}

/// Against two queues: every frame that is added ends exactly once, confirmed, given up or forgotten.
TEST(FramesInFlight, loses_and_doubles_nothing_in_any_order_of_events) {
    std::mt19937 random(20261121);
    FramesInFlight frames;
    std::deque<wire::CanFrame> in_flight;
    std::deque<wire::CanFrame> given_up;
    std::uint32_t next = 0;
    for (int turn = 0; turn < 100'000; ++turn) {
        ASSERT_EQ(frames.has_room(), in_flight.size() + given_up.size() < FramesInFlight::kMax);
        switch (random() % 8) {
            case 0:
            case 1:
            case 2:
                if (!frames.has_room()) break;
                in_flight.push_back(frame(static_cast<std::uint8_t>(next++)));
                frames.add(in_flight.back(), NodeTime{next});
                break;
            case 3:
            case 4: {
                if (in_flight.empty()) break;
                const std::size_t which = random() % in_flight.size();
                frames.confirm(in_flight[which]);
                in_flight.erase(in_flight.begin(),
                                in_flight.begin() + static_cast<std::ptrdiff_t>(which) + 1);
                break;
            }
            case 5:
                frames.give_up_all();
                given_up.insert(given_up.end(), in_flight.begin(), in_flight.end());
                in_flight.clear();
                break;
            case 6: {
                const auto taken = frames.take_given_up();
                ASSERT_EQ(taken.has_value(), !given_up.empty());
                if (!taken) break;
                ASSERT_EQ(*taken, given_up.front());
                given_up.pop_front();
                break;
            }
            default:
                if (random() % 20 != 0) break;
                ASSERT_EQ(frames.forget_all(), in_flight.size());
                in_flight.clear();
        }
        ASSERT_EQ(frames.oldest().has_value(), !in_flight.empty());
    }
}

}  // namespace
}  // namespace octoskin::linux_port
