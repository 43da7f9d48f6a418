// Who may send how much: one that floods takes nothing from the others.
#include "host/apps/daemon/sender_shares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace octoskin {
namespace {

HostTime at_ms(std::int64_t ms) {
    return HostTime{ms * 1'000'000};
}
constexpr pid_t kDriver = 1000;
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

TEST(SenderShares, are_of_so_many_useful_programs_and_go_to_another_when_one_is_silent) {
    SenderShares shares;
    const auto is_taken_of_use = [&](pid_t pid, std::int64_t ms) {
        const bool is_taken = shares.take(program(pid), at_ms(ms));
        if (is_taken) shares.keep(program(pid), at_ms(ms));
        return is_taken;
    };
    for (pid_t pid = 1; pid <= 8; ++pid) EXPECT_TRUE(is_taken_of_use(pid, 0));
    EXPECT_FALSE(shares.take(program(9), at_ms(0)));
    for (pid_t pid = 1; pid <= 7; ++pid) EXPECT_TRUE(is_taken_of_use(pid, 900));
    EXPECT_FALSE(shares.take(program(9), at_ms(999)));
    EXPECT_TRUE(is_taken_of_use(9, 1'000)) << "the eighth was silent for a second";
    EXPECT_FALSE(shares.take(program(8), at_ms(1'000)));
    for (pid_t pid = 1; pid <= 7; ++pid) EXPECT_TRUE(shares.take(program(pid), at_ms(1'890)));
    EXPECT_FALSE(shares.take(program(8), at_ms(1'899)));
    EXPECT_TRUE(shares.take(program(8), at_ms(1'900))) << "what they send was of no use for a second";
}

// One that is found useful has its share from then on, however many others send what is not. Until then it
// has one of theirs.
TEST(SenderShares, leave_a_driver_all_that_it_says_beside_any_number_of_programs_that_are_of_no_use) {
    for (const pid_t programs : {8, 9, 40}) {
        SenderShares shares;
        std::vector<pid_t> turn(static_cast<std::size_t>(programs));
        std::iota(turn.begin(), turn.end(), 1);
        turn.push_back(kDriver);
        std::mt19937 order(7);
        int lost = 0;
        std::int64_t newest_lost_ms = 0;
        for (std::int64_t ms = 0; ms < 3'000; ++ms) {
            std::ranges::shuffle(turn, order);
            for (const pid_t pid : turn) {
                if (pid == kDriver && (ms < 1'000 || ms % 10 != 0)) continue;
                const bool is_taken = shares.take(program(pid), at_ms(ms));
                if (pid != kDriver) continue;
                if (is_taken) shares.keep(program(pid), at_ms(ms));
                lost += is_taken ? 0 : 1;
                newest_lost_ms = is_taken ? newest_lost_ms : ms;
            }
        }
        EXPECT_LE(lost, programs > 9 ? 10 : 0) << programs << " a thousand times a second each";
        EXPECT_LT(newest_lost_ms, 1'100) << programs;
    }
}

TEST(SenderShares, let_no_number_of_programs_send_more_than_eight_may) {
    SenderShares shares;
    int taken = 0;
    for (std::int64_t ms = 0; ms < 5'000; ++ms)
        for (pid_t pid = 1; pid <= 40; ++pid) taken += shares.take(program(pid), at_ms(ms)) ? 1 : 0;
    EXPECT_LE(taken, 8 * 6 * 2048) << "at once, and then each second, of 40,000";
    EXPECT_GE(taken, 5 * 8 * 1'000);
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
