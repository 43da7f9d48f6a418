// A bus that cannot be freed, and one that can, again. Who is next on a bus that works: node_*_test.cpp.
#include "firmware/core/bus_worker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/core/phase_clock.hpp"
#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::node {
namespace {

/// A part that holds SDA for good, its own reset notwithstanding: a short.
class ShortedBus final : public i2c::Bus {
  public:
    explicit ShortedBus(i2c::Bus& bus) : bus_(bus) {}
    [[nodiscard]] bool is_busy() const override { return bus_.is_busy(); }
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override {
        ++transfers;
        bus_.submit(transfer, now, deadline);
    }
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override {
        const i2c::TransferState state = bus_.poll(now);
        return state == i2c::TransferState::done && is_shorted ? i2c::TransferState::failed : state;
    }
    [[nodiscard]] i2c::TransferError error() const override {
        return is_shorted ? i2c::TransferError::bus_stuck : bus_.error();
    }
    bool recover() override {
        ++recoveries;
        return bus_.recover() && !is_shorted;
    }
    bool is_shorted = false;
    int recoveries = 0;
    int transfers = 0;

  private:
    i2c::Bus& bus_;
};

SensorConfig config_of(std::uint8_t sensor) {
    SensorConfig config;
    config.xshut_line = sensor;
    config.address = static_cast<std::uint8_t>(0x30 + sensor);
    config.phase_us = static_cast<std::uint16_t>(16'500U * sensor);
    return config;
}

class BusWorkerTest : public testing::Test, private XshutLines {
  protected:
    BusWorkerTest() {
        for (Sensor& sensor : sensors_) worker_.add(sensor);
    }
    void set(std::uint8_t line, bool is_high) override {
        is_raised_.at(line) = is_high;
        bench_.set_xshut(*parts_.at(line), is_high);
    }
    void run_until(std::uint32_t us) {
        for (; bench_.now().us < us; bench_.wait(Microseconds{20})) worker_.poll(bench_.now());
    }
    [[nodiscard]] bool are_all(wire::SensorState state) const {
        return std::ranges::all_of(sensors_,
                                   [state](const Sensor& sensor) { return sensor.state() == state; });
    }

    test::SensorBench bench_;
    std::array<sim::SensorModel*, 2> parts_{&bench_.add(test::wall_at(1.0)), &bench_.add(test::wall_at(1.0))};
    std::array<bool, 2> is_raised_{};
    ShortedBus bus_{bench_.bus()};
    const vl53l1x::Options options_;
    const Policy policy_;
    PhaseClock clock_{bench_.now()};
    BusWorker worker_{bus_, 400'000, options_, policy_, DataReadyHint{nullptr, 0, policy_}};
    const SensorSurroundings surroundings_{worker_.shared_bus(), worker_.default_address(), *this, clock_};
    const std::array<SensorConfig, 2> configs_{config_of(0), config_of(1)};
    std::array<Sensor, 2> sensors_{
        {{configs_[0], surroundings_, options_, RangingRules{}, policy_, bench_.now()},
         {configs_[1], surroundings_, options_, RangingRules{}, policy_, bench_.now()}}};
};

TEST_F(BusWorkerTest,
       a_bus_that_cannot_be_freed_is_tried_again_after_its_sensors_were_reset_then_once_a_second) {
    run_until(500'000);
    ASSERT_TRUE(are_all(wire::SensorState::ranging));
    ASSERT_FALSE(worker_.is_faulty());
    EXPECT_EQ(bus_.recoveries, 1) << "before its first use";

    bus_.is_shorted = true;
    while (!worker_.is_faulty()) run_until(bench_.now().us + 20);
    const std::uint32_t faulty_us = bench_.now().us;
    EXPECT_LE(faulty_us, 540'000U) << "a period, and a transfer tried twice";
    EXPECT_EQ(bus_.recoveries, 2);
    EXPECT_EQ(is_raised_, (std::array{false, false})) << "whoever holds the bus may be in need of a reset";
    EXPECT_TRUE(are_all(wire::SensorState::lost));
    for (const Sensor& sensor : sensors_) EXPECT_EQ(sensor.fault(), wire::SensorFault::bus_error);
    ASSERT_TRUE(worker_.wake_time().has_value());
    EXPECT_NEAR(worker_.wake_time()->us - faulty_us, 2'000.0, 20.0);

    const int transfers = bus_.transfers;
    run_until(faulty_us + 1'900);
    EXPECT_EQ(bus_.recoveries, 2);
    run_until(faulty_us + 2'100);
    EXPECT_EQ(bus_.recoveries, 3) << "all are in reset now";
    run_until(faulty_us + 5'500'000);
    EXPECT_EQ(bus_.recoveries, 3 + 5) << "once a second";
    EXPECT_EQ(bus_.transfers, transfers) << "nothing is begun on it meanwhile";

    bus_.is_shorted = false;
    run_until(faulty_us + 6'500'000);
    EXPECT_FALSE(worker_.is_faulty());
    EXPECT_TRUE(are_all(wire::SensorState::ranging));
}

}  // namespace
}  // namespace octoskin::node
