// What the flashed image does when its board fails it: no sensors, one partner on the bus, one fault.
#include <gmock/gmock.h>

#include "tests/board/image_bench.hpp"

namespace octoskin::sim::stm32 {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ImageFaults, starts_within_300_ms_and_sleeps_when_nothing_is_due) {
    ImageBench bench(block_of(bare_config()));
    bench.run(2.0);
    EXPECT_LT(*bench.first_s(), 0.3);
    EXPECT_NEAR(static_cast<double>(bench.heartbeats().size()), 20, 1);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::power_on);
    EXPECT_LT(static_cast<double>(bench.board().core().cycles()), 0.02 * 160e6 * 2.0);
    EXPECT_EQ(bench.flashes(), 1);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, tells_an_assertion_after_the_reset) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.5);
    bench.forget();
    bench.board().jump("abort");
    bench.run(1.5);
    ASSERT_FALSE(bench.heartbeats().empty());
    EXPECT_EQ(bench.heartbeats().front().reset_cause, wire::ResetCause::fault);
    ASSERT_TRUE(bench.fault());
    EXPECT_EQ(bench.fault()->kind, wire::FaultKind::assertion);
    EXPECT_EQ(bench.fault()->count, 1);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("reset fault"));
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault assertion at 0800"));
    EXPECT_EQ(bench.board().reset_count(), 1U);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, keeps_still_after_three_faults_in_ten_seconds) {
    ImageBench bench(block_of(bare_config()));
    for (int i = 0; i < 3; ++i) {
        bench.run(1.0);
        bench.board().jump("abort");
    }
    bench.forget();
    bench.run(1.0);
    ASSERT_FALSE(bench.heartbeats().empty());
    for (const auto& heartbeat : bench.heartbeats()) EXPECT_EQ(heartbeat.state, wire::NodeState::safe);
}

TEST(ImageFaults, tells_the_reset_button_from_power) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.3);
    bench.forget();
    bench.board().press_reset();
    bench.run(0.3);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::pin);
    bench.board().cycle_power();
    bench.run(0.3);
    EXPECT_EQ(bench.heartbeats().back().reset_cause, wire::ResetCause::power_on);
}

TEST(ImageFaults, is_silent_without_the_crystal_and_says_why) {
    NucleoOptions options;
    options.crystal.is_present = false;
    ImageBench bench(block_of(bare_config()), options);
    bench.run(2.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("without the crystal: CAN is silent"));
    EXPECT_EQ(bench.flashes(), 2);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, falls_silent_when_the_crystal_dies) {
    NucleoOptions options;
    options.crystal.fails_at = BoardTime{1'000'000 * kPsPerUs};
    ImageBench bench(block_of(bare_config()), options);
    bench.run(1.0);
    ASSERT_FALSE(bench.heartbeats().empty());
    bench.run(0.001);
    bench.forget();
    bench.run(2.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_EQ(bench.board().reset_count(), 1U);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("fault clock_fault at 0800"));
    EXPECT_EQ(bench.violations(), "");
}

class UnconfiguredTest : public testing::TestWithParam<wire::BitRates> {};

