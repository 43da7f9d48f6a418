// How much older a map is after a restart.
#include "host/apps/daemon/boot_clock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/evidence.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

#ifndef CLONE_NEWTIME
#define CLONE_NEWTIME 0x00000080
#endif

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
FusedMap map_seen_at(Nanoseconds seen, const AgeModel& age = MapConfig{}.age) {
    FusedMap map(MapConfig{.age = age});
    map.advance_time(bus(seen));
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

TEST(BootClock, reads_how_far_a_time_namespace_is_ahead) {
    EXPECT_EQ(read_boot_offset("monotonic           7         0\nboottime            0         0\n"), 0s);
    EXPECT_EQ(read_boot_offset("monotonic 0 0\nboottime 100 5\n"), 100s + 5ns);
    EXPECT_EQ(read_boot_offset("monotonic 0 0\nboottime -1 500000000\n"), -500ms);
    for (const char* text :
         {"", "monotonic 0 0\n", "boottime", "boottime x 0", "boottime 1", "boottime 1 1000000000",
          "boottime 9000000000000000000 0", "boottime 99999999999999999999 0"})
        EXPECT_FALSE(read_boot_offset(text)) << text;
}

/// What `boot_now` is of a child in a time namespace that is 100 s behind; empty: there is none to be had.
std::optional<Nanoseconds> boot_of_child_100_s_behind() {
    int ends[2];
    if (::pipe(ends) != 0) return std::nullopt;
    const pid_t child = ::fork();
    if (child == 0) {
        const bool is_apart = ::unshare(CLONE_NEWTIME) == 0;
        const int offsets = is_apart ? ::open("/proc/self/timens_offsets", O_WRONLY) : -1;
        constexpr std::string_view kBehind = "boottime -100 0\n";
        const bool is_behind = ::write(offsets, kBehind.data(), kBehind.size()) > 0;
        const pid_t inside = is_behind ? ::fork() : -1;
        if (inside == 0) {
            const auto now = boot_now();
            const std::int64_t ns = now ? now->since_boot.count() : -1;
            ::_exit(::write(ends[1], &ns, sizeof(ns)) == sizeof(ns) ? 0 : 1);
        }
        if (inside > 0) ::waitpid(inside, nullptr, 0);
        ::_exit(0);
    }
    ::close(ends[1]);
    std::int64_t ns = -1;
    const bool is_reported = ::read(ends[0], &ns, sizeof(ns)) == sizeof(ns);
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
    return is_reported ? std::optional(Nanoseconds{ns}) : std::nullopt;
}

TEST(BootClock, is_the_same_in_a_time_namespace) {
    const auto before = boot_now();
    const auto inside = boot_of_child_100_s_behind();
    if (!before || !inside || before->since_boot < 200s) GTEST_SKIP() << "no time namespace to be had";
    EXPECT_GE(*inside, before->since_boot);
    EXPECT_LE(*inside, boot_now()->since_boot);
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
    time.note(map, bus(1000s - 10ms));
    EXPECT_FALSE(time.map_time()) << "it has no time";
    now = at(100s + 50ms);
    map = map_seen_at(1000s);
    time.note(map, bus(1000s + 40ms));
    EXPECT_EQ(time.map_time(), at(100s)) << "it may have begun right after the look before";
    now = at(130s);
    time.note(map, bus(1030s - 10ms));
    EXPECT_EQ(time.map_time(), at(100s)) << "the bus is silent";
    now = at(131s + 50ms);
    map.advance_time(bus(1031s));
    time.note(map, bus(1031s + 40ms));
    EXPECT_EQ(time.map_time(), at(130s));
}

/// A map in a file is free where it is so now, though nothing was measured for long.
TEST(MapTime, of_a_copy_that_goes_on_is_that_of_what_the_copy_shows) {
    BootTime now = at(100s + 50ms);
    MapTime time([&now] { return std::optional(now); });
    MapConfig config;
    config.age.unknown_after_s = 20;
    FusedMap map(config);
    map.advance_time(bus(1000s));
    feed(map, std::vector<VoxelUpdate>{{{32768, 32768, 32768}, -1.0F}});
    time.note(map, bus(1000s + 40ms));
    for (const std::int64_t passed_s : {0, 10, 30}) {
        now = at(Nanoseconds{(100 + passed_s) * 1'000'000'000} + 50ms);
        FusedMap copy = map.copy();
        const auto of_copy =
            time.advance_time(copy, bus(Nanoseconds{(1000 + passed_s) * 1'000'000'000} + 40ms));
        EXPECT_EQ(copy.known_voxels(), passed_s < 20 ? 1U : 0U) << passed_s;
        EXPECT_EQ(map.known_voxels(), 1U);
        const Nanoseconds shown{(100 + passed_s) * 1'000'000'000};
        EXPECT_EQ(of_copy, passed_s == 0 ? time.map_time() : std::optional(at(shown + 10ms))) << passed_s;
    }
    FusedMap waits = map.copy();
    waits.begin_to_wait();
    EXPECT_EQ(time.advance_time(waits, bus(1100s)), time.map_time());
    EXPECT_TRUE(waits.layers().ages.clock().waits);
    EXPECT_EQ(waits.known_voxels(), 1U);
}

TEST(MapTime, is_no_later_than_what_was_measured_and_went_into_the_map_late) {
    BootTime now = at(100s);
    MapTime time([&now] { return std::optional(now); });
    FusedMap map(MapConfig{});
    time.note(map, bus(1000s + 600ms));
    now = at(100s + 50ms);
    map.advance_time(bus(999s + 900ms));  // two images waited
    time.note(map, bus(1000s + 650ms));
    EXPECT_EQ(time.map_time(), at(100s + 50ms - 1s - 650ms));
    now = at(100s + 100ms);
    map.advance_time(bus(1000s + 100ms));
    time.note(map, bus(1000s + 700ms));
    EXPECT_EQ(time.map_time(), at(100s + 100ms - 700ms));
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
    time.note(map, {});
    EXPECT_EQ(age_s(map), 13U);
    map.advance_time(bus(5s));  // of another bus
    EXPECT_EQ(age_s(map), 13U);
    now = at(230s);
    EXPECT_FALSE(map.wait(*time.since_saved()));
}

TEST(SleepWatch, tells_how_long_the_machine_slept_once) {
    Nanoseconds boottime = 1000s;
    Nanoseconds monotonic = 900s;  // it slept before, too
    SleepWatch watch([&] { return boottime; }, [&] { return monotonic; });
    EXPECT_EQ(watch.look(), 0s);
    boottime += 10s;
    monotonic += 10s;
    EXPECT_EQ(watch.look(), 0s);
    boottime += 3600s;
    EXPECT_EQ(watch.look(), 3600s);
    EXPECT_EQ(watch.look(), 0s);
    boottime += 600ms;
    EXPECT_EQ(watch.look(), 0s);
    boottime += 600ms;
    EXPECT_EQ(watch.look(), 1200ms) << "short ones add up";
}

TEST(SleepWatch, takes_no_wait_for_the_processor_for_a_sleep) {
    Nanoseconds now = 1000s;
    Nanoseconds held_up = 0s;
    SleepWatch watch([&] { return now += held_up; }, [&] { return now += held_up; });
    for (const Nanoseconds each : {0s, 5s, 0s, 20s, 20s, 0s}) {
        held_up = each;
        EXPECT_EQ(watch.look(), 0s);
    }
}

/// A map that goes on, and a machine that sleeps.
class SleepingMachine : public testing::Test {
  protected:
    SleepingMachine() {
        (void)time_.attend(pipeline_, bus_);
        for (const StampedFrame& entry : scene_.bus.frames()) pipeline_.on_can(entry.frame, entry.stamp);
        pass(50ms);
        (void)time_.attend(pipeline_, bus_);
    }
    static test::Scene live_scene() {
        test::Scene scene = test::good_scene();
        scene.config.release = Release::once_placed;
        scene.config.maps = {MapFeed::both};
        scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 0};
        return scene;
    }
    void pass(Nanoseconds time) {
        boottime_ += time;
        monotonic_ += time;
        bus_.ns += time.count();
    }
    [[nodiscard]] std::uint32_t youngest_s() const {
        std::uint32_t youngest = VoxelAges::kAgeMax_s;
        pipeline_.map().for_each_known([&](VoxelKey key, float) {
            const auto seen = pipeline_.map().confirmation(key);
            if (seen) youngest = std::min(youngest, seen->age_s);
        });
        return youngest;
    }

    test::Scene scene_ = live_scene();
    Pipeline pipeline_ = test::make_pipeline(scene_);
    Nanoseconds boottime_ = 1000s;
    Nanoseconds monotonic_ = 500s;
    HostTime bus_{9'000'000'000};
    MapTime time_{[this] { return std::optional(at(boottime_)); },
                  SleepWatch([this] { return boottime_; }, [this] { return monotonic_; })};
};

TEST_F(SleepingMachine, has_the_map_older_by_that_at_once_and_until_its_next_measurement) {
    ASSERT_GT(pipeline_.map().known_voxels(), 0U);
    const std::uint32_t before_s = youngest_s();
    boottime_ += 600s;
    EXPECT_EQ(time_.attend(pipeline_, bus_), 600s);
    EXPECT_GE(youngest_s(), before_s + 600);
    EXPECT_LE(youngest_s(), before_s + 600 + 12) << "and by how long the bus was silent before";
    const std::uint32_t after_s = youngest_s();
    for (int i = 0; i < 100; ++i) {
        pass(50ms);
        EXPECT_EQ(time_.attend(pipeline_, bus_), 0s);
    }
    EXPECT_EQ(youngest_s(), after_s + 5);
    FusedMap saved = pipeline_.map().copy();
    pass(1s);
    MapTime next([this] { return std::optional(at(boottime_)); });
    const auto passed_s = next.begin_with(saved, time_.map_time());
    ASSERT_TRUE(passed_s);
    EXPECT_LE(*passed_s, 2) << "the sleep is in it already";
}

TEST_F(SleepingMachine, has_the_map_older_by_that_where_the_boot_is_not_known) {
    MapTime time([] { return std::optional<BootTime>(); },
                 SleepWatch([this] { return boottime_; }, [this] { return monotonic_; }));
    const std::uint32_t before_s = youngest_s();
    boottime_ += 600s + 1ms;
    EXPECT_EQ(time.attend(pipeline_, bus_), 600s + 1ms);
    EXPECT_EQ(youngest_s(), before_s + 601);
}

TEST_F(SleepingMachine, ends_the_order_of_a_recording_before_the_map_is_older) {
    class Ending final : public CommitListener {
      public:
        explicit Ending(std::function<std::uint32_t()> age) : age_(std::move(age)) {}
        void on_joints(const JointMeasurement&) override {}
        void on_reading(const RangeMeasurement&, const Beam&, std::span<const VoxelUpdate>) override {}
        void on_depth(const DepthFrame&, const Evidence&) override {}
        void on_time_jump() override { at_end.push_back(age_()); }
        std::vector<std::uint32_t> at_end;

      private:
        std::function<std::uint32_t()> age_;
    };
    Ending listener([this] { return youngest_s(); });
    pipeline_.set_listener(&listener);
    const std::uint32_t before_s = youngest_s();
    boottime_ += 2s;
    EXPECT_EQ(time_.attend(pipeline_, bus_), 2s);
    ASSERT_EQ(listener.at_end.size(), 1U);
    EXPECT_LE(listener.at_end.front(), before_s);
    EXPECT_GE(youngest_s(), before_s + 2);
    pipeline_.set_listener(nullptr);
}

TEST_F(SleepingMachine, goes_on_with_its_measurements_when_it_wakes) {
    boottime_ += 600s;
    (void)time_.attend(pipeline_, bus_);
    for (const StampedFrame& entry : scene_.bus.frames()) {
        StampedFrame later = entry;
        later.stamp.ns += 600'000'000'000;
        pipeline_.on_can(later.frame, later.stamp);
    }
    EXPECT_LT(youngest_s(), 600U) << "seen again";
}

TEST(MapTime, has_a_map_of_another_boot_stale_and_then_unknown_though_nothing_is_measured) {
    for (const auto& saved : {std::optional(at(190s, 1)), std::optional<BootTime>()}) {
        BootTime now = at(200s, 2);
        MapTime time([&now] { return std::optional(now); });
        FusedMap map = map_seen_at(1000s, {.stale_after_s = 10, .unknown_after_s = 60});
        EXPECT_FALSE(time.begin_with(map, saved));
        EXPECT_EQ(time.map_time(), now) << "what a save would say";
        for (const Nanoseconds later : {0s, 59s}) {
            now = at(200s + later, 2);
            (void)map.wait(*time.since_saved());
            EXPECT_EQ(map.known_voxels(), 1U);
            EXPECT_FALSE(age_s(map));
            EXPECT_TRUE(map.is_stale({32768, 32768, 32768}));
        }
        time.note(map, {});
        FusedMap next = map.copy();
        now = at(260s, 2);
        EXPECT_TRUE(map.wait(*time.since_saved()));
        EXPECT_EQ(map.known_voxels(), 0U);
        EXPECT_TRUE(time.begin_with(next, time.map_time())) << "the daemon begins anew meanwhile";
        EXPECT_EQ(next.known_voxels(), 0U);
    }
}

TEST_F(SleepingMachine, has_its_map_unknown_so_long_after_its_times_hold_no_more) {
    MapConfig config = scene_.mapping.map;
    config.age = {.stale_after_s = 10, .unknown_after_s = 60};
    pipeline_.limit_map(config);
    boottime_ += 30s;
    EXPECT_EQ(time_.attend(pipeline_, bus_), 30s) << "from when it is older already";
    ASSERT_LT(youngest_s(), VoxelAges::kAgeMax_s);
    time_.forget(pipeline_);
    EXPECT_EQ(youngest_s(), VoxelAges::kAgeMax_s);
    pass(59s);
    (void)time_.attend(pipeline_, bus_);
    EXPECT_GT(pipeline_.map().known_voxels(), 0U);
    pass(1s);
    (void)time_.attend(pipeline_, bus_);
    EXPECT_EQ(pipeline_.map().known_voxels(), 0U);
}

}  // namespace
}  // namespace octoskin
