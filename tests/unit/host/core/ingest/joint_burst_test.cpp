#include "host/core/ingest/joint_burst.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kRateHz = 100.0;
using Turn = JointBurst::Turn;

WallTime at(double ms) {
    return {static_cast<std::int64_t>(ms * kMs)};
}

/// Those samples that are used, as {when it came, how long it waited}, looked at each eighth of a
/// millisecond.
std::vector<std::pair<double, double>> turns_of(const std::vector<double>& came_ms, double rate_hz) {
    JointBurst burst(rate_hz);
    std::vector<std::pair<double, double>> used;
    std::size_t oldest = 0;
    std::size_t there = 0;
    for (double now = 0; now <= came_ms.back() + 21; now += 0.125) {
        while (there < came_ms.size() && came_ms[there] <= now) ++there;
        while (oldest < there) {
            const auto next = oldest + 1 < there ? std::optional(at(came_ms[oldest + 1])) : std::nullopt;
            const Turn turn = burst.turn_of(at(came_ms[oldest]), next, at(now));
            if (turn == Turn::wait) break;
            if (turn == Turn::use) used.emplace_back(came_ms[oldest], now - came_ms[oldest]);
            ++oldest;
        }
    }
    return used;
}

std::vector<double> used_of(const std::vector<double>& came_ms) {
    std::vector<double> used;
    for (const auto& [came, waited] : turns_of(came_ms, kRateHz)) used.push_back(came);
    return used;
}

// However slow: what comes at its rate, give or take 15 % of a period, follows no gap.
TEST(JointBurst, is_none_in_a_stream_at_its_rate_and_holds_up_but_the_first_and_that_for_20_ms) {
    for (const double rate_hz : {1.0, 5.0, 10.0, 12.0, 14.5, 15.0, 16.0, 20.0, 50.0, 100.0, 1000.0}) {
        std::vector<double> came;
        for (int i = 0; i < 40; ++i) came.push_back((i + 0.15 * (i % 3 - 1)) * 1000.0 / rate_hz + 1000.0);
        const auto used = turns_of(came, rate_hz);
        ASSERT_EQ(used.size(), came.size()) << rate_hz;
        EXPECT_LE(used.front().second, 20.125) << rate_hz;
        for (std::size_t i = 1; i < used.size(); ++i) EXPECT_LT(used[i].second, 0.125) << rate_hz << ' ' << i;
    }
}

TEST(JointBurst, is_behind_a_gap_of_over_one_and_a_half_periods_where_these_are_long) {
    using Waits = std::vector<std::pair<double, double>>;
    EXPECT_EQ(turns_of({0, 149, 150}, 10.0), (Waits{{0, 20}, {149, 0}, {150, 0}}));
    EXPECT_EQ(turns_of({0, 151, 152}, 10.0), (Waits{{0, 20}, {152, 19}}));
}

TEST(JointBurst, is_none_in_a_stream_however_dense_nor_behind_a_short_gap) {
    for (const double period_ms : {1.0, 2.0, 10.0, 20.0, 50.0}) {
        std::vector<double> came;
        for (int i = 0; i < 100; ++i) came.push_back(i * period_ms);
        const std::vector<double> used = used_of(came);
        // The first ones come behind a gap.
        for (std::size_t i = 0; i < used.size(); ++i)
            EXPECT_EQ(used[used.size() - 1 - i], came[came.size() - 1 - i]) << period_ms;
        EXPECT_GE(used.size() + 7, came.size()) << period_ms;
    }
    EXPECT_EQ(used_of({0, 10, 55, 55.125, 65}), (std::vector<double>{0, 10, 55, 55.125, 65}));
}

TEST(JointBurst, behind_a_gap_gives_its_newest_alone) {
    EXPECT_EQ(used_of({0, 120, 120.125, 120.25, 125}), (std::vector<double>{0, 125}));
    EXPECT_EQ(used_of({0, 120, 120.125, 130, 140}), (std::vector<double>{0, 120.125, 130, 140}));
    EXPECT_EQ(used_of({0, 120}), (std::vector<double>{0, 120})) << "none follows it";
}

TEST(JointBurst, ends_though_samples_go_on_to_come_close_together) {
    std::vector<double> came{0};
    for (int ms = 100; ms < 200; ++ms) came.push_back(ms);
    const std::vector<double> used = used_of(came);
    EXPECT_EQ(used.at(1), 107) << "the newest within 7.5 ms of the first";
    EXPECT_EQ(used.size(), 2 + 92U);
}

TEST(JointBurst, is_none_of_a_sample_with_a_time) {
    JointBurst burst(kRateHz);
    EXPECT_EQ(burst.use(at(1000)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1010), std::nullopt, at(1010)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1100), std::nullopt, at(1100)), Turn::wait);
    EXPECT_EQ(burst.use(at(1101)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1102), std::nullopt, at(1102)), Turn::use);
}

TEST(JointBurst, waits_for_nothing_where_the_clock_is_set_back) {
    JointBurst burst(kRateHz);
    EXPECT_EQ(burst.turn_of(at(1000), std::nullopt, at(1000)), Turn::wait);
    EXPECT_EQ(burst.turn_of(at(1000), std::nullopt, at(10)), Turn::use);
}

}  // namespace
}  // namespace octoskin
