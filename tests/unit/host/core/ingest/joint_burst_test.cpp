#include "host/core/ingest/joint_burst.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr Nanoseconds kLasts{75 * kMs / 10};
using Turn = JointBurst::Turn;

WallTime at(double ms) {
    return {static_cast<std::int64_t>(ms * kMs)};
}

/// When those samples came that are used, looked at whenever one comes and each millisecond.
std::vector<double> used_of(const std::vector<double>& came_ms) {
    JointBurst burst(kLasts);
    std::vector<double> used;
    std::size_t oldest = 0;
    std::size_t there = 0;
    for (double now = 0; now <= came_ms.back() + 20; now += 0.125) {
        while (there < came_ms.size() && came_ms[there] <= now) ++there;
        while (oldest < there) {
            const auto next = oldest + 1 < there ? std::optional(at(came_ms[oldest + 1])) : std::nullopt;
            const Turn turn = burst.turn_of(at(came_ms[oldest]), next, at(now));
            if (turn == Turn::wait) break;
            if (turn == Turn::use) used.push_back(came_ms[oldest]);
            ++oldest;
        }
    }
    return used;
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
    JointBurst burst(kLasts);
    EXPECT_EQ(burst.use(at(1000)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1010), std::nullopt, at(1010)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1100), std::nullopt, at(1100)), Turn::wait);
    EXPECT_EQ(burst.use(at(1101)), Turn::use);
    EXPECT_EQ(burst.turn_of(at(1102), std::nullopt, at(1102)), Turn::use);
}

TEST(JointBurst, waits_for_nothing_where_the_clock_is_set_back) {
    JointBurst burst(kLasts);
    EXPECT_EQ(burst.turn_of(at(1000), std::nullopt, at(1000)), Turn::wait);
    EXPECT_EQ(burst.turn_of(at(1000), std::nullopt, at(10)), Turn::use);
}

}  // namespace
}  // namespace octoskin
