#include "host/core/counters/input_counters.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

enum class Fruit : std::uint8_t { rotten, stolen };
constexpr std::array<const char*, 2> names_of(Fruit) {
    return {"rotten", "stolen"};
}

TEST(InputCounters, balances_only_if_every_input_has_one_fate) {
    InputCounters<Fruit> inputs;
    EXPECT_TRUE(inputs.is_balanced());
    inputs.count_in(3);
    inputs.use();
    inputs.reject(Fruit::stolen);
    EXPECT_FALSE(inputs.is_balanced());
    EXPECT_TRUE(inputs.is_balanced(1)) << "one still waits";
    inputs.reject(Fruit::rotten);
    EXPECT_TRUE(inputs.is_balanced());
    inputs.reject(Fruit::rotten);
    EXPECT_FALSE(inputs.is_balanced()) << "one fate too many is a defect, too";
}

TEST(InputCounters, settles_an_input_as_it_turned_out) {
    InputCounters<Fruit> inputs;
    inputs.count_in(2);
    EXPECT_TRUE(inputs.settle(Done{}));
    EXPECT_FALSE(inputs.settle(unexpected(Fruit::stolen)));
    EXPECT_EQ(inputs.used(), 1U);
    EXPECT_EQ(inputs.rejected(Fruit::stolen), 1U);
    EXPECT_TRUE(inputs.is_balanced());
}

TEST(InputCounters, prints_what_happened_by_name_and_says_if_the_sum_is_wrong) {
    InputCounters<Fruit> inputs;
    inputs.count_in(5);
    inputs.use();
    inputs.reject(Fruit::stolen);
    inputs.reject(Fruit::stolen);
    EXPECT_EQ(to_text(tabulate("fruits", inputs, 2)),
              "fruits                         5 in = 1 used + 2 rejected + 2 pending\n"
              "  stolen                               2\n");
    EXPECT_EQ(to_text(tabulate("fruits", inputs)),
              "fruits                         5 in = 1 used + 2 rejected   NOT BALANCED\n"
              "  stolen                               2\n");
}

TEST(InputCounters, tabulates_every_reason_in_order) {
    const CounterTable table = tabulate("fruits", InputCounters<Fruit>{});
    ASSERT_EQ(table.rejected.size(), 2U);
    EXPECT_EQ(table.rejected[0].name, "rotten");
    EXPECT_EQ(table.rejected[1].name, "stolen");
}

}  // namespace
}  // namespace octoskin
