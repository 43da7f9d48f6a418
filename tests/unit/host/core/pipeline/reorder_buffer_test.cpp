#include "host/core/pipeline/reorder_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace octoskin {
namespace {

using Pushed = ReorderBuffer<int>::Pushed;

TEST(ReorderBuffer, gives_out_by_capture_time_then_by_source_whatever_the_order_of_arrival) {
    const std::vector<ReleaseKey> sorted = {
        {{10}, {0, 0, 0}}, {{10}, {1, 0, 0}}, {{10}, {1, 2, 0}}, {{10}, {2, 0, 0}}, {{11}, {0, 0, 0}}};
    std::vector<std::size_t> order = {0, 1, 2, 3, 4};
    do {
        ReorderBuffer<std::size_t> buffer(5);
        for (const std::size_t i : order) {
            EXPECT_EQ(buffer.push(sorted[i], i), ReorderBuffer<std::size_t>::Pushed::waits);
        }
        for (std::size_t i = 0; i < 5; ++i) {
            EXPECT_EQ(buffer.front(), sorted[i]);
            EXPECT_EQ(buffer.pop(), i);
        }
        EXPECT_FALSE(buffer.front().has_value());
    } while (std::ranges::next_permutation(order).found);
}

TEST(ReorderBuffer, drops_the_oldest_beyond_its_capacity_and_says_so) {
    ReorderBuffer<int> buffer(2);
    EXPECT_EQ(buffer.push({{3}, {}}, 3), Pushed::waits);
    EXPECT_EQ(buffer.push({{1}, {}}, 1), Pushed::waits);
    EXPECT_TRUE(buffer.is_full());
    EXPECT_EQ(buffer.push({{2}, {}}, 2), Pushed::displaced);
    EXPECT_EQ(buffer.size(), 2U);
    EXPECT_EQ(buffer.pop(), 2);
    EXPECT_EQ(buffer.pop(), 3);
}

TEST(ReorderBuffer, refuses_a_second_one_of_the_same_key) {
    ReorderBuffer<int> buffer(3);
    EXPECT_EQ(buffer.push({{7}, {}}, 1), Pushed::waits);
    EXPECT_EQ(buffer.push({{7}, {}}, 2), Pushed::refused);
    EXPECT_EQ(buffer.size(), 1U);
    EXPECT_EQ(buffer.pop(), 1);
}

TEST(ReorderBuffer, finds_what_is_near_in_time_and_of_the_same_source) {
    ReorderBuffer<int> buffer(3);
    EXPECT_EQ(buffer.push({{100}, {2, 1, 0}}, 1), Pushed::waits);
    for (const std::int64_t at : {91, 100, 109}) {
        EXPECT_TRUE(buffer.has_near({{at}, {2, 1, 0}}, Nanoseconds{10})) << at;
        EXPECT_FALSE(buffer.has_near({{at}, {2, 2, 0}}, Nanoseconds{10})) << at;
    }
    EXPECT_FALSE(buffer.has_near({{90}, {2, 1, 0}}, Nanoseconds{10}));
    EXPECT_FALSE(buffer.has_near({{110}, {2, 1, 0}}, Nanoseconds{10}));
}

}  // namespace
}  // namespace octoskin
