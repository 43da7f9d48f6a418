// Oracle: the device's counter itself, stepped one by one (0..255, then 128..255 for ever: UM2356).
#include "firmware/core/stream_gate.hpp"

#include <gtest/gtest.h>

#include <array>

namespace octoskin::node {
namespace {

int stepped(int count) {
    return count == 255 ? 128 : count + 1;
}

/// How often the counter must be stepped from `previous` to show `current`, at most 63 times; 0 if never.
int steps_by_counting(int previous, int current) {
    int count = previous;
    for (int steps = 1; steps <= 63; ++steps) {
        count = stepped(count);
        if (count == current) return steps;
    }
    return 0;
}

TEST(StreamGate, counts_steps_as_the_device_does_for_every_pair) {
    for (int previous = 0; previous < 256; ++previous) {
        for (int current = 0; current < 256; ++current) {
            const auto steps =
                stream_steps(static_cast<std::uint8_t>(previous), static_cast<std::uint8_t>(current));
            ASSERT_EQ(steps.value_or(0), steps_by_counting(previous, current)) << previous << " " << current;
        }
    }
}

TEST(StreamGate, passes_what_advanced_differs_or_anything_for_every_pair) {
    for (int previous = 0; previous < 256; ++previous) {
        for (int current = 0; current < 256; ++current) {
            const auto p = static_cast<std::uint8_t>(previous);
            const auto c = static_cast<std::uint8_t>(current);
            ASSERT_EQ(passes(StreamGate::advanced, p, c), steps_by_counting(previous, current) > 0);
            ASSERT_EQ(passes(StreamGate::differs, p, c), previous != current);
            ASSERT_TRUE(passes(StreamGate::off, p, c));
        }
    }
}

TEST(StreamGate, passes_the_wrap_from_255_to_128_as_one_step) {
    EXPECT_EQ(stream_steps(255, 128), 1);
    EXPECT_EQ(stream_steps(254, 129), 3);
    EXPECT_EQ(stream_steps(255, 0), std::nullopt);
}

}  // namespace
}  // namespace octoskin::node
