#include "firmware/port/stm32g4/can_entry.hpp"

#include <gtest/gtest.h>

#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::stm32g4 {
namespace {

constexpr wire::NodeId kNode = 7;
constexpr std::uint32_t kClock = 80'000'000;
constexpr Address kCccr = 0x4000'6418;
constexpr Address kNbtp = 0x4000'641C;
constexpr Address kIr = 0x4000'6450;
constexpr Address kRxf0s = 0x4000'6490;
constexpr Address kRxf0a = 0x4000'6494;
constexpr CanRates kRates{.nominal = 500'000, .data = 2'000'000, .has_fd = true};

class CanEntryTest : public ::testing::Test {
  protected:
    CanEntryTest() {
        space_[kCccr] = 1;
        space_.on_write(kCccr, [this](std::uint32_t& word, std::uint32_t value) {
            word = follows_ ? value : value | 1U;
            if ((word & 1U) == 0) word &= ~2U;  // CCE goes with INIT
        });
        space_.on_write(kNbtp, [this](std::uint32_t&, std::uint32_t) { ++entries_; });
        space_.on_write(kIr, [](std::uint32_t& flags, std::uint32_t value) { flags &= ~value; });
        space_.on_write(kRxf0a, [this](std::uint32_t&, std::uint32_t) { --space_[kRxf0s]; });
    }
    /// In turns of 10 ms, as a loop would.
    void run_for(std::uint32_t ms) {
        for (std::uint32_t i = 0; i < ms / 10; ++i) {
            now_ = now_ + Microseconds{10'000};
            can_.poll(now_);
            entry_.poll(now_);
        }
    }

    test::AddressSpace space_;
    MicrosecondTimer timer_;
    CanController can_{timer_};
    CanEntry entry_{can_};
    NodeTime now_{0xFFFF'0000};  // the clock wraps on the way
    bool follows_ = true;
    int entries_ = 0;
};

TEST_F(CanEntryTest, joins_at_the_rates_told) {
    entry_.begin(kRates, kNode, kClock, now_);
    EXPECT_TRUE(can_.is_started());
    run_for(10'000);
    EXPECT_EQ(entries_, 1);
}

TEST_F(CanEntryTest, tries_again_once_a_second_as_long_as_it_takes) {
    follows_ = false;
    entry_.begin(kRates, kNode, kClock, now_);
    EXPECT_FALSE(can_.is_started());
    run_for(9'500);
    EXPECT_EQ(entries_, 10);
    follows_ = true;
    run_for(600);
    EXPECT_TRUE(can_.is_started());
    EXPECT_EQ(entries_, 11);
}

TEST_F(CanEntryTest, never_tries_without_a_clock) {
    entry_.begin(kRates, kNode, 0, now_);
    run_for(5'000);
    EXPECT_TRUE(space_.writes().empty());
}

TEST_F(CanEntryTest, comes_back_at_once_after_a_failure_and_not_more_than_once_a_second) {
    entry_.begin(kRates, kNode, kClock, now_);
    run_for(2'000);
    space_[kCccr] |= 4U;  // ASM
    run_for(10);
    EXPECT_TRUE(can_.is_started());
    EXPECT_EQ(entries_, 2);
    for (int i = 0; i < 300; ++i) {
        space_[kCccr] |= 4U;
        run_for(10);
    }
    EXPECT_LE(entries_, 5);
}

TEST_F(CanEntryTest, comes_back_at_once_even_after_half_the_clocks_range_on_the_bus) {
    entry_.begin(kRates, kNode, kClock, now_);
    run_for(2'000);
    now_ = now_ + Microseconds{(std::int64_t{1} << 31) + 5};
    space_[kCccr] |= 4U;
    run_for(10);
    EXPECT_TRUE(can_.is_started());
}

TEST_F(CanEntryTest, is_well_at_once_after_a_failure_that_lasted_for_half_the_clocks_range) {
    entry_.begin(kRates, kNode, kClock, now_);
    run_for(1'000);
    follows_ = false;
    space_[kCccr] = 1;
    run_for(40 * 60'000);
    EXPECT_EQ(can_.state(), node::CanState::passive);
    follows_ = true;
    run_for(2'000);
    ASSERT_TRUE(can_.is_started());
    EXPECT_EQ(can_.state(), node::CanState::active);
}

TEST_F(CanEntryTest, looks_for_the_rates_if_nobody_told_them_and_keeps_looking_when_listening_fails) {
    follows_ = false;
    entry_.begin(std::nullopt, kNode, kClock, now_);
    EXPECT_FALSE(can_.is_listening());
    run_for(900);
    EXPECT_EQ(entries_, 1);
    follows_ = true;
    run_for(200);
    EXPECT_TRUE(can_.is_listening());
    for (int i = 0; i < 3; ++i) {
        ++space_[kRxf0s];
        space_[kIr] |= 1U;
        can_.on_interrupt();
    }
    run_for(1'300);
    EXPECT_FALSE(can_.is_started());
    run_for(300);
    EXPECT_TRUE(can_.is_started());
}

}  // namespace
}  // namespace octoskin::stm32g4
