#include "firmware/core/zone_cycle.hpp"

#include <gtest/gtest.h>

#include "common/wire/messages.hpp"

namespace octoskin::node {
namespace {

constexpr Microseconds kGuard{1'000};

TimeBracket between(std::uint32_t earliest_us, std::uint32_t latest_us) {
    return {{earliest_us}, {latest_us}};
}

TEST(ZoneCycle, is_always_zone_0_when_there_is_only_one) {
    const ZoneCycle zones{1, kGuard};
    EXPECT_FALSE(zones.is_cycling());
    EXPECT_EQ(zones.in_force(between(5, 10)), 0);
}

TEST(ZoneCycle, cycles_through_all_zones_and_begins_again) {
    ZoneCycle zones{3, kGuard};
    for (const int expected : {1, 2, 0, 1}) {
        EXPECT_EQ(zones.next(), expected);
        zones.written(between(1'000, 1'100));
        EXPECT_EQ(zones.current(), expected);
    }
    zones.restart();
    EXPECT_EQ(zones.current(), 0);
    EXPECT_EQ(zones.next(), 1);
}

TEST(ZoneCycle, gives_a_range_the_zone_in_force_when_it_began) {
    ZoneCycle zones{2, kGuard};
    zones.written(between(100'000, 100'200));
    EXPECT_EQ(zones.in_force(between(90'000, 90'300)), 0);
    EXPECT_EQ(zones.in_force(between(110'000, 110'300)), 1);
}

TEST(ZoneCycle, does_not_know_the_zone_of_a_range_that_began_within_the_guard_of_a_write) {
    ZoneCycle zones{2, kGuard};
    zones.written(between(100'000, 100'200));
    EXPECT_EQ(zones.in_force(between(98'500, 98'999)), 0);
    EXPECT_EQ(zones.in_force(between(98'500, 99'000)), wire::kZoneUnknown);
    EXPECT_EQ(zones.in_force(between(100'100, 100'150)), wire::kZoneUnknown);
    EXPECT_EQ(zones.in_force(between(101'200, 101'500)), wire::kZoneUnknown);
    EXPECT_EQ(zones.in_force(between(101'201, 101'500)), 1);
}

TEST(ZoneCycle, knows_the_zone_for_sure_when_ranging_starts_again) {
    ZoneCycle zones{3, kGuard};
    zones.written(between(100'000, 100'200));
    zones.settle();
    EXPECT_EQ(zones.in_force(between(100'000, 100'100)), 1);
    EXPECT_EQ(zones.next(), 2);
}

TEST(ZoneCycle, works_across_the_wrap_of_the_clock) {
    ZoneCycle zones{2, kGuard};
    zones.written(between(0xFFFFFFF0U, 0x10U));
    EXPECT_EQ(zones.in_force(between(0xFFFF0000U, 0xFFFF0100U)), 0);
    EXPECT_EQ(zones.in_force(between(0x00000100U, 0x00000200U)), wire::kZoneUnknown);
    EXPECT_EQ(zones.in_force(between(0x00010000U, 0x00010100U)), 1);
}

TEST(ZoneCycle, a_range_that_began_after_a_write_settles_it_and_one_from_before_does_not) {
    ZoneCycle zones{2, kGuard};
    zones.written(between(100'000, 100'200));
    zones.note_range({101'200});
    EXPECT_EQ(zones.in_force(between(90'000, 90'300)), 0) << "still remembered";
    zones.note_range({101'201});
    EXPECT_EQ(zones.in_force(between(90'000, 90'300)), 1) << "no such range is asked about any more";
}

TEST(ZoneCycle, knows_the_zone_however_long_ago_it_was_written) {
    ZoneCycle zones{2, kGuard};
    zones.written(between(100'000, 100'200));
    NodeTime begin{133'000};
    for (int minute = 0; minute < 150; ++minute) {
        EXPECT_EQ(zones.in_force({begin, begin + Microseconds{100}}), 1) << minute;
        zones.note_range(begin);
        begin = begin + Microseconds{60'000'000};
    }
}

TEST(ZoneCycle, writes_only_if_guard_and_write_are_over_before_the_next_range_begins) {
    const ZoneCycle zones{2, kGuard};
    EXPECT_TRUE(zones.fits_before({10'000}, {8'599}));  // 1000 us of guard, 400 us of writing
    EXPECT_FALSE(zones.fits_before({10'000}, {8'600}));
    EXPECT_FALSE(zones.fits_before({10'000}, {10'500}));
}

}  // namespace
}  // namespace octoskin::node
