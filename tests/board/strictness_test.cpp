// Every rule of the models, broken on purpose by a program that does all else right.
#include <gmock/gmock.h>

#include "tests/board/tiny_board.hpp"

namespace octoskin::sim::stm32 {
namespace {

struct Offence {
    const char* function;
    Rule rule;
    const char* says;  ///< within the report
};
void PrintTo(const Offence& offence, std::ostream* out) {
    *out << offence.function;
}

constexpr Offence kOffences[] = {
    {"unclocked_gpio", Rule::unclocked, "GPIOA"},
    {"unclocked_i2c", Rule::unclocked, "I2C1"},
    {"unclocked_message_ram", Rule::unclocked, "SRAMCAN"},
    {"unknown_peripheral", Rule::not_modelled, "0x40020000"},
    {"unknown_register", Rule::not_modelled, "I2C1"},
    {"reserved_bits", Rule::reserved_bits, "I2C1.CR2"},
    {"read_only_register", Rule::read_only, "GPIOA.IDR"},
    {"narrow_write", Rule::access_width, "TIM2"},
    {"narrow_message_ram", Rule::access_width, "SRAMCAN"},
    {"too_few_wait_states", Rule::flash_latency, "wait states"},
    {"debugger_shut_out", Rule::debug_access, "DBG_SWEN"},
    {"no_boost", Rule::flash_latency, "boost"},
    {"no_half_speed_step", Rule::clock_tree, "without HPRE"},
    {"half_speed_too_short", Rule::clock_tree, "less than 1 us"},
    {"pll_changed_while_on", Rule::clock_tree, "PLLCFGR"},
    {"pll_off_while_used", Rule::clock_tree, "PLL switched off"},
    {"crystal_off_while_used", Rule::clock_tree, "HSE switched off"},
    {"switch_to_dead_pll", Rule::clock_tree, "not ready"},
    {"vco_too_fast", Rule::clock_tree, "VCO"},
    {"pll_without_source", Rule::clock_tree, "source"},
    {"flash_programming", Rule::not_modelled, "programming"},
    {"timing_while_enabled", Rule::wrong_state, "TIMINGR"},
    {"too_fast_timing", Rule::bus_timing, "TIMINGR"},
    {"start_without_pins", Rule::pin_function, "I2C1"},
    {"push_pull_pins", Rule::pin_function, "I2C1"},
    {"start_while_disabled", Rule::wrong_state, "PE=0"},
    {"start_while_busy", Rule::start_while_busy, "middle of a transfer"},
    {"start_twice", Rule::wrong_state, "START is still set"},
    {"data_overwritten", Rule::data_lost, "TXDR"},
    {"empty_data_read", Rule::data_lost, "RXDR"},
    {"enable_pulse_too_short", Rule::wrong_state, "PE set again"},
    {"line_driven_high", Rule::pin_function, "I2C1: a line is driven high"},
    {"xshut_driven_high", Rule::pin_function, "XSHUT line 42 is driven high"},
    {"bit_timing_without_cce", Rule::wrong_state, "0x1C"},
    {"cce_without_init", Rule::wrong_state, "CCE"},
    {"fd_without_cce", Rule::wrong_state, "mode bits"},
    {"wrong_bit_rate", Rule::bus_timing, "500000 bit/s"},
    {"no_delay_compensation", Rule::bus_timing, "without delay compensation"},
    {"wrong_delay_compensation", Rule::bus_timing, "TDCO"},
    {"can_on_internal_clock", Rule::clock_tree, "internal oscillator"},
    {"request_during_init", Rule::wrong_state, "INIT=1"},
    {"request_not_at_put_index", Rule::wrong_state, "put index"},
    {"request_of_same_identifier", Rule::wrong_state, "which goes first"},
    {"request_twice", Rule::data_lost, "requested while pending"},
    {"acknowledge_empty_fifo", Rule::wrong_state, "RXF0A"},
    {"fd_frame_without_fdoe", Rule::wrong_state, "FDOE"},
    {"watchdog_locked", Rule::wrong_state, "locked"},
    {"watchdog_while_updating", Rule::wrong_state, "updated"},
    {"watchdog_bad_key", Rule::wrong_state, "no key"},
    {"uart_divider_while_enabled", Rule::wrong_state, "UE=1"},
    {"uart_wrong_rate", Rule::bus_timing, "baud"},
    {"uart_overwritten", Rule::data_lost, "TDR"},
    {"uart_off", Rule::wrong_state, "TDR"},
    {"priority_bits", Rule::reserved_bits, "IPR"},
    {"vector_table_alignment", Rule::exception_model, "VTOR"},
    {"reset_without_key", Rule::wrong_state, "AIRCR"},
    {"deep_sleep", Rule::not_modelled, "SLEEPDEEP"},
    {"unclocked_syscfg", Rule::unclocked, "SYSCFG"},
    {"syscfg_reserved_bits", Rule::reserved_bits, "SYSCFG.EXTICR4"},
    {"line_of_no_port", Rule::wrong_state, "line 12"},
    {"exti_reserved_bits", Rule::reserved_bits, "EXTI.RTSR1"},
    {"exti_narrow_write", Rule::access_width, "EXTI"},
    {"exti_line_of_no_pin", Rule::not_modelled, "lines of no pin"},
    {"exti_second_bank", Rule::not_modelled, "0x20"},
    {"exti_event", Rule::not_modelled, "events"},
    {"exti_unknown_register", Rule::not_modelled, "EXTI"},
    {"exti_analog_pin", Rule::pin_function, "line 12"},
};

/// Answers to everything.
class Anybody final : public I2cTarget {
  public:
    bool on_start(std::uint8_t, bool, SimTime) override { return true; }
    bool on_write(std::uint8_t, SimTime) override { return true; }
    std::uint8_t on_read(SimTime) override { return 0; }
    void on_stop(SimTime) override {}
};

class StrictnessTest : public testing::TestWithParam<Offence> {};

TEST_P(StrictnessTest, is_reported_with_its_place) {
    Anybody anybody;
    TinyBoard tiny("strictness");
    tiny.board().wire(0).attach(anybody);
    tiny.jump(GetParam().function);
    ASSERT_TRUE(tiny.run_until_finished());
    const auto& violations = tiny.board().log().all();
    const auto found = std::ranges::find_if(violations, [](const Violation& violation) {
        return violation.rule == GetParam().rule && violation.what.find(GetParam().says) != std::string::npos;
    });
    ASSERT_NE(found, violations.end()) << "reported: " << tiny.violations();
    for (const Violation& violation : violations) {
        EXPECT_EQ(violation.rule, GetParam().rule) << "nothing else is reported: " << tiny.violations();
    }
    EXPECT_GE(found->pc, 0x0800'0000U);
    EXPECT_LT(found->pc, 0x0801'0000U);
}
INSTANTIATE_TEST_SUITE_P(Rules, StrictnessTest, testing::ValuesIn(kOffences),
                         [](const auto& tested) { return std::string(tested.param.function); });

class RightTest : public testing::TestWithParam<const char*> {};

TEST_P(RightTest, is_not_reported) {
    TinyBoard tiny("strictness");
    tiny.jump(GetParam());
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.violations(), "");
}
INSTANTIATE_TEST_SUITE_P(Programs, RightTest,
                         testing::Values("everything_right", "i2c_right", "can_right", "uart_right",
                                         "exti_right"));

TEST(SerialPort, says_what_was_written) {
    TinyBoard tiny("strictness");
    tiny.jump("uart_right");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.board().serial_text(), "ok");
}

TEST(Interrupts, come_again_while_their_flag_stays_set) {
    TinyBoard tiny("strictness");
    tiny.jump("level_interrupt");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.result(0), 3U);
    EXPECT_LT(tiny.board().now().us, 200) << "without waiting for the timer's next periods";
}

TEST(ExternalInterrupt, comes_by_software_and_not_from_a_line_at_rest) {
    TinyBoard tiny("strictness");
    tiny.jump("exti_right");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.result(2), 0U);
    EXPECT_EQ(tiny.result(0), 1U);
    EXPECT_EQ(tiny.result(3), 0U) << "clearing the one clears the other";
}

