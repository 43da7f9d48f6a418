// The fault campaign on the small rig, a thousand seeds of a virtual minute: two nodes on one CAN bus, four
// sensors, 10 Hz, clocks up to 100 ppm apart that wrap on the way, and faults of buses, sensors, CAN and
// controllers, all from one seed. Whatever happens, what arrives was truly measured, each reading once and in
// order (P1); every reading that a node accepted is accounted for (P2); and 25 s after the last fault all
// four range and both heartbeats say so (P5). A failure prints its seed.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

using sim::CanFaultKind;
using sim::I2cFaultKind;
using wire::NodeState;
using wire::ResetCause;
using wire::SensorState;

/// OCTOSKIN_CAMPAIGN_SEEDS: more of them for a release, or few while one looks for something.
std::uint32_t seed_count() {
    const char* text = std::getenv("OCTOSKIN_CAMPAIGN_SEEDS");
    return text == nullptr ? 1'000U : static_cast<std::uint32_t>(std::stoul(text));
}

constexpr Microseconds kStep{250'000};
constexpr int kCalmSteps = 8;
constexpr int kFaultySteps = 132;  // 33 s; 2 s before and 25 s after it are calm
constexpr std::uint8_t kSensors = 2;

constexpr std::array<I2cFaultKind, 8> kBusFaults = {
    I2cFaultKind::nack_address, I2cFaultKind::nack_byte,        I2cFaultKind::nack_read,
    I2cFaultKind::flip_bit,     I2cFaultKind::lose_arbitration, I2cFaultKind::stretch,
    I2cFaultKind::read_ones,    I2cFaultKind::sda_stuck_low};

NodeConfig config_of(wire::NodeId id) {
    NodeConfig config = fleet_config(kSensors, 1);
    config.node_id = id;
    for (std::uint8_t i = 0; i < kSensors; ++i) {
        config.sensors[i].inter_measurement_ms = 100;
        config.sensors[i].phase_us = static_cast<std::uint16_t>(50'000U * i);
    }
    return config;
}

class Campaign {
  public:
    explicit Campaign(std::uint32_t seed) : random_(seed) {
        for (const wire::NodeId id : std::array<wire::NodeId, 2>{5, 6}) {
            const sim::NodeClock clock{{0xFFFF'FFFFU - draw(60'000'000)},
                                       static_cast<double>(draw(201)) - 100.0};
            std::vector<SensorSetup> setups(kSensors);
            for (auto& setup : setups) setup.part.slow_clock_factor = 1.0 + 0.0001 * draw(1'600);
            nodes_.push_back(std::make_unique<NodeRig>(config_of(id), setups, clock));
        }
        for (int step = 0; step < kCalmSteps; ++step) run(kStep);
        for (int step = 0; step < kFaultySteps; ++step) {
            if (draw(4) == 0) disturb(*nodes_[draw(2)]);
            run(kStep);
        }
        for (auto& rig : nodes_) {
            for (std::size_t sensor = 0; sensor < kSensors; ++sensor) rig->sensor(sensor).set_faults({});
        }
        for (int i = 0; i < 100; ++i) run(kStep);
    }
    [[nodiscard]] std::vector<std::unique_ptr<NodeRig>>& nodes() { return nodes_; }
    [[nodiscard]] std::uint32_t disturbances() const { return disturbances_; }

  private:
    std::uint32_t draw(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

    /// Each node hears what the other said in the step before, as it would on a bus that both are on.
    void run(Microseconds duration) {
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            nodes_[i]->run_for(duration);
            const auto& frames = nodes_[i]->frames();
            for (; heard_[i] < frames.size(); ++heard_[i]) {
                NodeRig& other = *nodes_[1 - i];
                other.node().on_frame(frames[heard_[i]], other.node_now());
            }
        }
    }

    void disturb(NodeRig& rig) {
        ++disturbances_;
        const std::size_t sensor = draw(kSensors);
        switch (draw(12)) {
            case 0:
                rig.sensor(sensor).brown_out(rig.now());
                break;
            case 1:
                rig.sensor(sensor).set_faults({.freezes_stream = true});
                break;
            case 2:
                rig.sensor(sensor).set_faults({.never_ready = true});
                break;
            case 3:
                rig.sensor(sensor).set_faults({.is_always_ready = true});
                break;
            case 4:
                rig.sensor(sensor).set_faults({.holds_sda_clocks = 1 + draw(40)});
                break;
            case 5:
                rig.can().add_fault({.kind = CanFaultKind::disturb, .count = 1 + draw(100)});
                break;
            case 6:
                rig.block_transmission(draw(2) == 0);
                break;
            case 7:
                rig.reset({.cause = draw(2) == 0 ? ResetCause::pin : ResetCause::watchdog,
                           .is_xshut_kept = draw(2) == 0,
                           .takes = Microseconds{1'000 + draw(200'000)}});
                break;
            default:
                disturb_bus(rig.bus(0));
                break;
        }
        if (draw(3) == 0) rig.sensor(draw(kSensors)).set_faults({});
        if (draw(3) == 0) rig.block_transmission(false);
    }
    void disturb_bus(sim::SimulatedI2cBus& bus) {
        const I2cFaultKind kind = kBusFaults.at(draw(kBusFaults.size()));
        // Data that is wrong twice in the same way is beyond what reading twice can see.
        const bool alters_data = kind == I2cFaultKind::flip_bit || kind == I2cFaultKind::read_ones;
        bus.inject({.kind = kind,
                    .first = bus.transfer_count() + draw(30),
                    .count = alters_data ? 1 : 1 + draw(3),
                    .position = kind == I2cFaultKind::sda_stuck_low ? 1 + draw(30) : draw(136)});
    }

    std::mt19937 random_;
    std::vector<std::unique_ptr<NodeRig>> nodes_;
    std::array<std::size_t, 2> heard_{};
    std::uint32_t disturbances_ = 0;
};

TEST(SmallRigCampaign, sends_only_the_truth_accounts_for_it_and_comes_back_for_every_seed) {
    const std::uint32_t seeds = seed_count();
    std::uint64_t disturbances = 0;
    std::uint64_t readings = 0;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Campaign campaign(seed);
        disturbances += campaign.disturbances();
        for (auto& rig : campaign.nodes()) {
            rig->block_transmission(false);
            rig->run_for(kSecond);
            // Safe mode after three resets lasts longer than a calm minute: it is a way of being well.
            if (rig->node().state() == NodeState::safe) continue;
            for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
                expect_only_the_truth(*rig, sensor);
                EXPECT_EQ(rig->last_health(sensor)->state, SensorState::ranging) << int{sensor};
                readings += rig->readings_of(sensor).size();
            }
            EXPECT_EQ(rig->said_of<wire::Heartbeat>().back().degraded_sensors, 0);
            expect_readings_accounted_for(rig->node());
            EXPECT_EQ(rig->undecodable_count(), 0U);
        }
        if (testing::Test::HasFailure()) return;
    }
    EXPECT_GT(disturbances, seeds * 25U) << "the faults were hardly any";
    EXPECT_GT(readings, seeds * 1'000U) << "hardly anything was measured";
    RecordProperty("disturbances", std::to_string(disturbances));
    RecordProperty("readings", std::to_string(readings));
}

}  // namespace
}  // namespace octoskin::test
