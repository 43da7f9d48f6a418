#include "firmware/core/pause.hpp"

#include <gtest/gtest.h>

namespace octoskin::node {
namespace {

constexpr Microseconds kMinute{60'000'000};

TEST(Pause, lasts_from_its_beginning_to_its_end_and_not_before) {
    Pause pause;
    pause.update({5});
    EXPECT_TRUE(pause.is_over());
    EXPECT_FALSE(pause.end());
    for (const std::uint32_t begin : {0U, 0xFFFF'FFFFU, 0xFFFF'FC00U, 0x7FFF'FFFFU}) {
        pause.begin({begin}, Microseconds{1'000});
        pause.update({begin});
        EXPECT_FALSE(pause.is_over());
        pause.update(NodeTime{begin} + Microseconds{999});
        EXPECT_FALSE(pause.is_over());
        EXPECT_EQ(pause.end(), NodeTime{begin} + Microseconds{1'000});
        pause.update(NodeTime{begin} + Microseconds{1'000});
        EXPECT_TRUE(pause.is_over());
        EXPECT_FALSE(pause.end());
    }
}

TEST(Pause, stays_over_however_long_nothing_happens) {
    Pause pause;
    NodeTime now{12'345};
    pause.begin(now, Microseconds{1'000});
    for (int minute = 0; minute < 200; ++minute) {
        now = now + kMinute;
        pause.update(now);
        EXPECT_TRUE(pause.is_over()) << minute;
    }
}

}  // namespace
}  // namespace octoskin::node
