// How much older a map is after a restart.
#include "host/apps/daemon/boot_clock.hpp"

#include <gtest/gtest.h>

#include "tests/support/evidence.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

BootTime at(Nanoseconds since_boot, std::uint8_t boot = 1) {
    return {{boot}, since_boot};
}

HostTime bus(Nanoseconds time) {
    return HostTime{time.count()};
}

/// Of a voxel that was seen at the bus's time `seen`.
FusedMap map_seen_at(Nanoseconds seen) {
    FusedMap map(MapConfig{});
    map.go_on(bus(seen));
    feed(map, std::vector<VoxelUpdate>{{{32768, 32768, 32768}, 1.0F}});
    return map;
}

std::optional<std::uint32_t> age_s(const FusedMap& map) {
    const auto seen = map.confirmation({32768, 32768, 32768});
    return seen ? std::optional(seen->age_s) : std::nullopt;
}

TEST(BootClock, tells_the_boot_of_this_machine_and_goes_on) {
    const auto now = boot_now();
    if (!now) GTEST_SKIP() << "no boot ID here";
    const auto later = boot_now();
    ASSERT_TRUE(later);
    EXPECT_EQ(now->boot, later->boot);
    EXPECT_LE(now->since_boot, later->since_boot);
    EXPECT_GT(now->since_boot, 0ns);
}

TEST(BootClock, reads_a_boot_as_the_kernel_and_as_systemd_write_it) {
    const auto kernels = read_boot_id("01234567-89ab-cdef-0123-456789abcdef");
    ASSERT_TRUE(kernels);
    EXPECT_EQ(kernels->front(), 0x01);
    EXPECT_EQ(kernels->back(), 0xEF);
    EXPECT_EQ(read_boot_id("0123456789abcdef0123456789abcdef"), kernels);
    for (const char* text : {"", "0123456789abcdef0123456789abcde", "0123456789abcdef0123456789abcdef0",
                             "x123456789abcdef0123456789abcdef", "+1234567-89ab-cdef-0123-456789abcdef"})
        EXPECT_FALSE(read_boot_id(text)) << text;
}

TEST(BootClock, counts_whole_seconds_of_one_boot_the_one_that_has_begun_too) {
    EXPECT_EQ(seconds_between(at(5s), at(5s)), 0);
    EXPECT_EQ(seconds_between(at(5s), at(5s + 1ns)), 1);
    EXPECT_EQ(seconds_between(at(5s), at(9s)), 4);
    EXPECT_FALSE(seconds_between(at(5s), at(4s)));
    EXPECT_FALSE(seconds_between(at(5s, 1), at(9s, 2)));
    EXPECT_FALSE(seconds_between({}, at(9s)));
    EXPECT_FALSE(seconds_between(at(5s), {}));
}

TEST(MapTime, is_no_later_than_when_the_maps_clock_came_to_what_it_shows) {
    BootTime now = at(100s);
    MapTime time([&now] { return std::optional(now); });
    FusedMap map(MapConfig{});
    time.note(map);
    EXPECT_FALSE(time.map_time()) << "it has no time";
    now = at(100s + 50ms);
    map = map_seen_at(1000s);
    time.note(map);
    EXPECT_EQ(time.map_time(), at(100s)) << "it may have begun right after the look before";
    now = at(130s);
    time.note(map);
    EXPECT_EQ(time.map_time(), at(100s)) << "the bus is silent";
    now = at(130s + 50ms);
    map.go_on(bus(1031s));
    time.note(map);
    EXPECT_EQ(time.map_time(), at(130s));
}

TEST(MapTime, makes_a_saved_map_older_by_what_passed_until_its_first_measurement) {
    BootTime now = at(200s);
    MapTime time([&now] { return std::optional(now); });
    FusedMap map = map_seen_at(1000s);
    EXPECT_EQ(time.begin_with(map, at(190s + 500ms)), 10);
    EXPECT_EQ(age_s(map), 10U);
    EXPECT_EQ(time.map_time(), at(200s)) << "what a save would say";
    now = at(203s);
    (void)map.wait(*time.since_saved());
    time.note(map);
    EXPECT_EQ(age_s(map), 13U);
    map.go_on(bus(5s));  // of another bus
    EXPECT_EQ(age_s(map), 13U);
    now = at(230s);
    EXPECT_FALSE(map.wait(*time.since_saved()));
}

TEST(MapTime, has_a_map_of_another_boot_stale) {
    MapTime time([] { return std::optional(at(200s, 2)); });
    for (const auto& saved : {std::optional(at(190s, 1)), std::optional<BootTime>()}) {
        FusedMap map = map_seen_at(1000s);
        EXPECT_FALSE(time.begin_with(map, saved));
        map.go_on(bus(1001s));
        EXPECT_EQ(map.known_voxels(), 1U);
        EXPECT_FALSE(age_s(map));
        EXPECT_TRUE(map.is_stale({32768, 32768, 32768}) || MapConfig{}.age.stale_after_s == 0);
    }
}

}  // namespace
}  // namespace octoskin
