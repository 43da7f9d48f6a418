#include "firmware/core/data_ready_hint.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin::node {
namespace {

using namespace std::chrono_literals;

constexpr Policy kPolicy;
constexpr std::uint8_t kBus = 2;

/// Falls when the test says so, or whenever it is asked.
class Lines final : public DataReadyLines {
  public:
    bool take_fall(std::uint8_t bus) override {
        EXPECT_EQ(bus, kBus);
        ++asked;
        return chatters || std::exchange(has_fallen, false);
    }
    bool chatters = false;
    bool has_fallen = false;
    int asked = 0;
};

class Hint : public testing::Test {
  protected:
    /// Asks every microsecond, as no loop can, and counts the hints.
    int hints_within(Microseconds duration, bool confirms = false) {
        int hints = 0;
        for (const NodeTime end = now_ + duration; now_ != end; now_ = now_ + 1us) {
            if (!hint_.take(now_)) continue;
            ++hints;
            if (confirms) hint_.confirm();
        }
        return hints;
    }
    Lines lines_;
    DataReadyHint hint_{&lines_, kBus, kPolicy};
    NodeTime now_{0xFFFF'FF00};  // the clock wraps within each test
};

TEST_F(Hint, tells_each_fall_once) {
    EXPECT_FALSE(hint_.take(now_));
    lines_.has_fallen = true;
    EXPECT_TRUE(hint_.take(now_ + 1us));
    EXPECT_FALSE(hint_.take(now_ + 1ms));
}

TEST_F(Hint, of_a_bus_without_a_line_never_comes) {
    DataReadyHint none(nullptr, kBus, kPolicy);
    EXPECT_FALSE(none.take(now_));
}

TEST_F(Hint, comes_at_most_every_250_us_and_a_fall_in_between_is_kept) {
    lines_.has_fallen = true;
    ASSERT_TRUE(hint_.take(now_));
    lines_.has_fallen = true;
    EXPECT_FALSE(hint_.take(now_ + 249us));
    EXPECT_EQ(lines_.asked, 1) << "until then the port need not even listen";
    EXPECT_TRUE(hint_.take(now_ + 250us));
}

TEST_F(Hint, of_a_line_that_chatters_is_ignored_after_a_hundred_and_never_asked_for_again) {
    lines_.chatters = true;
    // The first fall is judged when the second comes, and so on.
    EXPECT_EQ(hints_within(1s), 100);
    EXPECT_TRUE(hint_.is_ignored());
    EXPECT_EQ(hint_.spurious_count(), 100U);
    const int asked = lines_.asked;
    EXPECT_EQ(hints_within(1s), 0);
    EXPECT_EQ(lines_.asked, asked);
}

TEST_F(Hint, of_a_line_whose_falls_have_data_behind_them_is_trusted_for_ever) {
    lines_.chatters = true;
    EXPECT_EQ(hints_within(1s, true), 4'000);
    EXPECT_FALSE(hint_.is_ignored());
    EXPECT_EQ(hint_.spurious_count(), 0U);
}

/// Every `n`-th fall is confirmed, a hundred thousand times.
DataReadyHint after_falls(Lines& lines, int n) {
    DataReadyHint hint(&lines, kBus, kPolicy);
    lines.chatters = true;
    NodeTime now{};
    for (int fall = 0; fall < 100'000; ++fall, now = now + 1ms) {
        if (hint.take(now) && fall % n == 0) hint.confirm();
    }
    return hint;
}

TEST_F(Hint, survives_two_spurious_falls_in_three_but_not_three_in_four) {
    EXPECT_FALSE(after_falls(lines_, 3).is_ignored());
    EXPECT_TRUE(after_falls(lines_, 4).is_ignored());
}

TEST_F(Hint, is_confirmed_by_the_first_of_several_sensors_and_by_none_without_a_fall) {
    hint_.confirm();
    lines_.has_fallen = true;
    ASSERT_TRUE(hint_.take(now_));
    hint_.confirm();
    hint_.confirm();
    lines_.has_fallen = true;
    ASSERT_TRUE(hint_.take(now_ + 1ms));
    EXPECT_EQ(hint_.spurious_count(), 0U);
    lines_.has_fallen = true;
    ASSERT_TRUE(hint_.take(now_ + 2ms));
    EXPECT_EQ(hint_.spurious_count(), 1U);
}

}  // namespace
}  // namespace octoskin::node
