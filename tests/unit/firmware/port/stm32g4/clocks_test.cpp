#include "firmware/port/stm32g4/clocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "firmware/port/stm32g4/clock_plan.hpp"
#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::stm32g4 {
namespace {

constexpr Address kCr = 0x4002'1000;
constexpr Address kCfgr = 0x4002'1008;
constexpr Address kPllcfgr = 0x4002'100C;
constexpr Address kAcr = 0x4002'2000;
constexpr Address kPsc = 0x4000'0028;

TEST(ClockPlan, is_160_mhz_and_80_for_can) {
    EXPECT_EQ(kCrystalPlan.pllcfgr(), 0x0130'5053U);  // by hand from RM0440's bit positions
    EXPECT_EQ(kCrystalPlan.vco_in_hz(), 4'000'000U);
    EXPECT_EQ(kCrystalPlan.vco_hz(), 320'000'000U);
    EXPECT_EQ(kCrystalPlan.core_hz(), 160'000'000U);
    EXPECT_EQ(kCrystalPlan.can_hz(), 80'000'000U);
    EXPECT_EQ(kInternalPlan.pllcfgr(), 0x0130'5032U);
    EXPECT_EQ(kInternalPlan.core_hz(), 160'000'000U);
}

TEST(ClockPlan, refuses_what_the_chip_cannot_do) {
    const auto changed = [](auto member, std::uint32_t value) {
        ClockPlan plan = kCrystalPlan;
        plan.*member = value;
        return plan.is_allowed();
    };
    EXPECT_TRUE(kCrystalPlan.is_allowed());
    EXPECT_FALSE(changed(&ClockPlan::divide_in, 0x11U));
    EXPECT_FALSE(changed(&ClockPlan::divide_in, 7U));  // no whole number of hertz
    EXPECT_FALSE(changed(&ClockPlan::divide_in, 1U));  // 24 MHz into the phase detector
    EXPECT_FALSE(changed(&ClockPlan::multiply, 7U));
    EXPECT_FALSE(changed(&ClockPlan::multiply, 128U));
    EXPECT_FALSE(changed(&ClockPlan::multiply, 87U));  // 348 MHz
    EXPECT_FALSE(changed(&ClockPlan::multiply, 23U));  // 92 MHz
    EXPECT_FALSE(changed(&ClockPlan::divide_core, 3U));
    EXPECT_FALSE(changed(&ClockPlan::divide_can, 10U));
    EXPECT_FALSE(changed(&ClockPlan::multiply, 86U));  // 172 MHz core
}

TEST(ClockPlan, waits_for_flash_as_the_manual_says) {
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> kLimits = {
        {34'000'000, 0}, {68'000'000, 1}, {102'000'000, 2}, {136'000'000, 3}, {170'000'000, 4}};
    for (const auto& [limit_hz, states] : kLimits) {
        EXPECT_EQ(flash_wait_states(limit_hz), states);
        EXPECT_EQ(flash_wait_states(limit_hz + 1), states + 1);
    }
}

/// Oscillators, PLL and clock switch that follow their orders, unless told not to.
class ClocksTest : public ::testing::Test {
  protected:
    ClocksTest() {
        space_[kCr] = 0x0000'0500;    // HSI16 on and ready
        space_[kCfgr] = 0x5;          // and used
        space_[0x4000'7080] = 0x100;  // PWR_CR5: range 1 normal
        space_[0x4000'7000] = 0x200;  // PWR_CR1
        space_[kAcr] = 0x0004'0600;   // both caches, DBG_SWEN
        space_.before_read(kCr, [this](std::uint32_t& cr) {
            follow(cr, 16, has_crystal_);
            follow(cr, 24, locks_);
        });
        space_.before_read(kCfgr, [this](std::uint32_t& cfgr) {
            const bool follows = (cfgr & 3U) == 3U ? switches_ : returns_;
            if (follows) cfgr = (cfgr & ~0xCU) | ((cfgr & 3U) << 2U);
        });
        space_.before_read(kAcr, [this](std::uint32_t& acr) {
            if (!flash_follows_) acr &= ~0xFU;
        });
    }
    static void follow(std::uint32_t& cr, unsigned on_bit, bool works) {
        const bool is_ready = works && ((cr >> on_bit) & 1U) != 0;
        cr = (cr & ~(2U << on_bit)) | (is_ready ? 2U << on_bit : 0);
    }
    [[nodiscard]] std::size_t place_of(Address address, std::uint32_t mask, std::uint32_t value) const {
        const auto& writes = space_.writes();
        const auto found = std::find_if(writes.begin(), writes.end(), [&](const auto& write) {
            return write.address == address && (write.value & mask) == value;
        });
        EXPECT_NE(found, writes.end()) << std::hex << address << " never became " << value;
        return static_cast<std::size_t>(found - writes.begin());
    }

    test::AddressSpace space_;
    MicrosecondTimer timer_;
    bool has_crystal_ = true;
    bool locks_ = true;
    bool switches_ = true;  ///< to the PLL
    bool returns_ = true;   ///< to the internal oscillator
    bool flash_follows_ = true;
};

TEST_F(ClocksTest, come_from_the_crystal) {
    const Clocks clocks = start_clocks(timer_);
    EXPECT_EQ(clocks.source, ClockSource::crystal);
    EXPECT_EQ(clocks.core_hz, 160'000'000U);
    EXPECT_EQ(clocks.can_hz, 80'000'000U);
    EXPECT_EQ(space_[kPllcfgr], 0x0130'5053U);
    EXPECT_EQ(space_[kAcr], 0x0004'0704U) << "4 wait states, prefetch, both caches; the debugger may come in";
    EXPECT_EQ(space_[kCfgr] & 0xF0U, 0U);
    EXPECT_EQ(space_[kCfgr] & 3U, 3U);
    EXPECT_EQ((space_[kCr] >> 19U) & 1U, 1U) << "clock security";
    EXPECT_EQ((space_[0x4002'1088] >> 24U) & 3U, 1U) << "CAN from PLLQ";
    EXPECT_EQ(space_[kPsc], 159U);
    EXPECT_EQ(space_[0x4000'7080], 0U) << "boost";
    EXPECT_EQ(space_[0x4000'7008], 1U << 14U) << "no pull-downs of USB-C on PB4 and PB6";
}

TEST_F(ClocksTest, change_in_an_order_that_the_chip_survives) {
    (void)start_clocks(timer_);
    const std::size_t boost = place_of(0x4000'7080, 0x100, 0);
    const std::size_t configured = place_of(kPllcfgr, 0xFFFF'FFFF, 0x0130'5053);
    const std::size_t locked = place_of(kCr, 1U << 24U, 1U << 24U);
    const std::size_t slow_flash = place_of(kAcr, 0xF, 4);
    const std::size_t half_speed = place_of(kCfgr, 0xF0, 0x80);
    const std::size_t switched = place_of(kCfgr, 3, 3);
    EXPECT_LT(boost, switched);
    EXPECT_LT(configured, locked);
    EXPECT_LT(locked, switched);
    EXPECT_LT(slow_flash, switched);
    EXPECT_LT(half_speed, switched);
    const auto speeds = space_.written_to(kCfgr);
    EXPECT_EQ(speeds.back() & 0xF0U, 0U) << "full speed comes last";
    EXPECT_EQ(speeds.back() & 3U, 3U);
}

TEST_F(ClocksTest, fall_back_to_the_internal_oscillator_without_can) {
    has_crystal_ = false;
    const std::uint32_t begun = space_.time_us();
    const Clocks clocks = start_clocks(timer_);
    EXPECT_EQ(clocks.source, ClockSource::internal);
    EXPECT_EQ(clocks.core_hz, 160'000'000U);
    EXPECT_EQ(clocks.can_hz, 0U);
    EXPECT_EQ(space_[kPllcfgr], 0x0130'5032U);
    EXPECT_EQ((space_[kCr] >> 16U) & 1U, 0U) << "the crystal is off";
    EXPECT_EQ((space_[kCr] >> 19U) & 1U, 0U) << "no clock security without a crystal";
    EXPECT_GE(space_.time_us() - begun, 50'000U);
    EXPECT_LE(space_.time_us() - begun, 52'000U);
}

TEST_F(ClocksTest, stay_as_they_were_if_the_pll_does_not_lock) {
    locks_ = false;
    const Clocks clocks = start_clocks(timer_);
    EXPECT_EQ(clocks.source, ClockSource::unlocked);
    EXPECT_EQ(clocks.core_hz, 16'000'000U);
    EXPECT_EQ(clocks.can_hz, 0U);
    EXPECT_EQ(space_[kCfgr] & 3U, 1U) << "never switched";
    EXPECT_EQ(space_[kPsc], 15U);
}

TEST_F(ClocksTest, do_not_run_ahead_of_the_flash) {
    flash_follows_ = false;
    EXPECT_EQ(start_clocks(timer_).source, ClockSource::unlocked);
    EXPECT_EQ(space_[kCfgr] & 3U, 1U);
}

TEST_F(ClocksTest, wait_no_longer_than_allowed_for_the_switch) {
    switches_ = false;
    const std::uint32_t begun = space_.time_us();
    const Clocks clocks = start_clocks(timer_);
    EXPECT_EQ(clocks.source, ClockSource::unlocked);
    EXPECT_EQ(clocks.core_hz, 16'000'000U);
    EXPECT_EQ(clocks.can_hz, 0U);
    EXPECT_EQ(space_[kCfgr] & 0xF0U, 0U) << "not left at half speed";
    EXPECT_EQ(space_[kCfgr] & 3U, 1U);
    EXPECT_EQ(space_[kPsc], 15U) << "a microsecond is a microsecond";
    EXPECT_LE(space_.time_us() - begun, 3'000U);
}

// It switched too late to be seen in time, and does not go back either: what the registers show is told.
TEST_F(ClocksTest, tell_the_speed_that_the_registers_show) {
    switches_ = returns_ = false;
    space_.on_write(kCfgr, [](std::uint32_t& word, std::uint32_t value) {
        const bool is_back = (value & 3U) == 1 && (word & 3U) == 3;
        word = is_back ? (value & ~0xCU) | 0xCU : (value & ~0xCU) | (word & 0xCU);
    });
    const Clocks clocks = start_clocks(timer_);
    EXPECT_EQ(clocks.source, ClockSource::unlocked);
    EXPECT_EQ(clocks.core_hz, 80'000'000U) << "from the PLL, divided by two";
    EXPECT_EQ(space_[kPsc], 79U);
    EXPECT_EQ(clocks.can_hz, 0U);
}

TEST_F(ClocksTest, look_for_a_crystal_without_waiting) {
    has_crystal_ = false;
    (void)start_clocks(timer_);
    EXPECT_FALSE(is_crystal_running());
    EXPECT_EQ((space_[kCr] >> 16U) & 1U, 1U) << "it is asked to start";
    has_crystal_ = true;
    EXPECT_TRUE(is_crystal_running());
}

TEST(MicrosecondTimer, counts_microseconds_and_wakes_once) {
    test::AddressSpace space;
    MicrosecondTimer timer;
    timer.start(160'000'000);
    EXPECT_EQ(space[kPsc], 159U);
    EXPECT_EQ(space[0x4000'002C], 0xFFFF'FFFFU);
    EXPECT_EQ(space.written_to(0x4000'0014), std::vector<std::uint32_t>{1});  // loads the prescaler

    space.time_us() = 100;
    space.forget_writes();
    timer.wake_at(NodeTime{500});
    EXPECT_EQ(space[0x4000'0034], 500U);
    EXPECT_EQ(space[0x4000'000C], 2U);
    EXPECT_TRUE(space.written_to(0x4000'0014).empty());
    timer.on_interrupt();
    EXPECT_EQ(space[0x4000'000C], 0U);
    EXPECT_EQ(space[0x4000'0010] & 2U, 0U);
}

TEST(MicrosecondTimer, raises_at_once_what_is_past_even_over_the_wrap) {
    test::AddressSpace space;
    MicrosecondTimer timer;
    for (const std::uint32_t now : {1000U, 5U}) {
        space.time_us() = now;
        space.forget_writes();
        timer.wake_at(NodeTime{now - 10});
        EXPECT_EQ(space.written_to(0x4000'0014), std::vector<std::uint32_t>{2});  // CC1G
    }
}

TEST(MicrosecondTimer, waits_at_least_as_long_as_asked) {
    test::AddressSpace space;
    const MicrosecondTimer timer;
    space.time_us() = 0xFFFF'FFFE;
    timer.wait(Microseconds{5});
    EXPECT_GE(space.time_us() - 0xFFFF'FFFEU, 6U);
}

}  // namespace
}  // namespace octoskin::stm32g4