TEST_P(UnconfiguredTest, finds_the_rates_by_listening_then_says_bad_config) {
    NucleoOptions options;
    options.bit_rates = GetParam();
    ImageBench bench({}, options);
    bench.run(1.4);
    EXPECT_FALSE(bench.first_s()) << "not before it has listened";
    bench.run(2.6);
    ASSERT_TRUE(bench.first_s());
    EXPECT_EQ(bench.speaker(), kUnconfiguredNodeId);
    for (const auto& heartbeat : bench.heartbeats()) EXPECT_EQ(heartbeat.state, wire::NodeState::bad_config);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("is missing"));
    EXPECT_EQ(bench.flashes(), 3);
    EXPECT_EQ(bench.violations(), "");
}
INSTANTIATE_TEST_SUITE_P(usual, UnconfiguredTest,
                         testing::Values(wire::BitRates{1'000'000, 5'000'000},
                                         wire::BitRates{500'000, 2'000'000},
                                         wire::BitRates{125'000, 500'000}));

TEST(ImageFaults, stays_silent_on_a_bus_of_unknown_rates) {
    NucleoOptions options;
    options.bit_rates = {800'000, 4'000'000};
    ImageBench bench({}, options);
    bench.run(10.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, does_not_use_a_block_with_a_flipped_bit) {
    std::vector<std::uint8_t> block = block_of(bare_config());
    block[10] = static_cast<std::uint8_t>(block[10] ^ 0x20U);
    ImageBench bench(block);
    bench.run(2.0);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("is damaged"));
    EXPECT_EQ(bench.speaker(), kUnconfiguredNodeId);
}

// A write of the page that was cut short. What is read may even be right: it is not to be trusted.
TEST(ImageFaults, does_not_use_a_block_that_the_flash_itself_calls_damaged_and_lives) {
    for (const std::uint32_t offset : {0U, 16U}) {
        NucleoOptions options;
        options.damaged_flash = kConfigurationPage + offset;
        ImageBench bench(block_of(bare_config()), options);
        bench.run(4.0);
        EXPECT_EQ(bench.board().reset_count(), 0U);
        EXPECT_THAT(bench.board().serial_text(), HasSubstr("is damaged"));
        EXPECT_EQ(bench.speaker(), kUnconfiguredNodeId);
        ASSERT_FALSE(bench.heartbeats().empty());
        EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::bad_config);
        EXPECT_EQ(bench.violations(), "");
    }
}

TEST(ImageFaults, refuses_another_boards_block_under_its_own_id) {
    NodeConfig config = bare_config();
    config.board_type = 2;
    ImageBench bench(block_of(config));
    bench.run(0.5);
    EXPECT_EQ(bench.speaker(), kNode);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::bad_config);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("board type 2, is not for this board"));
}

TEST(ImageFaults, comes_back_from_bus_off_within_a_second) {
    ImageBench bench(block_of(bare_config()));
    bench.run(0.5);
    bench.board().can().set_link(CanLink::broken);
    bench.run(5.0);
    EXPECT_TRUE(bench.board().can().is_bus_off());
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("CAN bus-off, 6 since start"));
    bench.forget();
    bench.board().can().set_link(CanLink::good);
    const double mended_s = bench.now_s();
    bench.run(3.0);
    ASSERT_TRUE(bench.first_s());
    EXPECT_LT(*bench.first_s() - mended_s, 1.0);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.board().reset_count(), 0U);
}

TEST(ImageFaults, takes_back_what_nobody_acknowledges_and_goes_on) {
    ImageBench bench(block_of(bare_config()));
    bench.board().can().set_link(CanLink::unacknowledged);
    bench.run(12.0);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("frames not acknowledged"));
    EXPECT_THAT(bench.board().serial_text(), Not(HasSubstr("bus-off")));
    bench.board().can().set_link(CanLink::good);
    bench.run(2.0);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.violations(), "");
}

// --- clocks that come late, come back, or are only half there

TEST(ImageFaults, uses_a_crystal_that_is_slow_to_start) {
    for (const std::int64_t start_ms : {11, 40}) {
        NucleoOptions options;
        options.crystal.starts_in = BoardTime{start_ms * 1'000 * kPsPerUs};
        ImageBench bench(block_of(bare_config()), options);
        bench.run(0.5);
        ASSERT_TRUE(bench.first_s()) << start_ms;
        EXPECT_LT(*bench.first_s(), 0.3);
        EXPECT_EQ(bench.board().reset_count(), 0U);
        EXPECT_EQ(bench.violations(), "");
    }
}

TEST(ImageFaults, joins_within_three_seconds_of_the_crystals_return_and_says_why_it_was_silent) {
    NucleoOptions options;
    options.crystal.fails_at = BoardTime{1'000'000 * kPsPerUs};
    options.crystal.returns_at = BoardTime{5'000'000 * kPsPerUs};
    ImageBench bench(block_of(bare_config()), options);
    bench.run(1.001);
    bench.forget();
    bench.run(3.999);
    EXPECT_FALSE(bench.first_s()) << "silent without it";
    bench.run(4.0);
    ASSERT_TRUE(bench.first_s());
    EXPECT_LT(*bench.first_s(), 8.0);
    EXPECT_EQ(bench.heartbeats().front().reset_cause, wire::ResetCause::fault);
    ASSERT_TRUE(bench.fault());
    EXPECT_EQ(bench.fault()->kind, wire::FaultKind::clock_fault);
    EXPECT_EQ(bench.fault()->count, 2) << "its death, and its return";
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("the crystal runs now: starting anew"));
    EXPECT_EQ(bench.flashes(), 1);
    EXPECT_EQ(bench.violations(), "");
}

