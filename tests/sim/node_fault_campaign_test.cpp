// Random faults of buses and sensors, from a seed. Whatever happens, a reading that is sent was truly taken:
// this distance, in this zone, at this time within the bound told; and when the faults are over the fleet
// comes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "tests/sim/capture_oracle.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using sim::I2cFaultKind;
using test::capture_error_us;
using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;
using test::ToldBounds;
using test::TrueRange;
using test::truth_of;

constexpr Microseconds kStep{50'000};
constexpr int kFaultySteps = 120;
constexpr Microseconds kQuiet{22'000'000};  // two of the longest waits between attempts, and a bring-up
constexpr std::uint8_t kSensors = 6;
constexpr std::size_t kBuses = 2;

// Only results are read twice. A bit flipped in a poll that is believed alone moves the capture time by as
// much as the rhythm left open, and the ready times of this range and of the next may stray from the rhythm
// on top.
constexpr node::Policy kPolicy;
constexpr std::int64_t kOnePollUs = (kPolicy.lone_poll_accepted + 2 * kPolicy.ready_jitter).count();

// Faults that the double read, the stream count, the read-back and the error handling must catch.
constexpr std::array<I2cFaultKind, 10> kBusFaults = {
    I2cFaultKind::nack_address, I2cFaultKind::nack_byte,        I2cFaultKind::nack_read,
    I2cFaultKind::flip_bit,     I2cFaultKind::lose_arbitration, I2cFaultKind::stretch,
    I2cFaultKind::read_ones,    I2cFaultKind::sda_stuck_low,    I2cFaultKind::flip_written_bit,
    I2cFaultKind::lose_write};

class Campaign {
  public:
    explicit Campaign(std::uint32_t seed)
        : random_(seed), rig_(config(), parts(random_), sim::NodeClock{{0xFFFFFFFFU - 4'000'000U}, 50.0}) {
        for (int step = 0; step < kFaultySteps; ++step) {
            if (step >= 20 && draw(4) == 0) disturb();
            rig_.run_for(kStep);
        }
        for (std::size_t sensor = 0; sensor < kSensors; ++sensor) rig_.sensor(sensor).set_faults({});
        rig_.run_for(kQuiet);
    }
    [[nodiscard]] NodeRig& rig() { return rig_; }

  private:
    static NodeConfig config() {
        NodeConfig config = fleet_config(kSensors, kBuses);
        for (std::uint8_t i = 0; i < kSensors; i = static_cast<std::uint8_t>(i + 2)) {
            config.sensors[i].zone_count = 2;
            config.sensors[i].zones[0] = {.centre_spad = 167, .width = 8, .height = 16};
            config.sensors[i].zones[1] = {.centre_spad = 231, .width = 8, .height = 8};
        }
        return config;
    }
    static std::vector<SensorSetup> parts(std::mt19937& random) {
        std::vector<SensorSetup> setups(kSensors);
        for (auto& setup : setups) {
            setup.part.slow_clock_factor = 1.0 + 0.0001 * static_cast<double>(random() % 1'600);
        }
        return setups;
    }
    std::uint32_t draw(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

    void disturb() {
        const std::size_t sensor = draw(kSensors);
        switch (draw(8)) {
            case 0:
                rig_.sensor(sensor).brown_out(rig_.now());
                break;
            case 1:
                rig_.sensor(sensor).set_faults({.freezes_stream = true});
                break;
            case 2:
                rig_.sensor(sensor).set_faults({.never_ready = true});
                break;
            case 3:
                rig_.sensor(sensor).set_faults({.is_always_ready = true});
                break;
            case 4:
                rig_.sensor(sensor).set_faults({.holds_sda_clocks = 1 + draw(40)});
                break;
            default:
                disturb_bus();
                break;
        }
        if (draw(3) == 0) rig_.sensor(draw(kSensors)).set_faults({});
    }
    void disturb_bus() {
        sim::SimulatedI2cBus& bus = rig_.bus(draw(kBuses));
        const I2cFaultKind kind = kBusFaults.at(draw(kBusFaults.size()));
        // Data that is wrong twice in the same way is beyond what reading twice can see; so is what is
        // written to a wrong place and read back from there.
        const bool alters_data = kind == I2cFaultKind::flip_bit || kind == I2cFaultKind::read_ones ||
                                 kind == I2cFaultKind::flip_written_bit;
        bus.inject({.kind = kind,
                    .first = bus.transfer_count() + draw(60),
                    .count = alters_data ? 1 : 1 + draw(3),
                    .position = kind == I2cFaultKind::sda_stuck_low ? 1 + draw(30) : draw(136)});
    }

    std::mt19937 random_;
    NodeRig rig_;
};

class Judge {
  public:
    explicit Judge(const NodeRig& rig) : rig_(rig), bounds_(rig) {}
    /// Empty if the reading is true; else what is wrong with it.
    [[nodiscard]] std::string complaint(std::uint8_t sensor, const SaidReading& said) const {
        const TrueRange* truth = truth_of(rig_, sensor, said);
        if (truth == nullptr) return "no range had this distance";
        const NodeConfig config = zones_of(sensor);
        if (!(truth->roi == config.sensors[0].zones.at(said.reading.zone))) return "taken in another zone";
        const std::int64_t error_us = capture_error_us(rig_, said, *truth);
        const std::int64_t bound_us = bounds_.at(sensor, said.end);
        if (std::abs(error_us) > bound_us + kOnePollUs) {
            return "captured " + std::to_string(error_us) + " us beside the truth, told " +
                   std::to_string(bound_us);
        }
        return {};
    }

  private:
    static NodeConfig zones_of(std::uint8_t sensor) {
        NodeConfig config;
        if (sensor % 2 == 0) {
            config.sensors[0].zones[0] = {.centre_spad = 167, .width = 8, .height = 16};
            config.sensors[0].zones[1] = {.centre_spad = 231, .width = 8, .height = 8};
        }
        return config;
    }
    const NodeRig& rig_;
    ToldBounds bounds_;
};

/// OCTOSKIN_CAMPAIGN_SEEDS: more of them for a release.
std::uint32_t seed_count() {
    const char* text = std::getenv("OCTOSKIN_CAMPAIGN_SEEDS");
    return text == nullptr ? 100U : static_cast<std::uint32_t>(std::stoul(text));
}

/// These once gave readings a false time: an altered poll that said "not ready" of data that was overdue, or
/// "ready" of a sensor that never was, or a rhythm taken for doubled on the word of a frozen stream count.
constexpr std::array<std::uint32_t, 6> kOnceFalse = {1208, 1286, 2043, 2087, 3376, 3678};

TEST(NodeFaultCampaign, sends_nothing_but_the_truth_and_recovers_for_every_seed) {
    std::uint32_t restarts = 0;
    std::vector<std::uint32_t> seeds(seed_count());
    std::iota(seeds.begin(), seeds.end(), 0U);
    seeds.insert(seeds.end(), kOnceFalse.begin(), kOnceFalse.end());
    for (const std::uint32_t seed : seeds) {
        Campaign campaign(seed);
        NodeRig& rig = campaign.rig();
        const Judge judge(rig);
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            for (const SaidReading& said : rig.readings_of(sensor)) {
                EXPECT_EQ(judge.complaint(sensor, said), "")
                    << "seed " << seed << " sensor " << int{sensor} << " at " << said.end.us;
            }
            EXPECT_EQ(rig.last_health(sensor)->state, wire::SensorState::ranging)
                << "seed " << seed << " sensor " << int{sensor};
        }
        EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 0) << "seed " << seed;
        EXPECT_EQ(rig.undecodable_count(), 0U);
        restarts += rig.node().counts().sensor_restarts;
    }
    EXPECT_GT(restarts, 500U) << "the faults hardly did anything";
}

}  // namespace
}  // namespace octoskin::node