TEST(ExternalInterrupt, comes_with_each_fall_and_leaves_no_trace_of_those_that_are_masked) {
    TinyBoard tiny("strictness");
    tiny.board().data_ready(0).set_fault(LineFault::chatters);
    tiny.jump("exti_falls");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.result(0), 5U);
    EXPECT_EQ(tiny.result(2), 0U);
    EXPECT_EQ(tiny.violations(), "");
}

TEST(ExternalInterrupt, comes_with_falls_or_with_both_edges_as_selected) {
    TinyBoard tiny("strictness");
    tiny.board().data_ready(0).set_fault(LineFault::chatters);
    tiny.jump("exti_both_edges");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_NEAR(tiny.result(2), 50.0, 2.0);
    // Twice as many, less those that come before the handler has cleared the one before: they are one.
    EXPECT_GT(tiny.result(3), 75U);
    EXPECT_LE(tiny.result(3), 101U);
    EXPECT_EQ(tiny.violations(), "");
}

TEST(ExternalInterrupt, comes_again_until_it_is_cleared) {
    TinyBoard tiny("strictness");
    tiny.jump("exti_not_cleared");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.result(0), 3U);
}

TEST(ExternalInterrupt, of_another_line_is_not_this_ones) {
    TinyBoard tiny("strictness");
    tiny.board().data_ready(1).set_fault(LineFault::chatters);  // PB13
    tiny.jump("exti_right");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_EQ(tiny.result(2), 0U);
}

