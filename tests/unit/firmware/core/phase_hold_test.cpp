// Oracle: a sensor that walks by a known time each period, in plain 64-bit arithmetic.
#include "firmware/core/phase_hold.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <utility>

#include "firmware/core/phase_clock.hpp"

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;
constexpr Microseconds kPeriod{33'000};
constexpr Microseconds kTolerance = kPolicy.phase_tolerance;
constexpr Microseconds kStartOff = kPolicy.phase_start_off;
constexpr Nanoseconds kStep{25'000};

/// A run of ranges, each known to lie within 100 us, somewhere.
class Walker {
  public:
    Walker(PhaseHold& hold, std::int64_t off_us, std::int64_t walk_ns, std::uint32_t first_us,
           Microseconds start_took = Microseconds{300})
        : hold_(hold), off_ns_(off_us * 1'000), walk_ns_(walk_ns), first_us_(first_us) {
        const NodeTime started{first_us - 33'000U};
        hold_.restart({.at = {started, started + start_took},
                       .off = Microseconds{off_us},
                       .period = kPeriod,
                       .step = kStep,
                       .is_trimmed = true});
    }
    void range() {
        const std::int64_t into_ns = off_ns_ + periods_ * walk_ns_;
        const auto us = static_cast<std::uint32_t>(first_us_ + periods_ * kPeriod.count() + into_ns / 1'000);
        const auto before = static_cast<std::uint32_t>(random_() % 100);
        hold_.observe({NodeTime{us - before}, NodeTime{us + 100 - before}});
        ++periods_;
    }
    [[nodiscard]] std::int64_t off_us() const { return (off_ns_ + (periods_ - 1) * walk_ns_) / 1'000; }
    void miss(int ranges) { periods_ += ranges; }

  private:
    PhaseHold& hold_;
    std::int64_t off_ns_;
    std::int64_t walk_ns_;
    std::int64_t first_us_;
    std::int64_t periods_ = 0;
    std::mt19937 random_{5};
};

TEST(PhaseHold, tells_a_sensor_that_walked_too_far_and_no_other) {
    for (std::int64_t walk_ns = -12'500; walk_ns <= 12'500; walk_ns += 500) {
        PhaseHold hold{kPolicy};
        Walker walker{hold, 0, walk_ns, 0xFFFFFFFFU - 1'000'000U};  // over the clock's wrap
        for (int i = 0; i < 600; ++i) {
            walker.range();
            const std::int64_t off_us = std::abs(walker.off_us());
            // Two times are each known to 50 us.
            if (std::abs(off_us - kTolerance.count()) <= 100) continue;
            EXPECT_EQ(hold.is_lost(), off_us > kTolerance.count()) << walk_ns << ' ' << i;
        }
    }
}

TEST(PhaseHold, counts_from_where_the_sensor_was_started) {
    PhaseHold hold{kPolicy};
    const std::int64_t start_us = kStartOff.count();
    Walker walker{hold, start_us, -6'000, 0};
    int ranges = 0;
    for (; !hold.is_lost(); ++ranges) walker.range();
    EXPECT_NEAR(ranges, static_cast<double>(start_us + kTolerance.count()) / 6.0, 100.0 / 6.0);
    // The first time and the last are each known to 50 us.
    EXPECT_NEAR(static_cast<double>(hold.walk().count()), -6'000.0, 100'000.0 / ranges);
}

TEST(PhaseHold, keeps_counting_over_ranges_that_were_missed) {
    PhaseHold hold{kPolicy};
    Walker walker{hold, 0, 4'000, 0};
    for (int i = 0; i < 10; ++i) {
        walker.range();
        walker.miss(9);
    }
    walker.range();
    EXPECT_TRUE(hold.is_lost());
    EXPECT_NEAR(static_cast<double>(hold.walk().count()), 4'000.0, 1'000.0);
}

TEST(PhaseHold, does_not_start_a_sensor_anew_within_a_few_ranges) {
    PhaseHold hold{kPolicy};
    Walker walker{hold, 0, 1'000'000, 0};
    for (std::int64_t i = 0; i <= kPolicy.phase_periods_min; ++i) {
        EXPECT_FALSE(hold.is_lost()) << i;
        walker.range();
    }
    EXPECT_TRUE(hold.is_lost());
}

TEST(PhaseHold, starts_a_sensor_that_no_start_helps_ever_more_rarely_and_one_that_it_helps_more_often) {
    PhaseHold hold{kPolicy};
    const auto periods_until_lost = [&hold](std::int64_t walk_ns, int at_most) {
        Walker walker{hold, 0, walk_ns, 0};
        int periods = -1;
        while (!hold.is_lost() && periods < at_most) {
            walker.range();
            ++periods;
        }
        return periods;
    };
    std::int64_t walk_ns = 40'000;
    for (const int expected : {16, 16, 16, 16, 32, 64, 128, 256, 512, 1'024, 1'024, 1'024})
        EXPECT_EQ(periods_until_lost(walk_ns = -walk_ns, 2'000), expected);
    // By 9 us a period it is where it may be after 16 of them, and not after 32.
    for (const int expected : {512, 256, 128, 64, 32}) EXPECT_EQ(periods_until_lost(9'000, 2'000), expected);
    const double periods = static_cast<double>(kTolerance.count()) / 9.0;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(periods_until_lost(9'000, 2'000), periods, 7) << "known to 50 us";
}

TEST(PhaseHold, leaves_a_sensor_that_skips_its_slots_alone) {
    PhaseHold hold{kPolicy};
    Walker walker{hold, 0, 6'000'000, 0};
    for (int i = 0; i < 100; ++i) walker.range();
    EXPECT_FALSE(hold.is_lost());
}

TEST(PhaseHold, counts_the_walk_before_the_first_range_that_is_well_known) {
    PhaseHold hold{kPolicy};
    std::uint32_t first_us = 0;
    for (int run = 0; run < 16; ++run) {
        Walker walker{hold, -130, 9'000, first_us};
        for (int i = 0; i < 70; ++i) walker.range();
        hold.expect_walk(hold.walk());
        first_us += 10'000'000;
    }
    Walker walker{hold, -130, 9'000, first_us};
    int ranges = 20;
    walker.miss(ranges);
    for (; !hold.is_lost() && ranges < 200; ++ranges) walker.range();
    EXPECT_NEAR(ranges, (130.0 + static_cast<double>(kTolerance.count())) / 9.0, 80.0 / 9.0);
}

TEST(PhaseHold, knows_the_walk_of_many_runs_better_than_that_of_one) {
    PhaseHold hold{kPolicy};
    for (std::uint32_t run = 0; run < 20; ++run) {
        Walker walker{hold, -130, 3'000, 10'000'000 * run};
        for (int i = 0; i < 17; ++i) walker.range();
        hold.expect_walk(hold.walk());
    }
    EXPECT_NEAR(static_cast<double>(hold.walk().count()), 3'000.0, 1'500.0) << "one tells it to 6 us";
}

TEST(PhaseHold, believes_the_sensor_where_it_does_not_walk_as_the_runs_before_it) {
    PhaseHold hold{kPolicy};
    {
        Walker walker{hold, 0, 0, 0};
        for (int i = 0; i < 70; ++i) walker.range();
        hold.expect_walk(hold.walk());
    }
    Walker walker{hold, 0, 500'000, 10'000'000};
    for (int i = 0; i < 17; ++i) walker.range();
    EXPECT_TRUE(hold.is_lost());
    EXPECT_NEAR(static_cast<double>(hold.walk().count()), 500'000.0, 10'000.0);
}

TEST(PhaseHold, counts_from_the_first_range_where_nobody_knows_when_the_sensor_started) {
    for (const std::int64_t held_up_us : {700, 7'000, 16'000, 20'000}) {
        PhaseHold hold{kPolicy};
        {
            Walker walker{hold, 0, 0, 0};
            for (int i = 0; i < 30; ++i) walker.range();
        }
        // Begun in its phase, kept waiting in the middle.
        hold.restart({.at = {NodeTime{10'000'000}, NodeTime{10'030'000}},
                      .off = Microseconds{0},
                      .period = kPeriod,
                      .is_trimmed = true});
        for (int i = 1; i <= 20; ++i) {
            const auto us = static_cast<std::uint32_t>(10'000'000 + i * kPeriod.count() + held_up_us);
            hold.observe({NodeTime{us - 50}, NodeTime{us + 50}});
        }
        EXPECT_TRUE(hold.is_lost()) << held_up_us;
        EXPECT_NEAR(static_cast<double>(hold.walk().count()), 0.0, 5'000.0) << held_up_us;
    }
}

// Too long after the last one, a range may be any of several.
TEST(PhaseHold, counts_anew_after_ranges_nobody_counted) {
    PhaseHold hold{kPolicy};
    Walker walker{hold, 0, 300'000, 0};
    for (int i = 0; i < 5; ++i) walker.range();
    walker.miss(70);  // and walked by more than half a period
    for (int i = 0; i < 20; ++i) walker.range();
    EXPECT_NEAR(static_cast<double>(hold.walk().count()), 300'000.0, 10'000.0);
}

TEST(PhaseHold, learns_nothing_from_a_time_that_is_hardly_known) {
    PhaseHold hold{kPolicy};
    Walker walker{hold, 0, 0, 0};
    for (int i = 0; i < 30; ++i) walker.range();
    hold.observe({NodeTime{30 * 33'000}, NodeTime{30 * 33'000 + 10'000}});
    EXPECT_FALSE(hold.is_lost());
}

TEST(PhaseHold, starts_on_the_far_side_and_who_hardly_walks_near_its_phase) {
    PhaseHold hold{kPolicy};
    hold.restart({{NodeTime{0}, NodeTime{0}}, Microseconds{0}, kPeriod});
    EXPECT_EQ(hold.start_off(Nanoseconds{0}), Microseconds{0});
    EXPECT_EQ(hold.start_off(Nanoseconds{1'000}), Microseconds{-32});
    EXPECT_EQ(hold.start_off(Nanoseconds{-1'000}), Microseconds{32});
    EXPECT_EQ(hold.start_off(Nanoseconds{12'500}), -kStartOff);
    EXPECT_EQ(hold.start_off(Nanoseconds{-12'500}), kStartOff);
}

// Nothing mends half a step of the register; who walks by two thirds may not be known to do so.
TEST(PhaseHold, never_tires_of_a_sensor_that_walks_by_less_than_a_step) {
    constexpr std::int64_t kWalkUs = 17;
    constexpr Microseconds kShort{20'000};
    for (unsigned seed = 0; seed < 20; ++seed) {
        PhaseHold hold{kPolicy};
        std::mt19937 random{seed};
        std::uniform_int_distribution<std::int64_t> unknown_us{-100, 100};
        for (std::uint32_t run = 0; run < 200; ++run) {
            const NodeTime started{run * 10'000'000U};
            hold.restart({.at = {started, started + Microseconds{300}},
                          .off = -kPolicy.phase_start_off,
                          .period = kShort,
                          .step = kStep,
                          .is_trimmed = true});
            int periods = 0;
            for (; !hold.is_lost() && periods < 200; ++periods) {
                const Microseconds into{(periods + 1) * (kShort.count() + kWalkUs) + unknown_us(random)};
                hold.observe({started + into - Microseconds{100}, started + into + Microseconds{100}});
            }
            ASSERT_LT(periods, 48) << "run " << run << ", seed " << seed;
            hold.expect_walk(hold.walk());
        }
    }
}

// The first range's time is known badly, those after it better: what is held is where they are.
TEST(PhaseHold, counts_from_the_first_range_that_is_known_well_if_one_comes_soon) {
    constexpr std::int64_t kWrongUs = 200;
    for (const std::int64_t wrong : {-kWrongUs, kWrongUs}) {
        PhaseHold hold{kPolicy};
        std::uint32_t from_us = 0;
        for (int run = 0; run < 8; ++run, from_us += 10'000'000) {
            const NodeTime started{from_us};
            hold.restart({.at = {started, started + Microseconds{300}},
                          .off = Microseconds{0},
                          .period = kPeriod,
                          .is_trimmed = true});
            const auto observe = [&](std::int64_t period, std::int64_t off_us, std::int64_t half_width_us) {
                const NodeTime at = started + kPeriod * period + Microseconds{off_us};
                hold.observe({at - Microseconds{half_width_us}, at + Microseconds{half_width_us}});
            };
            observe(1, run == 0 ? wrong : 0, kWrongUs);
            for (std::int64_t period = 2; period < 40; ++period) observe(period, 0, 40);
            EXPECT_FALSE(hold.is_lost()) << wrong << ' ' << run;
            EXPECT_EQ(hold.walk(), Nanoseconds{0}) << wrong << ' ' << run;
        }
    }
}

TEST(PhaseClock, goes_on_over_the_wrap_and_knows_times_before_and_after) {
    PhaseClock clock{NodeTime{0xFFFFFF00U}};
    std::uint64_t expected = 0xFFFFFF00U;
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(clock.us_at(NodeTime{static_cast<std::uint32_t>(expected + 1'000)}), expected + 1'000);
        EXPECT_EQ(clock.us_at(NodeTime{static_cast<std::uint32_t>(expected - 1'000)}), expected - 1'000);
        expected += 2'000'000'000;
        clock.advance(NodeTime{static_cast<std::uint32_t>(expected)});
    }
    EXPECT_GT(expected, std::uint64_t{4} << 32U);
}

}  // namespace
}  // namespace octoskin::node
