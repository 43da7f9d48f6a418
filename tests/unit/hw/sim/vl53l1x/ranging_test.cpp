// When the part ranges, and how it tells: period, window, interrupt, stream count. Oracles: UM2510, UM2356,
// UM2555 and what users measured.
#include <gtest/gtest.h>

#include <set>

#include "tests/unit/hw/sim/vl53l1x/ranging_part.hpp"

namespace octoskin::sim {
namespace {

using test::Bytes;

TEST_F(RangingPart, first_range_after_the_default_configuration_takes_about_103_ms) {
    use({});
    bench_.play("W 0060 0F | W 0063 0D | W 005E 01 CC | W 0061 01 F1 | W 0081 9B | W 006C 00 00 0F 89");
    const SimTime start = bench_.time();
    bench_.write(0x0087, {0x40});
    const auto ready = ready_times(1);
    ASSERT_EQ(ready.size(), 1U);
    EXPECT_NEAR(static_cast<double>(ready[0] - start.us), 102'000.0, 2'000.0);
}

TEST_F(RangingPart, window_is_the_budget_and_its_middle_is_what_the_scene_is_asked_for) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(2).size(), 2U);
    for (const RangingRecord& record : part_->history()) {
        EXPECT_EQ(record.ready.us - record.window_middle.us, 10'000) << "half of 20 ms";
    }
}

// 37 ticks a millisecond nominally, 6.4 % fast: 1312 ticks are 33.3 ms and not the 33 ms asked for.
TEST_F(RangingPart, period_is_the_registers_by_the_parts_own_clock) {
    for (const std::uint16_t oscillator : {std::uint16_t{30}, std::uint16_t{37}, std::uint16_t{45}}) {
        for (const double factor : {1.04, 1.064, 1.09}) {
            use({.osc_calibrate = oscillator, .slow_clock_factor = factor});
            bench_.write(0x0001, {0x30});
            bench_.write(0x0001, {0x29}, 0x30);
            configure(1312);
            bench_.write(0x0087, {0x40});
            const auto ready = ready_times(3);
            ASSERT_EQ(ready.size(), 3U);
            EXPECT_NEAR(static_cast<double>(ready[2] - ready[1]), 1312.0 / oscillator / factor * 1e3, 1.0);
            bench_.set_xshut(*part_, false);
        }
    }
}

TEST_F(RangingPart, a_slot_within_4_ms_of_the_ranging_is_missed_and_the_period_doubles) {
    use({.osc_calibrate = 40, .slow_clock_factor = 1.0});
    configure(24 * 40);
    bench_.write(0x0087, {0x40});
    auto ready = ready_times(3);
    EXPECT_EQ(ready[2] - ready[1], 24'000) << "20 ms + 4 ms: just in time";
    bench_.write(0x0087, {0x80});
    configure(24 * 40 - 1);
    bench_.write(0x0087, {0x40});
    ready = ready_times(3);
    EXPECT_EQ(ready[2] - ready[1], 2 * 23'975);
}

TEST_F(RangingPart, the_guard_between_ranging_and_slot_is_the_parts) {
    use({.osc_calibrate = 40, .slow_clock_factor = 1.0, .slot_guard = Microseconds{0}});
    configure(20 * 40);
    bench_.write(0x0087, {0x40});
    const auto ready = ready_times(3);
    EXPECT_EQ(ready[2] - ready[1], 20'000);
}

// Ready one period after the start as ever; under way from 5 ms before its window of 20 ms.
TEST_F(RangingPart, a_range_may_begin_before_its_window) {
    use({.osc_calibrate = 40, .slow_clock_factor = 1.0, .range_overhead = Microseconds{5'000}});
    configure(25 * 40);
    const SimTime start = bench_.time();
    bench_.write(0x0087, {0x40});
    auto ready = ready_times(2);
    EXPECT_NEAR(static_cast<double>(ready[0] - start.us), 25'000.0, 150.0);
    EXPECT_EQ(ready[1] - ready[0], 25'000) << "no slot is missed for 20 + 5 ms";
    EXPECT_EQ(part_->history()[1].ready.us - part_->history()[1].window_middle.us, 10'000);

    bench_.write(0x0087, {0x80});
    configure(25 * 40 - 1);
    bench_.write(0x0087, {0x40});
    ready = ready_times(2);
    EXPECT_EQ(ready[1] - ready[0], 2 * 24'975);

    bench_.wait(Microseconds{2 * 24'975 - 24'000});
    bench_.write(0x0087, {0x00});  // a millisecond after it began, in its overhead
    EXPECT_EQ(ready_times(1).size(), 1U) << "the range under way still ends";
    EXPECT_EQ(ready_times(1).size(), 0U);
}

TEST_F(RangingPart, stream_count_runs_0_to_255_then_128_to_255_for_ever) {
    use({.osc_calibrate = 37, .slow_clock_factor = 1.0});
    configure(30 * 37);
    bench_.write(0x0087, {0x40});
    unsigned expected = 0;
    std::size_t seen = 0;
    for (int result = 0; result < 700; ++result) {
        bench_.wait(Microseconds{30'000});
        part_->advance(bench_.time());
        const auto& history = part_->history();
        ASSERT_EQ(history.back().index, seen++);
        ASSERT_EQ(history.back().result.stream_count, expected) << result;
        expected = expected == 255 ? 128 : expected + 1;
    }
}

TEST_F(RangingPart, each_start_begins_with_stream_count_0) {
    use({});
    configure(1312);
    for (int run = 0; run < 2; ++run) {
        bench_.write(0x0087, {0x40});
        ASSERT_EQ(ready_times(3).size(), 3U);
        EXPECT_EQ(bench_.read(0x008B, 1), Bytes{2});
        bench_.write(0x0087, {0x80});
    }
}

TEST_F(RangingPart, pin_follows_result_and_clear_in_both_polarities) {
    for (const std::uint8_t control : {std::uint8_t{0x01}, std::uint8_t{0x11}}) {
        const bool is_active_low = control == 0x11;
        use({});
        configure(1312);
        bench_.write(0x0030, {control});
        EXPECT_EQ(part_->gpio1_level(bench_.time()), is_active_low);
        bench_.write(0x0087, {0x40});
        ASSERT_EQ(ready_times(1).size(), 1U);
        EXPECT_EQ(part_->gpio1_level(bench_.time()), !is_active_low);
        EXPECT_EQ(bench_.read(0x0031, 1)[0] & 1, is_active_low ? 0 : 1);
        bench_.write(0x0086, {0x00});
        EXPECT_EQ(part_->gpio1_level(bench_.time()), !is_active_low) << "only bit 0 clears";
        bench_.write(0x0086, {0x01});
        EXPECT_EQ(part_->gpio1_level(bench_.time()), is_active_low);
        EXPECT_EQ(bench_.read(0x0031, 1)[0] & 1, is_active_low ? 1 : 0);
        bench_.set_xshut(*part_, false);
        EXPECT_TRUE(part_->gpio1_level(bench_.time())) << "open drain";
    }
}

TEST_F(RangingPart, pin_stays_idle_unless_its_function_is_the_interrupt) {
    use({});
    configure(1312);
    bench_.write(0x0030, {0x00});
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(1).size(), 1U);
    EXPECT_FALSE(part_->gpio1_level(bench_.time())) << "bits 3:0 select the interrupt";
    bench_.write(0x0030, {0x01});
    EXPECT_TRUE(part_->gpio1_level(bench_.time()));
}

TEST_F(RangingPart, does_not_start_unless_its_firmware_is_enabled) {
    use({});
    configure(1312);
    bench_.write(0x0085, {0x00});
    bench_.write(0x0087, {0x40});
    EXPECT_TRUE(ready_times(1).empty());
    bench_.write(0x0085, {0x01});
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(ready_times(1).size(), 1U);
}

// Pololu's library notes that a 1 in 0x71 or 0x7C asks for a 0 in 0x82.
TEST_F(RangingPart, gives_no_result_while_its_parameters_are_held) {
    for (const std::uint16_t held : {std::uint16_t{0x71}, std::uint16_t{0x7C}, std::uint16_t{0x82}}) {
        use({});
        configure(1312);
        bench_.write(held, {0x01});
        bench_.write(0x0087, {0x40});
        EXPECT_TRUE(ready_times(1).empty()) << held;
        bench_.write(held, {0x00});
        EXPECT_EQ(ready_times(1).empty(), held != 0x82) << held;
        bench_.write(0x0082, {0x00});
        EXPECT_EQ(ready_times(1).size(), 1U) << held;
        bench_.set_xshut(*part_, false);
    }
}

TEST_F(RangingPart, results_go_on_while_nobody_clears) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(5).size(), 5U);
    EXPECT_EQ(bench_.read(0x008B, 1), Bytes{4});
    EXPECT_EQ(bench_.read(0x0031, 1)[0] & 1, 1);
}

TEST_F(RangingPart, a_setting_written_during_a_range_applies_from_the_next_one) {
    use({});
    configure(1312);
    bench_.write(0x0080, {0x77});
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(1).size(), 1U);
    EXPECT_EQ(part_->history().back().roi, (Roi{.centre_spad = 199, .width = 8, .height = 8}));
    bench_.wait(Microseconds{20'000});  // the second range is under way
    bench_.write(0x007F, {0xA7});
    bench_.write(0x0080, {0x33});
    ASSERT_EQ(ready_times(2).size(), 2U);
    EXPECT_EQ(part_->history()[1].roi, (Roi{.centre_spad = 199, .width = 8, .height = 8}));
    EXPECT_EQ(part_->history()[2].roi, (Roi{.centre_spad = 167, .width = 4, .height = 4}));
}

TEST_F(RangingPart, one_read_is_one_snapshot_and_two_may_straddle_an_update) {
    int torn = 0;
    for (std::int64_t shift = 0; shift < 1'200; shift += 25) {
        test::SensorBench bench;
        SensorModel& part = bench.add_booted([](std::uint32_t index, SimTime, const Roi&) {
            return RangingReturn{.range_m = index + 1.0, .sigma_m = 0.001, .peak_signal_mcps = 10.0 + index};
        });
        bench.play("W 0060 0F | W 0063 0D | W 0069 B8 | W 005E 00 1E | W 0061 00 22 | W 006C 00 00 05 20");
        bench.write(0x0087, {0x40});
        bench.wait(Microseconds{45'000});
        part.advance(bench.time());
        const std::int64_t next_ready = part.history().back().ready.us + 33'326;
        bench.wait(Microseconds{next_ready - bench.time().us - 600 + shift});

        const Bytes block = bench.read(0x0089, 17);
        const unsigned stream = block[2];
        EXPECT_EQ(block[13] * 256U + block[14], (stream + 1) * 1000) << "within a block all belongs together";
        EXPECT_EQ(block[5] * 256U + block[6], (10 + stream) * 128);
        const Bytes again = bench.read(0x0089, 17);
        if (again[2] != block[2]) ++torn;
    }
    EXPECT_GT(torn, 5) << "the update must fall between two reads for some of the shifts";
}

TEST_F(RangingPart, faults_of_interrupt_and_stream) {
    use({});
    configure(1312);
    part_->set_faults({.never_ready = true});
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(2).size(), 2U);
    EXPECT_FALSE(bench_.await_ready(Microseconds{100'000}));
    part_->set_faults({.freezes_stream = true});
    ASSERT_EQ(ready_times(2).size(), 2U);
    EXPECT_EQ(part_->history().back().result.stream_count,
              part_->history()[part_->history().size() - 2].result.stream_count);
    part_->set_faults({.is_always_ready = true});
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.write(0x0086, {0x01});
    EXPECT_TRUE(bench_.await_ready(Microseconds{1'000}));
}

}  // namespace
}  // namespace octoskin::sim
