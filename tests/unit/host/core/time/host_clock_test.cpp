#include "host/core/time/host_clock.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace octoskin {
namespace {

constexpr std::int64_t kMsNs = 1'000'000;

/// Host time 1000 ms is stamp 5'001'000 ms.
constexpr std::int64_t kOffsetMs = 5'000'000;
WallTime stamp_ms(std::int64_t host_ms, std::int64_t step_ms = 0) {
    return {(host_ms + kOffsetMs + step_ms) * kMsNs};
}
SyncStamp sync_ms(std::int64_t host_ms, std::int64_t step_ms = 0) {
    return {{host_ms * kMsNs}, stamp_ms(host_ms, step_ms)};
}

/// Four stamps in a row, 1 ms apart: as many as must agree on a jump.
void observe_four(HostClockEstimate& clock, std::int64_t host_ms, std::int64_t step_ms) {
    for (std::int64_t k = 0; k < 4; ++k) {
        clock.observe(stamp_ms(host_ms + k, step_ms));
    }
}

/// A bus that is not silent: a stamp every 100 ms after `from_ms`, and one at `to_ms`.
void observe_from_to(HostClockEstimate& clock, std::int64_t from_ms, std::int64_t to_ms,
                     std::int64_t step_ms = 0) {
    for (std::int64_t host_ms = from_ms + 100; host_ms < to_ms; host_ms += 100) {
        clock.observe(stamp_ms(host_ms, step_ms));
    }
    clock.observe(stamp_ms(to_ms, step_ms));
}

HostClockEstimate locked_at_ms(std::int64_t host_ms) {
    HostClockEstimate clock;
    clock.observe(stamp_ms(host_ms));
    clock.learn(sync_ms(host_ms));
    return clock;
}

TEST(HostClockEstimate, says_why_it_knows_no_time) {
    HostClockEstimate clock;
    EXPECT_EQ(clock.fault(), HostClockFault::no_exchange);
    clock.observe(stamp_ms(1000));
    EXPECT_EQ(clock.fault(), HostClockFault::no_exchange);
    clock.learn(sync_ms(1000));
    EXPECT_EQ(clock.fault(), std::nullopt);
    clock.observe(stamp_ms(1500));
    EXPECT_EQ(clock.fault(), HostClockFault::stamps_jumped) << "others may still show that it was wrong";
    observe_four(clock, 1501, 0);
    EXPECT_EQ(clock.fault(), HostClockFault::stamps_jumped);
    clock.learn(sync_ms(1504));
    EXPECT_EQ(clock.fault(), std::nullopt) << "the bus was silent";
    clock.observe(stamp_ms(1600));
    clock.learn({{1630 * kMsNs}, stamp_ms(1600)});
    EXPECT_EQ(clock.fault(), HostClockFault::exchanges_disagree);
    clock.observe(stamp_ms(1700));
    clock.learn({{1730 * kMsNs}, stamp_ms(1700)});
    EXPECT_EQ(clock.fault(), std::nullopt) << "two agree";
}

TEST(HostClockEstimate, knows_no_time_before_the_first_exchange) {
    HostClockEstimate clock;
    EXPECT_FALSE(clock.now().has_value());
    clock.observe(stamp_ms(1000));
    EXPECT_FALSE(clock.now().has_value());
    clock.learn(sync_ms(1000));
    EXPECT_EQ(clock.now()->ns, 1000 * kMsNs);
    clock.observe(stamp_ms(1123));
    EXPECT_EQ(clock.now()->ns, 1123 * kMsNs);
}

TEST(HostClockEstimate, does_not_go_back_for_stamps_slightly_out_of_order) {
    HostClockEstimate clock = locked_at_ms(1000);
    clock.observe(stamp_ms(1010));
    clock.observe(stamp_ms(1005));
    EXPECT_EQ(clock.now()->ns, 1010 * kMsNs);
    EXPECT_EQ(clock.steps_back(), 0U);
}

TEST(HostClockEstimate, knows_no_time_after_a_step_back_until_two_exchanges_agree) {
    HostClockEstimate clock = locked_at_ms(1000);
    constexpr std::int64_t kStep = -3'600'000;
    observe_four(clock, 1100, kStep);
    EXPECT_EQ(clock.steps_back(), 1U);
    EXPECT_FALSE(clock.now().has_value());
    observe_four(clock, 2000, kStep);
    clock.learn(sync_ms(2000, kStep));
    EXPECT_FALSE(clock.now().has_value());
    observe_four(clock, 3000, kStep);
    clock.learn(sync_ms(3000, kStep));
    EXPECT_EQ(clock.now()->ns, 3003 * kMsNs);
    EXPECT_EQ(clock.relocks(), 1U);
    EXPECT_EQ(clock.steps_back(), 1U);
}

TEST(HostClockEstimate, finds_a_step_forward_at_the_next_exchange) {
    HostClockEstimate clock = locked_at_ms(1000);
    constexpr std::int64_t kStep = 3'600'000;
    observe_four(clock, 1900, kStep);
    EXPECT_FALSE(clock.now().has_value());
    EXPECT_EQ(clock.steps_ahead(), 1U);
    clock.observe(stamp_ms(2000, kStep));
    clock.learn(sync_ms(2000, kStep));
    EXPECT_FALSE(clock.now().has_value());
    observe_four(clock, 3000, kStep);
    clock.learn(sync_ms(3000, kStep));
    EXPECT_EQ(clock.now()->ns, 3003 * kMsNs);
    EXPECT_EQ(clock.relocks(), 1U);
}

TEST(HostClockEstimate, learns_from_a_sync_that_is_the_first_to_tell_of_a_step) {
    for (const std::int64_t step : {3'600'000, -3'600'000}) {
        HostClockEstimate clock = locked_at_ms(1000);
        clock.observe(stamp_ms(1100));
        clock.observe(stamp_ms(1200, step));
        clock.learn(sync_ms(1200, step));
        observe_four(clock, 1201, step);
        observe_from_to(clock, 1204, 2200, step);
        clock.learn(sync_ms(2200, step));
        EXPECT_EQ(clock.now()->ns, 2200 * kMsNs);
    }
}

TEST(HostClockEstimate, is_not_moved_by_fewer_than_four_stamps_that_jump) {
    for (const std::int64_t step : {3'600'000, 501, 141, -6, -10, -3'600'000}) {
        HostClockEstimate clock = locked_at_ms(1000);
        for (const std::int64_t host_ms : {1000, 1000, 1000}) {
            clock.observe(stamp_ms(host_ms, step));
            EXPECT_FALSE(clock.now().has_value()) << "nothing is placed by such a stamp";
        }
        clock.observe(stamp_ms(1001));
        ASSERT_TRUE(clock.now().has_value());
        EXPECT_EQ(clock.now()->ns, 1001 * kMsNs);
        EXPECT_EQ(clock.steps_back() + clock.steps_ahead(), 0U);
        EXPECT_EQ(clock.stamps_ignored(), 3U);
    }
}

TEST(HostClockEstimate, takes_a_stamp_ahead_of_its_tolerance_for_a_jump_at_once) {
    HostClockEstimate clock = locked_at_ms(1000);
    clock.observe(stamp_ms(1140));
    EXPECT_EQ(clock.now()->ns, 1140 * kMsNs) << "a healthy bus may be silent for so long";
    clock.observe(stamp_ms(1281));
    EXPECT_FALSE(clock.now().has_value());
}

TEST(HostClockEstimate, goes_on_where_it_was_after_one_stamp_that_ran_ahead_within_the_tolerance) {
    for (std::int64_t ahead = 6; ahead <= 140; ++ahead) {
        HostClockEstimate clock = locked_at_ms(1000);
        clock.observe(stamp_ms(1000, ahead));
        for (std::int64_t k = 0; k < 4; ++k) {
            clock.observe(stamp_ms(1000 + k / 4));
        }
        ASSERT_TRUE(clock.now().has_value()) << ahead;
        EXPECT_EQ(clock.now()->ns, 1000 * kMsNs) << ahead;
        EXPECT_EQ(clock.stamps_ignored(), 1U);
        EXPECT_EQ(clock.steps_back() + clock.steps_ahead() + clock.relocks(), 0U);
    }
}

TEST(HostClockEstimate, takes_several_stamps_that_ran_ahead_for_a_step) {
    HostClockEstimate clock = locked_at_ms(1000);
    clock.observe(stamp_ms(1001, 100));
    clock.observe(stamp_ms(1002, 100));
    observe_four(clock, 1003, 0);
    EXPECT_FALSE(clock.now().has_value());
    EXPECT_EQ(clock.steps_back(), 1U);
    clock.learn(sync_ms(1004));
    EXPECT_EQ(clock.now()->ns, 1006 * kMsNs);
}

TEST(HostClockEstimate, finds_a_step_back_beyond_the_last_gap_between_two_stamps) {
    HostClockEstimate clock = locked_at_ms(1000);
    clock.observe(stamp_ms(1010));
    observe_four(clock, 1011, -17);  // 6 ms before the stamp before the last
    EXPECT_FALSE(clock.now().has_value());
    EXPECT_EQ(clock.steps_back(), 1U);
}

TEST(HostClockEstimate, does_not_learn_from_a_sync_whose_stamp_alone_ran_ahead) {
    HostClockEstimate clock = locked_at_ms(1000);
    clock.observe(stamp_ms(2000, 0));  // a silent second: in doubt until the exchange
    observe_four(clock, 2000, 0);
    clock.learn(sync_ms(2001));
    clock.observe(stamp_ms(2010, 100));
    clock.observe(stamp_ms(2011));  // its FOLLOW_UP
    clock.learn(sync_ms(2010, 100));
    for (std::int64_t k = 0; k < 3; ++k) {
        clock.observe(stamp_ms(2012 + k));
    }
    ASSERT_TRUE(clock.now().has_value());
    EXPECT_EQ(clock.now()->ns, 2014 * kMsNs);
}

TEST(HostClockEstimate, does_not_learn_from_a_sync_whose_stamp_alone_jumped) {
    for (const std::int64_t step : {3'600'000, -3'600'000}) {
        HostClockEstimate clock = locked_at_ms(1000);
        observe_from_to(clock, 1000, 1450);
        clock.observe(stamp_ms(1500, step));
        clock.observe(stamp_ms(1501));
        clock.learn(sync_ms(1500, step));
        ASSERT_TRUE(clock.now().has_value());
        EXPECT_EQ(clock.now()->ns, 1501 * kMsNs);
    }
}

TEST(HostClockEstimate, goes_on_at_the_next_exchange_after_a_silent_bus) {
    HostClockEstimate clock = locked_at_ms(1000);
    observe_four(clock, 8000, 0);
    EXPECT_FALSE(clock.now().has_value());
    clock.learn(sync_ms(8003));
    EXPECT_EQ(clock.now()->ns, 8003 * kMsNs);
    EXPECT_EQ(clock.relocks(), 0U);
}

TEST(HostClockEstimate, computes_no_absurd_time_from_absurd_stamps) {
    constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
    constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
    constexpr HostTime kHostMost{((std::int64_t{1} << 48) - 1) * 1000};
    for (const std::int64_t first : {kMost, kLeast, std::int64_t{0}}) {
        for (const std::int64_t then : {kMost, kLeast, std::int64_t{0}}) {
            for (const HostTime host : {kHostMost, HostTime{0}}) {
                HostClockEstimate clock;
                clock.observe({first});
                clock.learn({host, {first}});
                EXPECT_EQ(clock.now(), host);
                for (int k = 0; k < 4; ++k) {
                    clock.observe({then});
                    clock.learn({host, {then}});
                }
                EXPECT_EQ(clock.now(), host) << "two exchanges agree";  // oracle: UBSan sees no overflow
            }
        }
    }
}

TEST(HostClockEstimate, counts_how_long_frames_came_whoever_tells_the_time) {
    const auto running_ms = [](const HostClockEstimate& clock) { return clock.running().count() / kMsNs; };
    HostClockEstimate clock;  // nobody does
    clock.observe(stamp_ms(1000));
    EXPECT_EQ(running_ms(clock), 0);
    observe_from_to(clock, 1000, 2000);
    EXPECT_EQ(running_ms(clock), 1000);
    clock.observe(stamp_ms(1996));
    EXPECT_EQ(running_ms(clock), 1000) << "slightly out of order";
    for (const std::int64_t step : {3'600'000, -3'600'000}) {
        const std::int64_t before_ms = running_ms(clock);
        observe_four(clock, 2001, step);
        EXPECT_EQ(running_ms(clock), before_ms + 3) << step;
        observe_from_to(clock, 2004, 2100, step);
        EXPECT_EQ(running_ms(clock), before_ms + 99) << step;
    }
}

TEST(HostClockEstimate, takes_back_what_a_stamp_that_ran_ahead_added_to_how_long_frames_came) {
    HostClockEstimate clock;
    observe_from_to(clock, 1000, 2000);
    clock.observe(stamp_ms(2001, 130));
    EXPECT_EQ(clock.running().count(), 1031 * kMsNs);
    observe_four(clock, 2002, 0);
    EXPECT_EQ(clock.running().count(), 905 * kMsNs);
    EXPECT_EQ(clock.stamps_ignored(), 1U);
}

TEST(HostClockEstimate, is_not_moved_by_one_wrong_follow_up) {
    HostClockEstimate clock = locked_at_ms(1000);
    observe_from_to(clock, 1000, 2000);
    clock.learn({{99'999 * kMsNs}, stamp_ms(2000)});
    EXPECT_FALSE(clock.now().has_value());
    observe_from_to(clock, 2000, 3000);
    clock.learn(sync_ms(3000));
    EXPECT_EQ(clock.now()->ns, 3000 * kMsNs);
    EXPECT_EQ(clock.relocks(), 0U);
}

TEST(HostClockEstimate, follows_a_slow_drift_of_the_wall_clock) {
    HostClockEstimate clock = locked_at_ms(1000);
    for (std::int64_t k = 2; k < 100; ++k) {
        observe_from_to(clock, 1000 * (k - 1), 1000 * k, k);  // 1000 ppm
        clock.learn(sync_ms(1000 * k, k));
        EXPECT_EQ(clock.now()->ns, 1000 * k * kMsNs);
    }
}

}  // namespace
}  // namespace octoskin
