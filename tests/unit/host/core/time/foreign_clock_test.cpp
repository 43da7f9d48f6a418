#include "host/core/time/foreign_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin {
namespace {

constexpr Nanoseconds kSecond{1'000'000'000};
constexpr Nanoseconds kMs{1'000'000};
constexpr Nanoseconds kQuarter = 900 * kSecond;

class ForeignClockTest : public testing::Test {
  protected:
    /// One exchange a second, of a host whose clock is told to be `ahead`.
    void exchange(Nanoseconds ahead) {
        now_ = now_ + kSecond;
        sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kSyncSequenceCount);
        clock_.on_sync(sequence_, now_);
        clock_.on_follow_up(reported(sequence_, now_ + ahead));
    }
    static wire::FollowUp reported(std::uint8_t sequence, HostTime at) {
        return {sequence, static_cast<std::uint64_t>(at.ns / 1000)};
    }
    [[nodiscard]] std::optional<Nanoseconds> ahead() const { return clock_.ahead(now_); }

    HostTime now_{50'000'000'000};
    std::uint8_t sequence_ = 0;
    ForeignClock clock_;
};

TEST_F(ForeignClockTest, is_not_known_before_three_exchanges_agree) {
    EXPECT_FALSE(ahead());
    exchange(kQuarter);
    EXPECT_FALSE(ahead());
    exchange(kQuarter + 5 * kMs);
    EXPECT_FALSE(ahead());
    exchange(kQuarter);
    EXPECT_FALSE(ahead());
    exchange(kQuarter);
    EXPECT_EQ(ahead(), kQuarter);
}

TEST_F(ForeignClockTest, one_outlier_at_any_place_moves_nothing_and_is_counted) {
    for (const Nanoseconds off : {-3600 * kSecond, -kSecond, -3 * kMs, 3 * kMs, kSecond, 3600 * kSecond}) {
        for (int place = 0; place < 12; ++place) {
            clock_ = ForeignClock();
            for (int i = 0; i < 12; ++i) {
                exchange(kQuarter + (i == place ? off : Nanoseconds{0}));
                ASSERT_EQ(ahead().value_or(kQuarter), kQuarter) << off.count() << " at " << place;
                const bool is_decided = i >= 3 && i != place;
                EXPECT_TRUE(i < 3 || ahead().has_value() == is_decided) << i << " at " << place;
            }
            EXPECT_EQ(clock_.outliers(), place >= 3 ? 1U : 0U) << place;
        }
    }
}

TEST_F(ForeignClockTest, follows_a_host_that_began_anew_after_three_exchanges) {
    for (int i = 0; i < 10; ++i) exchange(kQuarter);
    for (int i = 0; i < 2; ++i) {
        exchange(-40 * kSecond);
        EXPECT_FALSE(ahead());
    }
    exchange(-40 * kSecond);
    EXPECT_EQ(ahead(), -40 * kSecond);
    EXPECT_EQ(clock_.outliers(), 2U);
}

TEST_F(ForeignClockTest, stays_within_a_millisecond_of_a_drifting_clock_with_jittery_stamps) {
    for (const double ppm : {-200.0, 0.0, 200.0}) {
        std::mt19937 random(7);
        std::uniform_int_distribution<int> late_us(0, 200);
        clock_ = ForeignClock();
        Nanoseconds is_ahead = kQuarter;
        for (int i = 0; i < 600; ++i) {
            is_ahead += Nanoseconds{static_cast<std::int64_t>(ppm * 1e3)};
            exchange(is_ahead - Nanoseconds{late_us(random) * 1000});
            if (i < 3) continue;
            ASSERT_TRUE(ahead()) << i;
            ASSERT_LE(std::chrono::abs(*ahead() - is_ahead), Nanoseconds{800'000}) << i;
        }
        EXPECT_EQ(clock_.outliers(), 0U);
    }
}

TEST_F(ForeignClockTest, is_not_told_by_an_answer_to_another_sync_or_a_second_one) {
    clock_.on_follow_up(reported(0, now_ + kQuarter));
    for (int i = 0; i < 5; ++i) {
        clock_.on_sync(1, now_);
        clock_.on_follow_up(reported(2, now_ + kQuarter));
        EXPECT_FALSE(ahead());
    }
    clock_.on_follow_up(reported(1, now_ + kQuarter));
    for (int i = 0; i < 5; ++i) clock_.on_follow_up(reported(1, now_ + kQuarter));
    EXPECT_FALSE(ahead()) << "one exchange, however often it is told";
}

TEST_F(ForeignClockTest, is_forgotten_in_silence_and_known_again_with_the_next_exchange) {
    for (int i = 0; i < 4; ++i) exchange(kQuarter);
    EXPECT_TRUE(clock_.ahead(now_ + 5 * kSecond));
    EXPECT_FALSE(clock_.ahead(now_ + 5 * kSecond + Nanoseconds{1}));
    now_ = now_ + 5 * kSecond;
    exchange(kQuarter);
    EXPECT_EQ(ahead(), kQuarter);
}

}  // namespace
}  // namespace octoskin
