#include "host/core/account/account.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

enum class Fruit : std::uint8_t { rotten, stolen };
constexpr std::array<const char*, 2> names_of(Fruit) {
    return {"rotten", "stolen"};
}

TEST(Account, balances_only_if_every_input_has_one_fate) {
    Account<Fruit> account;
    EXPECT_TRUE(account.is_balanced());
    account.take_in(3);
    account.use();
    account.reject(Fruit::stolen);
    EXPECT_FALSE(account.is_balanced());
    EXPECT_TRUE(account.is_balanced(1)) << "one still waits";
    account.reject(Fruit::rotten);
    EXPECT_TRUE(account.is_balanced());
    account.reject(Fruit::rotten);
    EXPECT_FALSE(account.is_balanced()) << "one fate too many is a defect, too";
}

TEST(Account, settles_an_input_as_it_turned_out) {
    Account<Fruit> account;
    account.take_in(2);
    EXPECT_TRUE(account.settle(Done{}));
    EXPECT_FALSE(account.settle(unexpected(Fruit::stolen)));
    EXPECT_EQ(account.used(), 1U);
    EXPECT_EQ(account.rejected(Fruit::stolen), 1U);
    EXPECT_TRUE(account.is_balanced());
}

TEST(Account, prints_what_happened_by_name_and_says_if_the_sum_is_wrong) {
    Account<Fruit> account;
    account.take_in(5);
    account.use();
    account.reject(Fruit::stolen);
    account.reject(Fruit::stolen);
    EXPECT_EQ(to_text(tabulate("fruits", account, 2)),
              "fruits                         5 in = 1 used + 2 rejected + 2 pending\n"
              "  stolen                               2\n");
    EXPECT_EQ(to_text(tabulate("fruits", account)),
              "fruits                         5 in = 1 used + 2 rejected   NOT BALANCED\n"
              "  stolen                               2\n");
}

TEST(Account, tabulates_every_reason_in_order) {
    const AccountTable table = tabulate("fruits", Account<Fruit>{});
    ASSERT_EQ(table.rejected.size(), 2U);
    EXPECT_EQ(table.rejected[0].name, "rotten");
    EXPECT_EQ(table.rejected[1].name, "stolen");
}

}  // namespace
}  // namespace octoskin
