#include "host/core/time/sync_exchange.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace octoskin {
namespace {

TEST(SyncExchange, pairs_report_and_follow_up_in_either_order) {
    for (const bool is_report_first : {true, false}) {
        SyncExchange exchange;
        ASSERT_TRUE(exchange.on_sync({.sequence = 7}, {5'000}).has_value());
        const auto report = [&] {
            return exchange.on_report(3, {.sequence = 7, .heard = {123}}).has_value();
        };
        const auto follow_up = [&] {
            return exchange.on_follow_up({.sequence = 7, .host_time_us = 1'000'000}).has_value();
        };
        ASSERT_TRUE(is_report_first ? report() : follow_up());
        EXPECT_TRUE(exchange.take_samples(3).empty());
        ASSERT_TRUE(is_report_first ? follow_up() : report());
        const auto samples = exchange.take_samples(3);
        ASSERT_EQ(samples.size(), 1U);
        EXPECT_EQ(samples[0].host.ns, 1'000'000'000);
        EXPECT_EQ(samples[0].heard.us, 123U);
        EXPECT_TRUE(exchange.take_samples(3).empty()) << "only once";
    }
}

TEST(SyncExchange, gives_the_stamp_of_the_sync_with_the_follow_up) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 0}, {5'000}).has_value());
    const auto stamp = exchange.on_follow_up({.sequence = 0, .host_time_us = 1});
    ASSERT_TRUE(stamp.has_value());
    EXPECT_EQ(stamp->host.ns, 1'000);
    EXPECT_EQ(stamp->stamp.ns, 5'000);
}

TEST(SyncExchange, keeps_nodes_apart) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 1}, {0}).has_value());
    ASSERT_TRUE(exchange.on_follow_up({.sequence = 1, .host_time_us = 9}).has_value());
    ASSERT_TRUE(exchange.on_report(1, {.sequence = 1, .heard = {10}}).has_value());
    ASSERT_TRUE(exchange.on_report(62, {.sequence = 1, .heard = {20}}).has_value());
    EXPECT_EQ(exchange.take_samples(1).at(0).heard.us, 10U);
    EXPECT_EQ(exchange.take_samples(62).at(0).heard.us, 20U);
    EXPECT_TRUE(exchange.take_samples(2).empty());
}

TEST(SyncExchange, refuses_what_belongs_to_no_open_sync) {
    SyncExchange exchange;
    EXPECT_EQ(exchange.on_follow_up({.sequence = 0}).error(), SyncFault::unmatched);
    EXPECT_EQ(exchange.on_report(1, {.sequence = 0, .heard = {}}).error(), SyncFault::unmatched);
    ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
    ASSERT_TRUE(exchange.on_sync({.sequence = 5}, {0}).has_value());
    EXPECT_EQ(exchange.on_follow_up({.sequence = 4}).error(), SyncFault::unmatched);
    EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {}}).error(), SyncFault::unmatched);
}

TEST(SyncExchange, refuses_a_second_answer) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
    ASSERT_TRUE(exchange.on_report(1, {.sequence = 4, .heard = {1}}).has_value());
    EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {2}}).error(), SyncFault::repeated);
    ASSERT_TRUE(exchange.on_follow_up({.sequence = 4, .host_time_us = 1}).has_value());
    EXPECT_EQ(exchange.on_follow_up({.sequence = 4, .host_time_us = 2}).error(), SyncFault::repeated);
    EXPECT_EQ(exchange.take_samples(1).at(0).heard.us, 1U);
    EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {3}}).error(), SyncFault::repeated);
}

std::vector<std::uint32_t> heard_of(const std::vector<SyncSample>& samples) {
    std::vector<std::uint32_t> heard;
    for (const SyncSample& sample : samples) heard.push_back(sample.heard.us);
    return heard;
}

TEST(SyncExchange, tells_an_answer_that_contradicts_another_and_gives_both) {
    for (const bool is_follow_up_first : {true, false}) {
        SyncExchange exchange;
        const auto follow_up = [&] {
            return exchange.on_follow_up({.sequence = 4, .host_time_us = 1}).has_value();
        };
        ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
        ASSERT_TRUE(!is_follow_up_first || follow_up());
        ASSERT_TRUE(exchange.on_report(1, {.sequence = 4, .heard = {5'000}}).has_value());
        EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {6'000}}).error(), SyncFault::repeated);
        EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {5'000}}).error(), SyncFault::repeated);
        if (is_follow_up_first) {
            EXPECT_EQ(heard_of(exchange.take_samples(1)), (std::vector<std::uint32_t>{5'000, 6'000}));
        }
        EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {6'001}}).error(), SyncFault::contradicted);
        ASSERT_TRUE(is_follow_up_first || follow_up());
        EXPECT_EQ(heard_of(exchange.take_samples(1)), (std::vector<std::uint32_t>{5'000, 6'000, 6'001}));
        EXPECT_TRUE(exchange.take_samples(1).empty());
    }
}

TEST(SyncExchange, tells_answers_apart_across_the_wrap_of_the_clock_and_keeps_four) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
    ASSERT_TRUE(exchange.on_follow_up({.sequence = 4, .host_time_us = 1}).has_value());
    ASSERT_TRUE(exchange.on_report(1, {.sequence = 4, .heard = {0xFFFFFFFFU}}).has_value());
    EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {500}}).error(), SyncFault::repeated);
    for (std::uint32_t i = 1; i <= 9; ++i)
        EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {10'000 * i}}).error(),
                  SyncFault::contradicted);
    EXPECT_EQ(heard_of(exchange.take_samples(1)),
              (std::vector<std::uint32_t>{0xFFFFFFFFU, 500, 10'000, 20'000}));
}

TEST(SyncExchange, gives_nothing_for_a_sync_heard_twice) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
    EXPECT_EQ(exchange.on_sync({.sequence = 4}, {100}).error(), SyncFault::repeated);
    EXPECT_EQ(exchange.on_follow_up({.sequence = 4}).error(), SyncFault::unmatched);
    EXPECT_EQ(exchange.on_report(1, {.sequence = 4, .heard = {}}).error(), SyncFault::unmatched);
    EXPECT_TRUE(exchange.on_sync({.sequence = 5}, {200}).has_value());
}

TEST(SyncExchange, forgets_reports_of_the_sync_before) {
    SyncExchange exchange;
    ASSERT_TRUE(exchange.on_sync({.sequence = 4}, {0}).has_value());
    ASSERT_TRUE(exchange.on_report(1, {.sequence = 4, .heard = {1}}).has_value());
    ASSERT_TRUE(exchange.on_sync({.sequence = 5}, {0}).has_value());
    ASSERT_TRUE(exchange.on_follow_up({.sequence = 5}).has_value());
    EXPECT_TRUE(exchange.take_samples(1).empty());
}

}  // namespace
}  // namespace octoskin
