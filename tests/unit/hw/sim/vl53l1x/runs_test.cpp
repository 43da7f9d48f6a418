// From start to stop: what begins a run of ranges, what ends it, and what disturbs it. Oracles: UM2510,
// UM2356 and ST's full API (STSW-IMG007 2.3.3).
#include <gtest/gtest.h>

#include "tests/unit/hw/sim/vl53l1x/ranging_part.hpp"

namespace octoskin::sim {
namespace {

using test::Bytes;

TEST_F(RangingPart, counts_what_it_must_not_get_while_it_ranges) {
    use({.range_overhead = Microseconds{3'000}});
    configure(1312);
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(part_->disturbance_count(), 0U) << "started";
    bench_.wait(Microseconds{2'000});
    configure(1312);
    EXPECT_EQ(part_->disturbance_count(), 0U) << "the period that it has";
    configure(1313);
    EXPECT_EQ(part_->disturbance_count(), 1U) << "another period from start to stop";
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(part_->disturbance_count(), 1U) << "no range had begun yet";
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.wait(Microseconds{13'400 - 3'000 + 500});
    bench_.write(0x0087, {0x00});
    EXPECT_EQ(part_->disturbance_count(), 1U) << "a stop is always in order";
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(part_->disturbance_count(), 2U) << "started anew in the overhead of a range";
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.wait(Microseconds{20'000});
    bench_.write(0x0087, {0x80});
    EXPECT_EQ(part_->disturbance_count(), 3U) << "cut";
    configure(1312);
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(part_->disturbance_count(), 3U);
}

TEST_F(RangingPart, stop_lets_the_running_range_end_and_abort_does_not) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.wait(Microseconds{18'000});  // the second range is under way
    bench_.write(0x0087, {0x00});
    bench_.wait(Microseconds{200'000});
    part_->advance(bench_.time());
    EXPECT_EQ(part_->history().size(), 2U);

    bench_.write(0x0087, {0x40});
    bench_.wait(Microseconds{20'000});
    bench_.write(0x0087, {0x80});
    bench_.wait(Microseconds{200'000});
    part_->advance(bench_.time());
    EXPECT_EQ(part_->history().size(), 2U);
}

TEST_F(RangingPart, start_takes_back_a_stop) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.wait(Microseconds{25'000});  // the second range is under way
    bench_.write(0x0087, {0x00});
    bench_.write(0x0087, {0x40});
    EXPECT_EQ(ready_times(3).size(), 3U);
    EXPECT_EQ(part_->history().back().result.stream_count, 2) << "a run of its own";
}

TEST_F(RangingPart, stop_between_two_ranges_is_the_end) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    ASSERT_EQ(ready_times(1).size(), 1U);
    bench_.wait(Microseconds{2'000});
    bench_.write(0x0087, {0x00});
    bench_.wait(Microseconds{200'000});
    part_->advance(bench_.time());
    EXPECT_EQ(part_->history().size(), 1U);
}

// With every clear ST's full API (STSW-IMG007 2.3.3, VL53L1_clear_interrupt_and_enable_next_range) writes the
// mode anew, and a stream count of 0 is to it the first range of a run.
TEST_F(RangingPart, a_start_in_its_mode_lets_the_stream_go_on_and_may_begin_the_period_anew) {
    for (const bool is_restarted : {true, false}) {
        use({.is_restarted_by_start = is_restarted});
        configure(1312);
        bench_.write(0x0087, {0x40});
        auto last = ready_times(1);
        ASSERT_EQ(last.size(), 1U);
        for (std::uint8_t range = 1; range <= 3; ++range) {
            bench_.wait(Microseconds{range * 6'000});  // between two ranges, and in one
            bench_.write(0x0086, {0x01, 0x40});
            const std::int64_t started_us = bench_.time().us;
            const auto ready = ready_times(1);
            ASSERT_EQ(ready.size(), 1U);
            EXPECT_NEAR(static_cast<double>(ready[0] - (is_restarted ? started_us : last[0])), 33'327.0, 50.0)
                << "1312 ticks of 37 a millisecond, 6.4 % fast";
            EXPECT_EQ(part_->history().back().result.stream_count, range);
            last = ready;
        }
        EXPECT_EQ(part_->disturbance_count(), is_restarted ? 1U : 0U) << "the third was in a range";
        for (const std::uint8_t other_mode : {std::uint8_t{0x20}, std::uint8_t{0x40}, std::uint8_t{0x10}}) {
            bench_.write(0x0087, {other_mode});
            ASSERT_EQ(ready_times(1).size(), 1U);
            EXPECT_EQ(part_->history().back().result.stream_count, 0) << int{other_mode};
        }
        bench_.set_xshut(*part_, false);
    }
}

TEST_F(RangingPart, single_shot_gives_one_result_after_the_budget) {
    use({});
    configure(1312);
    const SimTime start = bench_.time();
    bench_.write(0x0087, {0x10});
    const auto ready = ready_times(1);
    ASSERT_EQ(ready.size(), 1U);
    EXPECT_NEAR(static_cast<double>(ready[0] - start.us), 20'000.0, 200.0);
    bench_.wait(Microseconds{500'000});
    part_->advance(bench_.time());
    EXPECT_EQ(part_->history().size(), 1U);
}

TEST_F(RangingPart, back_to_back_waits_for_the_clear) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x20});
    EXPECT_TRUE(bench_.await_ready(Microseconds{30'000}));
    bench_.wait(Microseconds{500'000});
    part_->advance(bench_.time());
    EXPECT_EQ(part_->history().size(), 1U);
    bench_.write(0x0086, {0x01});
    EXPECT_TRUE(bench_.await_ready(Microseconds{30'000}));
    EXPECT_EQ(bench_.read(0x008B, 1), Bytes{1});
}

}  // namespace
}  // namespace octoskin::sim
