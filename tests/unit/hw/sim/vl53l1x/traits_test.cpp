// Parts that are as their maker made them, and not as a driver may presume: one trait at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hw/sim/vl53l1x/sensor_traits.hpp"
#include "tests/unit/hw/sim/vl53l1x/ranging_part.hpp"

namespace octoskin::sim {
namespace {

using test::Bytes;

SensorPart with(const SensorTraits& traits) {
    SensorPart part;
    part.traits = traits;
    return part;
}

TEST_F(RangingPart, reads_a_register_otherwise_and_holds_what_was_written) {
    use(with({.misread = {{.index = 0x47, .value = 0x0C}, {.index = 0x64, .value = 0x80, .mask = 0xF0}}}));
    bench_.write(0x0047, {0x0B, 0x33});
    EXPECT_EQ(bench_.read(0x0047, 2), (Bytes{0x0C, 0x33}));
    EXPECT_EQ(bench_.read(0x0046, 3)[1], 0x0C) << "in a burst, too";
    EXPECT_EQ(part_->registers().at(0x47), 0x0B);
    bench_.write(0x0064, {0x3A});
    EXPECT_EQ(bench_.read(0x0064, 1), Bytes{0x8A}) << "the bits of the mask only";
}

std::vector<std::int64_t> beyond(const std::vector<std::int64_t>& times, std::int64_t period_us) {
    std::vector<std::int64_t> strays;
    for (std::size_t i = 0; i < times.size(); ++i)
        strays.push_back(times[i] - times[0] - static_cast<std::int64_t>(i) * period_us);
    return strays;
}

// Period register 1312 is 33.4 ms of this part (ranging_test.cpp).
TEST_F(RangingPart, takes_longer_for_each_range_by_anything_up_to_the_spread_and_keeps_its_slots) {
    use({});
    configure(1312);
    bench_.write(0x0087, {0x40});
    const auto even = ready_times(50);
    const std::int64_t period_us = (even.back() - even.front()) / 49;

    test::SensorBench other;
    bench_.write(0x0087, {0x00});
    bench_.wait(Microseconds{200'000});
    part_->set_xshut(false, bench_.time());
    use(with({.range_spread = Microseconds{1'000}}));
    configure(1312);
    bench_.write(0x0087, {0x40});
    const auto strays = beyond(ready_times(50), period_us);
    const auto [least, most] = std::ranges::minmax(strays);
    EXPECT_GT(most - least, 700);
    EXPECT_LE(most - least, 1'000 + 49) << "and 1 us a period for rounding";
    EXPECT_GT(std::set(strays.begin(), strays.end()).size(), 40U) << "without a rhythm";
}

TEST_F(RangingPart, takes_a_step_longer_where_there_is_a_target) {
    bool is_there = false;
    const RangingScene scene = [&is_there](std::uint32_t, SimTime, const Roi&) {
        return is_there ? RangingReturn{.range_m = 1.0, .sigma_m = 0.005, .peak_signal_mcps = 16.0}
                        : RangingReturn{};
    };
    part_ = &bench_.add_booted(scene, with({.range_step = Microseconds{300}}));
    configure(1312);
    bench_.write(0x0087, {0x40});
    const auto without = ready_times(3);
    is_there = true;
    const auto with_target = ready_times(3);
    const std::int64_t period_us = without[2] - without[1];
    EXPECT_EQ(without[1] - without[0], period_us);
    EXPECT_EQ(with_target[0] - without[2], period_us + 300);
    EXPECT_EQ(with_target[2] - with_target[1], period_us);
}

TEST_F(RangingPart, loads_its_registers_late_and_forgets_what_was_written_before) {
    part_ = &bench_.add(test::wall_at(1.0), with({.boot_load = Microseconds{3'000}}));
    bench_.set_xshut(*part_, true);
    bench_.wait(Microseconds{1'500});
    EXPECT_EQ(bench_.read(0x00E5, 1)[0] & 1U, 0U);
    bench_.write(0x0001, {0x30});
    bench_.write(0x0047, {0x55}, 0x30);
    bench_.wait(Microseconds{3'000});
    EXPECT_FALSE(bench_.transfer(0x30, {0x00, 0xE5}, 1).has_value()) << "back at 0x29";
    EXPECT_EQ(bench_.read(0x00E5, 1)[0] & 1U, 1U);
    EXPECT_NE(bench_.read(0x0047, 1)[0], 0x55);
    bench_.write(0x0001, {0x30});
    bench_.wait(Microseconds{10'000});
    EXPECT_EQ(bench_.read(0x00E5, 1, 0x30)[0] & 1U, 1U) << "once";
}

TEST(SensorTraits, are_of_the_sensors_that_are_meant) {
    const std::vector<TraitsOf> all{
        {.traits = {.range_spread = Microseconds{100}}},
        {.node_id = 2, .traits = {.misread = {{.index = 0x47, .value = 1}}}},
        {.node_id = 2, .sensor = 3, .traits = {.misread = {{.index = 0x7C, .value = 2}}}},
        {.sensor = 4, .traits = {.range_spread = Microseconds{50}, .boot_load = Microseconds{7}}}};
    EXPECT_EQ(traits_of(all, 1, 3), SensorTraits{.range_spread = Microseconds{100}});
    EXPECT_EQ(traits_of(all, 2, 3).misread.size(), 2U);
    EXPECT_EQ(traits_of(all, 2, 0).misread.size(), 1U);
    EXPECT_EQ(traits_of(all, 1, 4),
              (SensorTraits{.range_spread = Microseconds{100}, .boot_load = Microseconds{7}}));
}

TEST(SensorTraits, survive_as_the_text_that_another_process_is_told_them_in) {
    const TraitsOf traits{
        .sensor = 3,
        .traits = {.misread = {{.index = 0x47, .value = 12}, {.index = 0x1FF, .value = 255, .mask = 0}},
                   .range_spread = Microseconds{1'000},
                   .range_step = Microseconds{300},
                   .boot_load = Microseconds{3'000}}};
    EXPECT_EQ(parse_traits(to_text(traits)), traits);
    EXPECT_EQ(parse_traits(to_text(TraitsOf{})), TraitsOf{});
    for (const char* text : {"sensor", "sensor=256", "sensor=-1", "reads=1", "register=71,reads=256",
                             "register=65536", "colour=1", "range_spread_us=", "range_spread_us=1x", ","}) {
        EXPECT_FALSE(parse_traits(text)) << text;
    }
}

}  // namespace
}  // namespace octoskin::sim
