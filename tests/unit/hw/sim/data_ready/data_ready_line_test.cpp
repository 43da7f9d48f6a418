// The line of two sensors on one bus, driven register by register.
#include "hw/sim/data_ready/data_ready_line.hpp"

#include <gtest/gtest.h>

#include "hw/sim/data_ready/simulated_data_ready_lines.hpp"
#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kFirst = 0x31;
constexpr std::uint8_t kSecond = 0x32;

class TwoSensors : public testing::Test {
  protected:
    TwoSensors() {
        for (const std::uint8_t address : {kFirst, kSecond}) {
            sensors_.push_back(&bench_.add_booted(test::wall_at(1.0)));
            bench_.write(0x0001, {address});
            lines_.line(1).attach(*sensors_.back());
        }
    }
    /// Timed ranging with the pin active low, as after reset, and the interrupt on every sample.
    void start(std::uint8_t address) {
        bench_.write(0x0046, {0x20}, address);
        bench_.write(0x0085, {0x01}, address);
        bench_.write(0x0086, {0x01}, address);
        bench_.write(0x0087, {0x40}, address);
    }
    void clear(std::uint8_t address) { bench_.write(0x0086, {0x01}, address); }
    [[nodiscard]] bool is_high() { return lines_.line(1).is_high(bench_.time()); }
    /// From change to change until the line is low.
    bool run_to_fall() {
        const SimTime limit{bench_.time().us + 1'000'000};
        while (is_high()) {
            const auto next = lines_.next_change(bench_.time());
            if (!next || *next > limit) return false;
            bench_.wait(Microseconds{next->us - bench_.time().us});
            lines_.look(bench_.time());
        }
        return true;
    }

    test::SensorBench bench_;
    std::vector<SensorModel*> sensors_;
    SimulatedDataReadyLines lines_;
};

TEST_F(TwoSensors, idle_leave_it_high_and_have_nothing_in_store) {
    EXPECT_TRUE(is_high());
    EXPECT_FALSE(lines_.next_change(bench_.time()));
}

TEST_F(TwoSensors, one_pulls_it_low_exactly_when_its_data_is_ready_and_the_clear_lets_it_go) {
    start(kFirst);
    ASSERT_TRUE(run_to_fall());
    EXPECT_EQ(sensors_[0]->history().back().ready, bench_.time());
    clear(kFirst);
    EXPECT_TRUE(is_high());
}

TEST_F(TwoSensors, share_it_until_the_last_is_cleared) {
    start(kFirst);
    start(kSecond);
    ASSERT_TRUE(run_to_fall());
    bench_.wait(2ms);  // the second is ready by now, too
    clear(kFirst);
    EXPECT_FALSE(is_high());
    clear(kSecond);
    EXPECT_TRUE(is_high());
}

TEST_F(TwoSensors, make_one_fall_if_the_second_follows_before_the_first_is_cleared) {
    lines_.look(bench_.time());
    start(kFirst);
    start(kSecond);
    ASSERT_TRUE(run_to_fall());
    EXPECT_TRUE(lines_.take_fall(1));
    EXPECT_FALSE(lines_.take_fall(1)) << "told once";
    bench_.wait(2ms);
    lines_.look(bench_.time());
    EXPECT_FALSE(lines_.take_fall(1));
    EXPECT_FALSE(lines_.take_fall(0)) << "another bus";
}

TEST_F(TwoSensors, in_reset_let_it_go) {
    start(kFirst);
    ASSERT_TRUE(run_to_fall());
    bench_.set_xshut(*sensors_[0], false);
    EXPECT_TRUE(is_high());
}

TEST_F(TwoSensors, active_high_by_mistake_hold_it_low_while_idle) {
    bench_.write(0x0030, {0x01}, kSecond);
    EXPECT_FALSE(is_high());
}

TEST_F(TwoSensors, cannot_move_a_stuck_wire) {
    start(kFirst);
    for (const LineFault fault : {LineFault::stuck_low, LineFault::stuck_high}) {
        lines_.line(1).set_fault(fault);
        EXPECT_FALSE(lines_.next_change(bench_.time()));
        bench_.wait(300ms);
        EXPECT_EQ(is_high(), fault == LineFault::stuck_high);
        clear(kFirst);
        EXPECT_EQ(is_high(), fault == LineFault::stuck_high);
    }
}

TEST(DataReadyLine, that_chatters_has_another_level_each_microsecond) {
    DataReadyLine line;
    line.set_fault(LineFault::chatters);
    EXPECT_NE(line.is_high({1'000}), line.is_high({1'001}));
    EXPECT_EQ(line.next_change({1'000}), SimTime{1'001});
}

}  // namespace
}  // namespace octoskin::sim
