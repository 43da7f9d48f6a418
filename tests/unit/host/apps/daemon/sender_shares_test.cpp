// Who may send how much: one that floods takes nothing from the others.
#include "host/apps/daemon/sender_shares.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

HostTime at_ms(std::int64_t ms) {
    return HostTime{ms * 1'000'000};
}
SenderKey program(pid_t pid) {
    return {pid, {}};
}

TEST(SenderShares, leave_the_quickest_driver_all_that_it_says_and_a_flood_what_twice_that_is) {
    SenderShares shares;
    int of_driver = 0;
    int of_flood = 0;
    for (std::int64_t ms = 0; ms < 10'000; ++ms) {
        of_driver += shares.take(program(1), at_ms(ms)) ? 1 : 0;
        for (int i = 0; i < 57; ++i) of_flood += shares.take(program(2), at_ms(ms)) ? 1 : 0;
    }
    EXPECT_EQ(of_driver, 10'000) << "1000 a second";
    EXPECT_NEAR(of_flood, 11 * 2048, 3) << "at once, and then each second, of 57,000";
}

TEST(SenderShares, take_a_second_of_a_driver_at_once) {
    SenderShares shares;
    for (int i = 0; i < 2048; ++i) ASSERT_TRUE(shares.take(program(1), at_ms(0))) << i;
    EXPECT_FALSE(shares.take(program(1), at_ms(0)));
    EXPECT_TRUE(shares.take(program(2), at_ms(0)));
    EXPECT_TRUE(shares.take(program(1), at_ms(1)));
}

TEST(SenderShares, are_of_so_many_programs_and_go_to_another_when_one_is_silent) {
    SenderShares shares;
    for (pid_t pid = 1; pid <= 8; ++pid) EXPECT_TRUE(shares.take(program(pid), at_ms(0)));
    EXPECT_FALSE(shares.take(program(9), at_ms(0)));
    for (pid_t pid = 1; pid <= 7; ++pid) EXPECT_TRUE(shares.take(program(pid), at_ms(900)));
    EXPECT_FALSE(shares.take(program(9), at_ms(999)));
    EXPECT_TRUE(shares.take(program(9), at_ms(1'000))) << "the eighth was silent for a second";
    EXPECT_FALSE(shares.take(program(8), at_ms(1'000)));
}

TEST(SenderShares, of_programs_that_cannot_be_seen_are_one_for_each_address) {
    SenderShares shares;
    for (int i = 0; i < 2048; ++i) EXPECT_TRUE(shares.take({0, "/run/a"}, at_ms(0)));
    EXPECT_FALSE(shares.take({0, "/run/a"}, at_ms(0)));
    EXPECT_TRUE(shares.take({0, "/run/b"}, at_ms(0)));
    EXPECT_TRUE(shares.take({0, ""}, at_ms(0)));
}

TEST(SenderShares, do_not_grow_while_a_clock_goes_back) {
    SenderShares shares;
    for (int i = 0; i < 2048; ++i) EXPECT_TRUE(shares.take(program(1), at_ms(10'000)));
    EXPECT_FALSE(shares.take(program(1), at_ms(0)));
}

}  // namespace
}  // namespace octoskin
