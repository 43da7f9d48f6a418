#include "firmware/core/period_trim.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr Microseconds kConfigured{33'000};
constexpr NodeTime kNow{1'000'000};

MeasuredPeriod certain(std::int64_t us) {
    return {.value = Microseconds{us}, .uncertainty = Microseconds{30}};
}

TEST(PeriodTrim, asks_for_more_of_a_part_that_is_fast_and_less_of_one_that_is_slow) {
    PeriodTrim fast{kConfigured, kPolicy};
    EXPECT_EQ(fast.commanded(), Microseconds{33'000});
    EXPECT_TRUE(fast.wants_trim(certain(30'690), kNow));  // 7 % fast
    EXPECT_EQ(fast.commanded(), Microseconds{35'483});    // 33000 * 33000 / 30690 = 35483.9

    PeriodTrim slow{kConfigured, kPolicy};
    EXPECT_TRUE(slow.wants_trim(certain(35'310), kNow));
    EXPECT_EQ(slow.commanded(), Microseconds{30'841});  // 33000 * 33000 / 35310 = 30841.1
}

TEST(PeriodTrim, leaves_a_period_within_half_a_percent_alone) {
    PeriodTrim trim{kConfigured, kPolicy};
    EXPECT_FALSE(trim.wants_trim(certain(33'165), kNow));
    EXPECT_FALSE(trim.wants_trim(certain(32'835), kNow));
    EXPECT_TRUE(trim.wants_trim(certain(33'166), kNow));
}

TEST(PeriodTrim, does_not_act_on_a_measurement_less_certain_than_half_the_tolerance) {
    PeriodTrim trim{kConfigured, kPolicy};
    const MeasuredPeriod vague{.value = Microseconds{35'310}, .uncertainty = Microseconds{83}};
    EXPECT_FALSE(trim.wants_trim(vague, kNow));
}

TEST(PeriodTrim, trims_twice_at_the_start_and_then_once_a_minute) {
    PeriodTrim trim{kConfigured, kPolicy};
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow));
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow + Microseconds{500'000}));
    EXPECT_FALSE(trim.wants_trim(certain(34'000), kNow + Microseconds{1'000'000}));
    EXPECT_FALSE(trim.wants_trim(certain(34'000), kNow + Microseconds{60'499'999}));
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow + Microseconds{60'500'000}));
    EXPECT_FALSE(trim.wants_trim(certain(34'000), kNow + Microseconds{61'000'000}));
}

TEST(PeriodTrim, trims_at_once_after_forty_minutes_at_rest) {
    // Longer than half the clock's range, when the last trim looks like one to come.
    PeriodTrim trim{kConfigured, kPolicy};
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow));
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow));
    EXPECT_FALSE(trim.wants_trim(certain(34'000), kNow));
    EXPECT_TRUE(trim.wants_trim(certain(34'000), kNow + Microseconds{2'400'000'000}));
}

TEST(PeriodTrim, refines_by_whole_steps_of_the_register_to_the_nearest) {
    constexpr Nanoseconds kStep{25'000};
    for (int walk_us = -500; walk_us <= 500; ++walk_us) {
        PeriodTrim trim{kConfigured, kPolicy};
        const Nanoseconds walk{walk_us * 1'000};
        const Nanoseconds left = trim.refine(walk, kStep);
        EXPECT_LE(std::abs(left.count()), kStep.count() / 2) << walk_us;
        EXPECT_EQ((walk - left) % kStep, Nanoseconds{0}) << walk_us;
        // As the register has it, which rounds down.
        const std::int64_t value = Nanoseconds{trim.commanded()} / kStep;
        EXPECT_EQ(value, Nanoseconds{kConfigured} / kStep - (walk - left) / kStep) << walk_us;
        EXPECT_LT(trim.uncertainty_permille(), kPolicy.period_expected_permille);
    }
}

TEST(PeriodTrim, is_refined_from_the_second_time_on) {
    const Policy policy;
    PeriodTrim trim{Microseconds{33'000}, policy};
    for (const bool is_refined : {false, false, true, true}) {
        EXPECT_EQ(trim.is_refined(), is_refined);
        (void)trim.refine(Nanoseconds{0}, Nanoseconds{25'000});
    }
}

TEST(PeriodTrim, refines_by_as_many_steps_wherever_between_two_values_it_stands) {
    constexpr Nanoseconds kStep{25'141};
    for (int trimmed_us = 32'500; trimmed_us <= 33'500; ++trimmed_us) {
        PeriodTrim trim{kConfigured, kPolicy};
        ASSERT_EQ(trim.wants_trim(certain(trimmed_us), kNow), std::abs(trimmed_us - 33'000) > 165)
            << trimmed_us;
        for (const int steps : {1, 1, -2, 3, -1}) {
            const std::int64_t before = Nanoseconds{trim.commanded()} / kStep;
            (void)trim.refine(steps * kStep, kStep);
            EXPECT_EQ(Nanoseconds{trim.commanded()} / kStep, before - steps) << trimmed_us;
        }
    }
}

TEST(PeriodTrim, refines_no_farther_than_an_oscillator_can_be_off_and_tells_what_is_left) {
    PeriodTrim trim{kConfigured, kPolicy};
    constexpr Microseconds kStep{25};
    const auto refine = [&](Microseconds walk) {
        const Microseconds before = trim.commanded();
        const Nanoseconds left = trim.refine(walk, kStep);
        EXPECT_EQ(left, walk - (before / kStep - trim.commanded() / kStep) * kStep);
    };
    for (int i = 0; i < 10; ++i) refine(Microseconds{4'950});
    EXPECT_EQ(trim.commanded(), Microseconds{33'000 * 85 / 100});
    EXPECT_EQ(trim.uncertainty_permille(), kPolicy.period_expected_permille) << "what part is that?";
    for (int i = 0; i < 20; ++i) refine(Microseconds{-4'950});
    EXPECT_EQ(trim.commanded(), Microseconds{33'000 * 115 / 100});
}

TEST(PeriodTrim, takes_a_doubled_period_for_a_slot_too_short_and_lengthens_it) {
    // 20 ms asked for, a part 7 % fast makes 18.6 ms, too short for a 15 ms budget: every second slot is
    // used.
    PeriodTrim trim{Microseconds{20'000}, kPolicy};
    const MeasuredPeriod doubled{.value = Microseconds{37'200}, .uncertainty = Microseconds{30}};
    EXPECT_TRUE(trim.wants_trim(doubled, kNow));
    EXPECT_EQ(trim.commanded(), Microseconds{21'505});  // 20000 * 20000 / 18600 = 21505.4
    EXPECT_EQ(trim.error_permille(Microseconds{37'200}), 860);
}

TEST(PeriodTrim, never_asks_for_more_than_fifteen_percent_off) {
    PeriodTrim trim{kConfigured, kPolicy};
    EXPECT_TRUE(trim.wants_trim(certain(22'000), kNow));
    EXPECT_EQ(trim.commanded(), Microseconds{37'950});  // 33000 * 1.15
}

TEST(PeriodTrim, keeps_what_it_knows_of_the_part_when_another_period_is_wanted) {
    PeriodTrim trim{kConfigured, kPolicy};
    EXPECT_EQ(trim.uncertainty_permille(), 80);
    EXPECT_TRUE(trim.wants_trim(certain(35'310), kNow));
    EXPECT_EQ(trim.uncertainty_permille(), 10);
    trim.set_configured(Microseconds{50'000});
    EXPECT_EQ(trim.commanded(), Microseconds{46'728});  // 50000 * 33000 / 35310, the factor cut to ppm
}

}  // namespace
}  // namespace octoskin::node
