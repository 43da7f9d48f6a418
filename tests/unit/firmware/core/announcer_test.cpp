#include "firmware/core/announcer.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

struct Said {
    std::vector<std::int64_t> heartbeats_us;
    std::map<wire::InfoPage, std::vector<std::int64_t>> pages_us;
    std::map<std::uint8_t, std::vector<std::int64_t>> health_us;
};

/// Everything said at once when due, asked every millisecond from `start` for `ms`.
Said listen(Announcer& announcer, NodeTime start, std::int64_t ms) {
    Said said;
    for (std::int64_t us = 0; us < ms * 1'000; us += 1'000) {
        announcer.update(start + Microseconds{us});
        if (announcer.is_heartbeat_due()) {
            said.heartbeats_us.push_back(us);
            announcer.heartbeat_sent();
        }
        while (const auto page = announcer.info_page_due()) {
            said.pages_us[*page].push_back(us);
            announcer.info_sent(*page);
        }
        while (const auto sensor = announcer.health_due()) {
            said.health_us[*sensor].push_back(us);
            announcer.health_sent(*sensor);
        }
    }
    return said;
}

TEST(Announcer, beats_ten_times_a_second_from_the_start) {
    Announcer announcer{3, kPolicy, {0}};
    const Said said = listen(announcer, {0}, 1'000);
    EXPECT_EQ(said.heartbeats_us, (std::vector<std::int64_t>{0, 100'000, 200'000, 300'000, 400'000, 500'000,
                                                             600'000, 700'000, 800'000, 900'000}));
}

TEST(Announcer, sends_all_info_pages_at_the_start_and_each_once_a_second) {
    Announcer announcer{3, kPolicy, {0}};
    const Said said = listen(announcer, {0}, 3'000);
    EXPECT_EQ(said.pages_us.size(), 7U);
    for (const auto& [page, times_us] : said.pages_us) {
        ASSERT_GE(times_us.size(), 3U) << static_cast<int>(page);
        EXPECT_EQ(times_us[0], 0);
        EXPECT_NEAR(static_cast<double>(times_us[2] - times_us[1]), 1e6, 2'000.0);
    }
}

TEST(Announcer, spreads_the_sensors_healths_evenly_over_each_second) {
    Announcer announcer{17, kPolicy, {0}};
    const Said said = listen(announcer, {0}, 2'000);
    EXPECT_EQ(said.health_us.size(), 17U);
    for (const auto& [sensor, times_us] : said.health_us) {
        EXPECT_NEAR(static_cast<double>(times_us.at(0)), 1e6 * (sensor + 1) / 17.0, 1'100.0);
    }
}

TEST(Announcer, sends_a_health_at_once_when_asked) {
    Announcer announcer{17, kPolicy, {0}};
    announcer.request_health(11);
    const Said said = listen(announcer, {0}, 50);
    EXPECT_EQ(said.health_us.size(), 1U);
    EXPECT_EQ(said.health_us.at(11), (std::vector<std::int64_t>{0}));
}

TEST(Announcer, repeats_everything_on_request) {
    Announcer announcer{4, kPolicy, {0}};
    (void)listen(announcer, {0}, 10);
    announcer.request_all();
    const Said said = listen(announcer, {10'000}, 10);
    EXPECT_EQ(said.pages_us.size(), 7U);
    EXPECT_EQ(said.health_us.size(), 4U);
}

TEST(Announcer, does_not_catch_up_on_heartbeats_after_a_pause) {
    Announcer announcer{1, kPolicy, {0}};
    (void)listen(announcer, {0}, 250);
    const Said said = listen(announcer, {2'000'000}, 250);
    EXPECT_EQ(said.heartbeats_us, (std::vector<std::int64_t>{0, 100'000, 200'000}));
}

TEST(Announcer, keeps_its_rhythm_across_the_wrap_of_the_clock) {
    const NodeTime start{0xFFFFFFFFU - 450'000U};
    Announcer announcer{1, kPolicy, start};
    EXPECT_EQ(listen(announcer, start, 1'000).heartbeats_us.size(), 10U);
}

TEST(Announcer, is_calm_without_any_sensors) {
    Announcer announcer{0, kPolicy, {0}};
    const Said said = listen(announcer, {0}, 2'000);
    EXPECT_TRUE(said.health_us.empty());
    EXPECT_TRUE(is_reached({1'999'000}, announcer.next_due()));
}

}  // namespace
}  // namespace octoskin::node