TEST(ImageFaults, does_not_reset_for_ever_for_a_crystal_that_is_never_in_time) {
    NucleoOptions options;
    options.crystal.starts_in = BoardTime{300'000 * kPsPerUs};
    ImageBench bench(block_of(bare_config()), options);
    bench.run(20.0);
    EXPECT_FALSE(bench.first_s());
    EXPECT_EQ(bench.board().reset_count(), 3U) << "then safe mode, for a minute";
}

TEST(ImageFaults, runs_on_what_it_has_if_the_core_cannot_be_switched_to_the_pll_and_says_how_fast) {
    ImageBench bench(block_of(bare_config()));
    bench.board().refuse_pll();
    // A second lasts a second, by its own light: 131 ms on, 131 off; from one second on it is tried again and
    // again.
    EXPECT_EQ(bench.flashes(900), 2);
    EXPECT_FALSE(bench.first_s()) << "CAN is silent";
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("16 MHz, without the PLL: CAN is silent"));
    EXPECT_EQ(bench.violations(), "") << "baud rate and I2C timing too are right for 16 MHz";
}

// --- the sensors

TEST(ImageFaults, names_sensors_that_do_not_answer_on_the_serial_line_and_by_the_light) {
    NodeConfig config = bare_config();
    config.sensor_count = 3;
    for (std::uint8_t i = 0; i < 3; ++i) {
        config.sensors[i].bus = i;
        config.sensors[i].address = static_cast<std::uint8_t>(0x30 + i);
        config.sensors[i].xshut_line = i;
    }
    ImageBench bench(block_of(config));
    bench.run(2.0);
    EXPECT_EQ(bench.heartbeats().back().degraded_sensors, 3);
    for (const char* line : {"sensor 0: absent, no_answer\r\n", "sensor 1: absent", "sensor 2: absent"})
        EXPECT_THAT(bench.board().serial_text(), HasSubstr(line));
    EXPECT_EQ(bench.flashes(), 5);
    const std::string text = bench.board().serial_text();
    EXPECT_EQ(text.find("sensor 0"), text.rfind("sensor 0")) << "said once, however often it is tried";
    EXPECT_EQ(bench.violations(), "");
}

// --- the CAN controller

TEST(ImageFaults, tries_a_controller_that_does_not_start_again_each_second) {
    ImageBench bench(block_of(bare_config()));
    bench.board().can().set_deaf(true);
    bench.run(2.5);
    EXPECT_FALSE(bench.first_s());
    EXPECT_THAT(bench.board().serial_text(),
                HasSubstr("does not start: CAN is silent, tried again each second"));
    EXPECT_EQ(bench.flashes(), 4);
    bench.board().can().set_deaf(false);
    const double mended_s = bench.now_s();
    bench.run(2.0);
    ASSERT_TRUE(bench.first_s());
    EXPECT_LT(*bench.first_s() - mended_s, 1.1);
    EXPECT_EQ(bench.board().reset_count(), 0U);
}

TEST(ImageFaults, recovers_from_a_message_ram_that_failed_and_tells) {
    ImageBench bench(block_of(bare_config()));
    bench.run(2.0);
    bench.forget();
    bench.board().can().lose_ram();
    bench.run(0.9);
    ASSERT_FALSE(bench.heartbeats().empty());
    EXPECT_EQ(bench.heartbeats().front().state, wire::NodeState::can_fault);
    EXPECT_GE(bench.heartbeats().size(), 8U) << "it was mended at once";
    bench.run(1.2);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_THAT(bench.board().serial_text(), HasSubstr("CAN controller failed, 1 since start"));
    // One that fails all the time is tried once a second, no more.
    for (int i = 0; i < 400; ++i) {
        bench.board().can().lose_ram();
        bench.run(0.01);
    }
    EXPECT_THAT(bench.board().serial_text(), Not(HasSubstr("failed, 7 since")));
    bench.run(3.0);
    EXPECT_EQ(bench.heartbeats().back().state, wire::NodeState::ranging);
    EXPECT_EQ(bench.board().reset_count(), 0U);
    EXPECT_EQ(bench.violations(), "");
}

}  // namespace
}  // namespace octoskin::sim::stm32
