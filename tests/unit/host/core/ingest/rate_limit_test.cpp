#include "host/core/ingest/rate_limit.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(RateLimit, allows_as_many_within_a_second_and_not_one_more) {
    for (std::size_t most = 1; most < 50; ++most) {
        RateLimit limit(most);
        for (std::size_t i = 0; i < most; ++i) {
            EXPECT_TRUE(limit.keeps_with_event({7})) << i << " of " << most;
        }
        EXPECT_FALSE(limit.keeps_with_event({7 + kSecond - 1})) << most;
    }
}

TEST(RateLimit, has_room_again_exactly_a_second_after_the_first_of_a_full_second) {
    RateLimit limit(3);
    for (const std::int64_t at : {0, 10, 20}) EXPECT_TRUE(limit.keeps_with_event({at}));
    EXPECT_TRUE(limit.keeps_with_event({kSecond}));
    EXPECT_FALSE(limit.keeps_with_event({kSecond + 9}));
    EXPECT_TRUE(limit.keeps_with_event({2 * kSecond}));
}

TEST(RateLimit, agrees_with_a_count_of_every_second_that_there_is) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random(seed);
        const std::size_t most = 1 + random() % 9;
        RateLimit limit(most);
        std::vector<std::int64_t> all;
        for (int i = 0; i < 400; ++i) {
            const std::int64_t step = static_cast<std::int64_t>(random() % (kSecond / 4));
            all.push_back((all.empty() ? 0 : all.back()) + step);
            std::size_t within = 0;
            for (const std::int64_t at : all) within += all.back() - at < kSecond ? 1U : 0U;
            ASSERT_EQ(limit.keeps_with_event({all.back()}), within <= most)
                << "seed " << seed << ", event " << i;
        }
    }
}

TEST(RateLimit, goes_on_where_a_stamp_had_run_ahead) {
    RateLimit limit(2);
    for (const std::int64_t at : {0, 20}) EXPECT_TRUE(limit.keeps_with_event({at}));
    EXPECT_FALSE(limit.keeps_with_event({10}));
    EXPECT_FALSE(limit.keeps_with_event({kSecond + 19})) << "the one of 10 counts as of 20";
    EXPECT_TRUE(limit.keeps_with_event({kSecond + 20}));
}

TEST(RateLimit, begins_anew_where_time_goes_back) {
    RateLimit limit(2);
    for (const std::int64_t at : {0, 1}) EXPECT_TRUE(limit.keeps_with_event({3 * kSecond + at}));
    for (const std::int64_t at : {0, 1}) EXPECT_TRUE(limit.keeps_with_event({2 * kSecond + at}));
    EXPECT_FALSE(limit.keeps_with_event({2 * kSecond + 2}));
}

}  // namespace
}  // namespace octoskin
