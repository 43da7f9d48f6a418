#include "common/wall_time.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace octoskin {
namespace {

TEST(WallTime, is_what_a_clock_that_is_right_shows) {
    EXPECT_EQ(wall_time(1'750'000'000, 123'456'789).ns, 1'750'000'000'123'456'789);
    EXPECT_TRUE(tells_time(wall_time(1'750'000'000, 0)));
    EXPECT_EQ(wall_time(7'258'118'399, 999'999'999).ns, 7'258'118'399'999'999'999);
    EXPECT_TRUE(tells_time(wall_time(7'258'118'399, 999'999'999)));
}

// The nanoseconds of a clock that shows 2310 do not fit into 64 bits.
TEST(WallTime, is_the_border_of_a_clock_that_shows_what_no_stamp_can_hold) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
    for (const std::int64_t seconds :
         std::array<std::int64_t, 4>{7'258'118'400, 9'223'372'037, 10'750'000'000, kMost}) {
        EXPECT_EQ(wall_time(seconds, 999'999'999), kWallTimeMax) << seconds;
        EXPECT_FALSE(tells_time(wall_time(seconds, 0))) << seconds;
    }
    for (const std::int64_t seconds : std::array<std::int64_t, 2>{-1, kLeast}) {
        EXPECT_EQ(wall_time(seconds, 5).ns, 0) << seconds;
        EXPECT_FALSE(tells_time(wall_time(seconds, 5))) << seconds;
    }
    EXPECT_EQ(wall_time(5, kMost).ns, 5'999'999'999);
    EXPECT_EQ(wall_time(5, -1).ns, 5'000'000'000);
}

}  // namespace
}  // namespace octoskin
