// How much a node may say, and when readings show that two senders say it.
#include "host/core/ingest/node_traffic.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin {
namespace {

HostTime us(std::int64_t value) {
    return {value * 1'000};
}

HostNode node(std::size_t sensors, Microseconds period = Microseconds{33'000}, std::uint8_t aux_every = 0) {
    HostSensor sensor;
    sensor.period = period;
    return {.node_id = 1,
            .name = "n",
            .node_hash = 0,
            .pinned_build_id = {},
            .sensors = std::vector<HostSensor>(sensors, sensor),
            .aux_every = aux_every};
}

wire::RangeReading reading(std::uint8_t sensor, unsigned sequence) {
    wire::RangeReading reading{};
    reading.sensor = sensor;
    reading.sequence = static_cast<std::uint8_t>(sequence % wire::kSequenceCount);
    return reading;
}

TEST(NodeTraffic, allows_twice_what_the_rig_has_a_node_send_and_what_was_held_back) {
    // By hand: 10 heartbeats, a SYNC report, 7 pages; 31 readings and one health of each sensor.
    EXPECT_EQ(NodeTraffic(node(1), 0.0).frames_max(), 2U * (18 + 32) + 8U);
    EXPECT_EQ(NodeTraffic(node(17), 0.0).frames_max(), 2U * (18 + 17 * 32) + 8U);
    EXPECT_EQ(NodeTraffic(node(0), 100.0).frames_max(), 2U * (18 + 400) + 8U) << "joint states";
    EXPECT_EQ(NodeTraffic(node(2), 50.0).frames_max(), 2U * (18 + 64 + 200) + 8U) << "both";
    EXPECT_EQ(NodeTraffic(node(1, Microseconds{20'000}), 0.0).frames_max(), 2U * (18 + 51) + 8U);
    // 62 readings, every fourth with a RANGE_AUX, of each sensor one more.
    EXPECT_EQ(NodeTraffic(node(2, Microseconds{33'000}, 4), 0.0).frames_max(), 2U * (18 + 64 + 17) + 8U);
}

TEST(NodeTraffic, judges_by_the_second_to_the_frame) {
    NodeTraffic traffic(node(1), 0.0);
    for (int i = 0; i < 108; ++i) EXPECT_TRUE(traffic.keeps_with_frame(us(5'000 * i))) << i;
    EXPECT_FALSE(traffic.keeps_with_frame(us(999'999)));
    EXPECT_TRUE(traffic.keeps_with_frame(us(1'005'000))) << "those of 0 and of 5 ms are a second old";
}

TEST(NodeTraffic, counts_nothing_while_the_time_is_unknown) {
    NodeTraffic traffic(node(1), 0.0);
    for (unsigned i = 0; i < 1'000; ++i) {
        EXPECT_TRUE(traffic.keeps_with_frame(std::nullopt));
        EXPECT_TRUE(traffic.keeps_with_reading(reading(0, 0), std::nullopt));
    }
    for (int i = 0; i < 108; ++i) EXPECT_TRUE(traffic.keeps_with_frame(us(1)));
    EXPECT_FALSE(traffic.keeps_with_frame(us(1)));
}

/// Readings of two senders by turns, whatever the distance of their numbers.
TEST(NodeTraffic, tells_two_senders_by_the_numbers_of_their_readings_within_a_second) {
    for (const unsigned period_ms : {20U, 33U, 100U, 250U}) {
        for (const std::size_t sensors : {1U, 2U, 17U}) {
            for (unsigned apart = 0; apart < wire::kSequenceCount; ++apart) {
                NodeTraffic traffic(node(sensors, Microseconds{1'000 * period_ms}), 0.0);
                bool is_reported = false;
                for (unsigned k = 0; k * period_ms <= 1'000; ++k) {
                    const HostTime now = us(1'000 * period_ms * k);
                    for (std::uint8_t sensor = 0; sensor < sensors; ++sensor) {
                        is_reported |= !traffic.keeps_with_reading(reading(sensor, k), now);
                        is_reported |= !traffic.keeps_with_reading(reading(sensor, k + apart), now);
                    }
                }
                EXPECT_TRUE(is_reported)
                    << sensors << " sensors, " << period_ms << " ms, " << apart << " apart";
            }
        }
    }
}

TEST(NodeTraffic, takes_a_bus_that_repeats_loses_and_delays_for_one_sender) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        NodeTraffic traffic(node(1), 0.0);
        for (unsigned k = 0; k < 3'000; ++k) {
            const auto chance = random() % 100;
            if (chance < 25) continue;                                 // lost
            const unsigned number = chance < 40 && k > 0 ? k - 1 : k;  // late, or the one before again
            ASSERT_TRUE(traffic.keeps_with_reading(reading(0, number), us(33'000 * k))) << "seed " << seed;
        }
    }
}

TEST(NodeTraffic, takes_a_node_that_begins_anew_for_one_sender) {
    NodeTraffic traffic(node(17), 0.0);
    for (unsigned k = 0; k < 300; ++k) {
        for (std::uint8_t sensor = 0; sensor < 17; ++sensor) {
            EXPECT_TRUE(traffic.keeps_with_reading(reading(sensor, k % 10), us(33'000 * k)));
        }
    }
}

}  // namespace
}  // namespace octoskin