TEST(Timer2, compares_when_the_counter_arrives_and_once_a_period) {
    TinyBoard tiny("strictness");
    tiny.jump("timer_compare");
    ASSERT_TRUE(tiny.run_until_finished());
    EXPECT_NEAR(tiny.result(0), 500.0, 5.0);
    EXPECT_EQ(tiny.result(1), 0U) << "it was put there, it did not arrive";
    EXPECT_NEAR(tiny.result(2), 500.0, 5.0);
    EXPECT_EQ(tiny.result(3), 1U) << "the counter came round in between";
    EXPECT_EQ(tiny.violations(), "");
}

TEST(Watchdog, bites_after_300_counts_of_16_slow_clocks_and_keeps_ram) {
    TinyBoard tiny("strictness");
    tiny.jump("watchdog_bites");
    ASSERT_TRUE(tiny.run_until_finished(2));
    const std::int64_t refreshed = tiny.board().now().us;
    ASSERT_TRUE(tiny.run_until_finished(1)) << "the program tells after the reset";
    EXPECT_NEAR(static_cast<double>(tiny.board().now().us - refreshed), 150'000.0, 200.0);
    EXPECT_EQ(tiny.result(0) >> 24U, 0x2CU) << "watchdog, pin and, never cleared, brown-out";
    EXPECT_EQ(tiny.board().reset_count(), 1U);
    EXPECT_EQ(tiny.violations(), "");
}

TEST(Watchdog, runs_on_its_own_oscillator) {
    NucleoOptions options;
    options.lsi_hz = 24'000;
    TinyBoard tiny("strictness", options);
    tiny.jump("watchdog_bites");
    ASSERT_TRUE(tiny.run_until_finished(2));
    const std::int64_t refreshed = tiny.board().now().us;
    ASSERT_TRUE(tiny.run_until_finished(1));
    EXPECT_NEAR(static_cast<double>(tiny.board().now().us - refreshed), 200'000.0, 300.0);
}

TEST(Reset, by_software_is_told_and_keeps_ram) {
    TinyBoard tiny("strictness");
    tiny.jump("software_reset");
    ASSERT_TRUE(tiny.run_until_finished(1));
    EXPECT_EQ(tiny.result(0) >> 24U, 0x1CU);
}

TEST(Reset, by_power_loses_ram) {
    TinyBoard tiny("strictness");
    tiny.jump("software_reset");
    ASSERT_TRUE(tiny.run_until_finished(1));
    tiny.board().cycle_power();
    EXPECT_NE(tiny.state(), 1U);
    EXPECT_FALSE(tiny.run_until_finished(1, 10'000)) << "the program found garbage and went idle";
}

TEST(Crystal, failing_under_the_security_system_is_an_nmi_on_the_internal_oscillator) {
    NucleoOptions options;
    options.crystal.fails_at = BoardTime{50'000 * kPsPerUs};
    TinyBoard tiny("strictness", options);
    tiny.jump("security_system");
    ASSERT_TRUE(tiny.run_until_finished(2));
    ASSERT_TRUE(tiny.run_until_finished(1));
    EXPECT_EQ(tiny.result(0), 1U << 8);
    EXPECT_EQ(tiny.result(1), 1U);
    EXPECT_GE(tiny.board().now().us, 50'000);
}

TEST(Crystal, that_is_absent_never_becomes_ready) {
    NucleoOptions options;
    options.crystal.is_present = false;
    TinyBoard tiny("strictness", options);
    tiny.jump("everything_right");
    EXPECT_FALSE(tiny.run_until_finished(1, 100'000));
}

TEST(Drift, makes_the_boards_time_run_faster_than_true_time) {
    NucleoOptions options;
    options.drift_ppm = 100.0;
    TinyBoard tiny("strictness", options);
    tiny.board().run_until({1'000'000});
    EXPECT_NEAR(static_cast<double>(tiny.board().board_time().ps), 1.0001e12, 1e6);
    EXPECT_NEAR(static_cast<double>(tiny.board().now().us), 1'000'000.0, 1.0);
}

}  // namespace
}  // namespace octoskin::sim::stm32
