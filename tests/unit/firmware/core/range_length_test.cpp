// Oracle: a part whose ranges take a known time, and stops at every tenth of a millisecond of its period.
#include "firmware/core/range_length.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace octoskin::node {
namespace {

constexpr Microseconds kBudget{15'000};
constexpr std::int64_t kPeriodUs = 20'000;

/// The last range was ready at 0, over the clock's wrap; the next one will be within 100 us.
constexpr NodeTime at(std::int64_t us) {
    return NodeTime{0xFFFFFF00U} + Microseconds{us};
}
constexpr TimeBracket kNext{at(kPeriodUs - 50), at(kPeriodUs + 50)};

TEST(RangeLength, allows_for_the_most_that_ranges_take_until_it_is_told) {
    const RangeLength length{kBudget};
    EXPECT_TRUE(length.is_before(at(0), at(20'000)));
    EXPECT_FALSE(length.is_before(at(1), at(20'000)));
    EXPECT_FALSE(length.is_before(at(25'000), at(20'000))) << "overdue";
}

TEST(RangeLength, once_told_knows_of_any_part_when_its_range_has_not_begun) {
    for (std::int64_t overhead_us = 0; overhead_us < 5'000; overhead_us += 100) {
        const std::int64_t begin_us = kPeriodUs - kBudget.count() - overhead_us;
        for (std::int64_t stop_us = 0; stop_us < begin_us; stop_us += 100) {
            RangeLength length{kBudget};
            length.on_none_begun(at(stop_us), kNext);
            for (std::int64_t us = 0; us < kPeriodUs; us += 100) {
                const bool is_before = length.is_before(at(us), kNext.earliest);
                EXPECT_TRUE(!is_before || us < begin_us) << overhead_us << ' ' << stop_us << ' ' << us;
                EXPECT_TRUE(is_before || us > stop_us - 400) << stop_us << ' ' << us;
            }
        }
    }
}

TEST(RangeLength, forgets_nothing_for_a_stop_that_tells_less) {
    RangeLength length{kBudget};
    length.on_none_begun(at(3'000), kNext);
    length.on_none_begun(at(500), kNext);
    EXPECT_TRUE(length.is_before(at(2'600), kNext.earliest));
}

}  // namespace
}  // namespace octoskin::node
