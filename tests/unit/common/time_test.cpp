#include "common/time.hpp"

#include <gtest/gtest.h>

#include <array>

#include "common/wire/messages.hpp"

namespace octoskin {
namespace {

constexpr std::array<std::uint32_t, 10> kAroundTheWrap = {
    0, 1, 2, 63, 64, 0x7FFFFFFFU, 0x80000000U, 0x80000001U, 0xFFFFFFC0U, 0xFFFFFFFFU};

TEST(NodeTime, elapsed_is_exact_over_the_wrap) {
    EXPECT_EQ(elapsed({0xFFFFFFFFU}, {0}), Microseconds(1));
    EXPECT_EQ(elapsed({0}, {0xFFFFFFFFU}), Microseconds(-1));
    EXPECT_EQ(elapsed({4'294'000'000U}, {1'000'000U}), Microseconds(1'967'296));
    EXPECT_EQ(elapsed({7}, {7}), Microseconds(0));
}

TEST(NodeTime, elapsed_reaches_from_minus_2_to_the_31_to_just_below_2_to_the_31) {
    for (const std::uint32_t start : kAroundTheWrap) {
        EXPECT_EQ(elapsed({start}, {start + 0x7FFFFFFFU}), Microseconds(2'147'483'647));
        EXPECT_EQ(elapsed({start}, {start + 0x80000000U}), Microseconds(-2'147'483'648LL));
    }
}

TEST(NodeTime, adding_and_taking_away_undo_each_other_from_everywhere) {
    for (const std::uint32_t start : kAroundTheWrap) {
        for (const std::int64_t us : {0LL, 1LL, -1LL, 5'000'000LL, -5'000'000LL, 2'147'483'647LL}) {
            const NodeTime there = NodeTime{start} + Microseconds(us);
            EXPECT_EQ(elapsed({start}, there), Microseconds(us));
            EXPECT_EQ(there - Microseconds(us), NodeTime{start});
        }
    }
}

TEST(NodeTime, deadline_is_reached_at_its_very_microsecond_and_not_before) {
    for (const std::uint32_t deadline : kAroundTheWrap) {
        EXPECT_FALSE(is_reached({deadline}, {deadline - 1}));
        EXPECT_TRUE(is_reached({deadline}, {deadline}));
        EXPECT_TRUE(is_reached({deadline}, {deadline + 1}));
        EXPECT_TRUE(is_reached({deadline}, {deadline + 0x7FFFFFFFU}));
        EXPECT_FALSE(is_reached({deadline}, {deadline + 0x80000000U}));
    }
}

TEST(HostTime, differences_and_sums_are_signed_nanoseconds) {
    EXPECT_EQ(HostTime{5} - HostTime{7}, Nanoseconds(-2));
    EXPECT_EQ((HostTime{5} + Nanoseconds(-7)).ns, -2);
    EXPECT_EQ((HostTime{5} - Nanoseconds(7)).ns, -2);
}

TEST(HostTime, is_ordered_as_its_nanoseconds) {
    EXPECT_LT(HostTime{4}, HostTime{5});
    EXPECT_GT(HostTime{5}, HostTime{4});
    EXPECT_FALSE(HostTime{4} < HostTime{4});
    EXPECT_EQ(HostTime{4}, HostTime{4});
    EXPECT_NE(HostTime{4}, HostTime{5});
}
TEST(WallTime, is_ordered_as_its_nanoseconds) {
    EXPECT_LT(WallTime{4}, WallTime{5});
    EXPECT_GT(WallTime{5}, WallTime{4});
    EXPECT_FALSE(WallTime{4} < WallTime{4});
    EXPECT_EQ(WallTime{4}, WallTime{4});
    EXPECT_NE(WallTime{4}, WallTime{5});
}
TEST(NodeTime, differs_from_any_other_reading) {
    EXPECT_NE(NodeTime{4}, NodeTime{5});
}

TEST(TimeResidue, of_classical_frames_is_18_bits_in_steps_of_64_us_rounded_down) {
    EXPECT_EQ(wire::classical_residue({0x12345678U}), (wire::TimeResidue{0x05640, 1U << 18U}));
    EXPECT_EQ(wire::classical_residue({0xFFFFFFFFU}), (wire::TimeResidue{0x3FFC0, 1U << 18U}));
    EXPECT_EQ(wire::classical_residue({63}).value_us, 0U);
    EXPECT_EQ(wire::classical_residue({64}).value_us, 64U);
}

TEST(TimeResidue, of_fd_frames_is_the_low_24_bits) {
    EXPECT_EQ(wire::fd_residue({0x12345678U}), (wire::TimeResidue{0x345678, 1U << 24U}));
    EXPECT_EQ(wire::fd_residue({0xFFFFFFFFU}), (wire::TimeResidue{0xFFFFFF, 1U << 24U}));
}

}  // namespace
}  // namespace octoskin
