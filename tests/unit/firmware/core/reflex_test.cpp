// When something has come too close, and when it has gone.
#include "firmware/core/reflex.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace octoskin::node {
namespace {

constexpr std::uint8_t kHit = 9;
constexpr std::uint8_t kNothingThere = 4;

Reading reading(std::uint8_t status, std::int32_t range_mm) {
    Reading reading;
    reading.device_status = status;
    reading.range_mm = static_cast<std::int16_t>(range_mm);
    return reading;
}

class ReflexTest : public testing::Test {
  protected:
    bool sees(std::int32_t range_mm, std::uint8_t status = kHit, std::int64_t after_ms = 33) {
        now_ = now_ + Microseconds{after_ms * 1'000};
        return reflex_.begins(reading(status, range_mm), now_);
    }
    const Policy policy_{};
    Reflex reflex_{300, policy_};
    NodeTime now_{0xFFFF'FFFFU - 100'000U};  // shortly before the clock wraps
};

TEST_F(ReflexTest, begins_with_the_first_hit_below_the_limit_and_not_at_it) {
    EXPECT_FALSE(sees(301));
    EXPECT_FALSE(sees(300));
    EXPECT_TRUE(sees(299));
}

TEST_F(ReflexTest, takes_a_negative_range_for_nearer_than_any_limit) {
    EXPECT_TRUE(sees(-8));
    EXPECT_FALSE(sees(-8, kHit, 300)) << "and not for a look at something far";
    EXPECT_FALSE(sees(-32'768, kHit, 300));
}

TEST_F(ReflexTest, is_told_once_however_long_it_lasts) {
    EXPECT_TRUE(sees(0));
    for (int i = 0; i < 1'000; ++i) EXPECT_FALSE(sees(i % 2 == 0 ? 100 : 299));
}

TEST_F(ReflexTest, is_not_told_again_for_what_wobbles_about_the_limit) {
    EXPECT_TRUE(sees(299));
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(sees(329));  // within a tenth of the limit
        EXPECT_FALSE(sees(299));
        EXPECT_FALSE(sees(330));
        EXPECT_FALSE(sees(1'000));
        EXPECT_FALSE(sees(298));
    }
}

TEST_F(ReflexTest, is_armed_again_after_200_ms_of_looking_far) {
    EXPECT_TRUE(sees(299));
    EXPECT_FALSE(sees(330));
    EXPECT_FALSE(sees(330, kHit, 199));
    EXPECT_FALSE(sees(299));
    EXPECT_FALSE(sees(330));
    EXPECT_FALSE(sees(330, kHit, 200));
    EXPECT_TRUE(sees(299));
    EXPECT_FALSE(sees(0, kNothingThere));
    EXPECT_FALSE(sees(0, kNothingThere, 200));
    EXPECT_TRUE(sees(10));
}

TEST_F(ReflexTest, no_status_but_hit_begins_it_and_none_but_hit_and_no_target_ends_it) {
    for (std::uint8_t status = 0; status < 32; ++status) {
        EXPECT_EQ(sees(100, status), status == kHit) << int{status};
    }
    for (std::uint8_t status = 0; status < 32; ++status) {
        Reflex reflex{300, policy_};
        const auto at = [&](std::uint8_t code, std::int32_t range_mm, int ms) {
            return reflex.begins(reading(code, range_mm), NodeTime{static_cast<std::uint32_t>(ms * 1'000)});
        };
        EXPECT_TRUE(at(kHit, 100, 0));
        EXPECT_FALSE(at(status, 1'000, 33));
        EXPECT_FALSE(at(status, 1'000, 300));
        EXPECT_EQ(at(kHit, 100, 333), status == kHit || status == kNothingThere) << int{status};
    }
}

TEST(Reflex, of_a_limit_of_zero_never_happens) {
    const Policy policy{};
    Reflex reflex{0, policy};
    for (std::int32_t range_mm = 0; range_mm <= 32'767; ++range_mm) {
        EXPECT_FALSE(reflex.begins(reading(kHit, range_mm), {static_cast<std::uint32_t>(range_mm)}));
    }
}

// An event, one look at something farther off, and then no usable result for longer than half the clock's
// period.
TEST(Reflex, is_armed_by_the_next_look_at_something_far_however_long_the_last_one_is_ago) {
    const Policy policy{};
    for (const std::uint32_t minutes : {1U, 36U, 50U, 71U, 80U}) {
        Reflex reflex{300, policy};
        NodeTime now{0xFFFF'FFFFU - 100'000U};
        EXPECT_TRUE(reflex.begins(reading(kHit, 100), now));
        EXPECT_FALSE(reflex.begins(reading(kHit, 1'000), now));
        for (std::uint32_t minute = 0; minute < minutes; ++minute) {
            now = now + Microseconds{60'000'000};
            reflex.update(now);
        }
        EXPECT_FALSE(reflex.begins(reading(kHit, 1'000), now));
        EXPECT_TRUE(reflex.begins(reading(kHit, 100), now)) << minutes;
    }
}

TEST(Reflex, keeps_at_least_20_mm_of_margin_for_small_limits) {
    const Policy policy{};
    Reflex reflex{50, policy};
    const auto at = [&](std::int32_t range_mm, std::uint32_t ms) {
        return reflex.begins(reading(kHit, range_mm), {ms * 1'000});
    };
    EXPECT_TRUE(at(49, 0));
    EXPECT_FALSE(at(69, 33));
    EXPECT_FALSE(at(69, 333));
    EXPECT_FALSE(at(49, 366));
    EXPECT_FALSE(at(70, 400));
    EXPECT_FALSE(at(70, 600));
    EXPECT_TRUE(at(49, 633));
}

}  // namespace
}  // namespace octoskin::node
