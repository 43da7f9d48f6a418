// One sensor by itself, on a modelled part: what it tells those who hand out the bus, and when. Sensors that
// share a bus: node_*_test.cpp.
#include "firmware/core/sensor.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <utility>

#include "firmware/core/phase_clock.hpp"
#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::node {
namespace {

constexpr Microseconds kStep{20};

class SensorTest : public testing::Test, private XshutLines {
  protected:
    void set(std::uint8_t, bool is_high) override {
        bench_.set_xshut(part_, is_high);
        resets_ += is_high ? 0U : 1U;
    }

    /// 20 us, in which it has the bus if it wants it.
    void step() {
        clock_.advance(bench_.now());
        const auto due = sensor_.due();
        if (has_bus_ || (due && is_reached(*due, bench_.now())))
            has_bus_ = sensor_.advance(bench_.now()) == BusUse::keeps;
        bench_.wait(kStep);
        readings_ += sensor_.take_reading() ? 1U : 0U;
    }
    void run_until(std::uint32_t us) {
        while (bench_.now().us < us) step();
    }
    void run_for(std::uint32_t us) {
        for (std::uint32_t passed = 0; passed < us; passed += static_cast<std::uint32_t>(kStep.count()))
            step();
    }
    /// The range under way ends; then the sensor is asked ten times a second at the most.
    void rest_for(std::uint64_t us) {
        constexpr std::uint32_t kAtRestUs = 200'000;
        constexpr Microseconds kSlowly{100'000};
        run_for(kAtRestUs);
        for (std::uint64_t passed = kAtRestUs; passed < us;
             passed += static_cast<std::uint64_t>(kSlowly.count())) {
            bench_.wait(kSlowly);
            step();
        }
    }

    const SensorConfig config_ = [] {
        SensorConfig config;
        config.address = 0x30;
        config.timing_budget_ms = 20;
        config.inter_measurement_ms = 33;
        return config;
    }();
    test::SensorBench bench_;
    sim::SensorModel& part_ = bench_.add(test::wall_at(1.0));
    const vl53l1x::Options options_{};
    const Policy policy_{};
    PhaseClock clock_{bench_.now()};
    DefaultAddress default_address_{bench_.bus(), options_};
    Sensor sensor_{config_,     {bench_.bus(), default_address_, *this, clock_}, options_, {}, policy_,
                   bench_.now()};
    bool has_bus_ = false;
    std::uint32_t readings_ = 0;
    std::uint32_t resets_ = 0;
};

// It is started 264 ms after the node: the first whole period after 250 ms. Data is expected a period later,
// give or take 8 %, and looked for from 18 ms after the start on: what is asked a millisecond or more before
// it is expected can wait, and is asked in time then.
TEST_F(SensorTest, what_it_is_asked_before_its_first_data_is_expected_can_wait_until_then_and_nothing_else) {
    constexpr std::uint32_t kCanWaitUntilUs = 264'000 + 30'360 - 1'000;
    std::optional<std::uint32_t> first_us;
    std::uint32_t last_us = 0;
    while (bench_.now().us < 900'000) {
        step();
        if (!sensor_.is_deferrable(bench_.now())) continue;
        first_us = first_us.value_or(bench_.now().us);
        last_us = bench_.now().us;
        ASSERT_TRUE(sensor_.deadline_due().has_value());
        EXPECT_EQ(sensor_.deadline_due()->us, kCanWaitUntilUs);
        EXPECT_TRUE(sensor_.is_deferrable(NodeTime{kCanWaitUntilUs - 1}));
        EXPECT_FALSE(sensor_.is_deferrable(NodeTime{kCanWaitUntilUs})) << "if it had to wait until now";
        EXPECT_EQ(readings_, 0U);
    }
    ASSERT_TRUE(first_us.has_value());
    EXPECT_NEAR(*first_us, 264'000 + 18'000, 500.0)
        << "two polls found none: it is not the data of the run before";
    EXPECT_NEAR(last_us, kCanWaitUntilUs - 500, 500.0) << "it is asked every millisecond";
    EXPECT_GE(readings_, 15U);
}

// It is on the bus: what the transfer says is heard first, and no later than without the order.
TEST_F(SensorTest, an_order_to_initialise_it_anew_waits_for_the_transfer_in_flight) {
    run_until(700'000);
    while (!has_bus_) step();
    const auto due = sensor_.due();
    ASSERT_TRUE(due.has_value());
    sensor_.order_reinitialise(bench_.now());
    EXPECT_EQ(sensor_.due(), due);
    EXPECT_EQ(sensor_.state(), wire::SensorState::ranging);
    const std::uint32_t ordered_us = bench_.now().us;
    while (sensor_.state() == wire::SensorState::ranging) step();
    EXPECT_LE(bench_.now().us - ordered_us, 5'000U) << "a poll, or a reading";
    const std::uint32_t before = readings_;
    run_until(1'500'000);
    EXPECT_GE(readings_, before + 10);
}

TEST_F(SensorTest, wants_nothing_of_the_bus_while_it_is_stopped) {
    run_until(700'000);
    sensor_.order_stop(bench_.now());
    run_until(760'000);
    ASSERT_EQ(sensor_.state(), wire::SensorState::stopped);
    EXPECT_TRUE(is_reached(bench_.now() + Microseconds{59'000'000}, *sensor_.due())) << "to note a long rest";
    EXPECT_EQ(sensor_.deadline_due(), std::nullopt);
    const std::uint64_t transfers = bench_.bus().transfer_count();
    run_until(1'200'000);
    EXPECT_EQ(bench_.bus().transfer_count(), transfers);
    EXPECT_EQ(sensor_.state(), wire::SensorState::stopped);

    const std::uint32_t before = readings_;
    sensor_.order_start(bench_.now());
    run_until(1'700'000);
    EXPECT_GE(readings_, before + 10);
}

// Three minutes after it began, and over more than the 71 minutes after which the node's time wraps.
TEST_F(SensorTest, is_brought_up_anew_after_a_rest_of_more_than_a_minute_and_only_then) {
    run_for(700'000);
    sensor_.order_stop(bench_.now());
    rest_for(180'000'000);
    sensor_.order_start(bench_.now());
    run_for(700'000);
    for (const auto& [rest_us, is_long] : {std::pair{62'000'000ULL, true},
                                           {58'000'000ULL, false},
                                           {4'320'000'000ULL, true},
                                           {58'000'000ULL, false}}) {
        sensor_.order_stop(bench_.now());
        rest_for(rest_us);
        ASSERT_EQ(sensor_.state(), wire::SensorState::stopped);
        const std::uint32_t resets = resets_;
        sensor_.order_start(bench_.now());
        EXPECT_EQ(resets_, resets) << "not while others may have the bus";
        run_for(10'000);
        EXPECT_EQ(sensor_.state(), wire::SensorState::starting);
        run_for(500'000);
        EXPECT_EQ(resets_, resets + (is_long ? 1U : 0U)) << rest_us;
        EXPECT_EQ(sensor_.state(), wire::SensorState::ranging);
    }
}

TEST_F(SensorTest, stays_stopped_if_that_is_ordered_before_its_new_bring_up_has_begun) {
    run_for(700'000);
    sensor_.order_stop(bench_.now());
    rest_for(62'000'000);
    const std::uint32_t resets = resets_;
    const std::uint64_t transfers = bench_.bus().transfer_count();
    sensor_.order_start(bench_.now());
    sensor_.order_stop(bench_.now());
    EXPECT_EQ(sensor_.state(), wire::SensorState::stopped);
    run_for(100'000);
    EXPECT_EQ(resets_, resets);
    EXPECT_EQ(sensor_.due(), std::nullopt);
    EXPECT_EQ(sensor_.advance(bench_.now()), BusUse::releases) << "its turn, all the same";
    EXPECT_EQ(bench_.bus().transfer_count(), transfers);
    EXPECT_EQ(sensor_.state(), wire::SensorState::stopped);
}

}  // namespace
}  // namespace octoskin::node
