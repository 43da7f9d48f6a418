// What the image's tests have in common: the fleets that its promises name, how they are wired, and how slow
// a core and a bus may be.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <vector>

#include "tests/board/flashed_board.hpp"

namespace octoskin::sim::stm32 {

inline NodeConfig seventeen_at_50_hz() {
    return fleet(17, DistanceMode::short_range, 15, 20);
}
inline NodeConfig thirty_four_at_30_hz() {
    return fleet(34, DistanceMode::long_range, 20, 33);
}

/// Where a fleet's XSHUT lines are; of `pins` there are eight.
enum class XshutWiring { chain, pins, both };
inline void PrintTo(XshutWiring wiring, std::ostream* out) {
    constexpr const char* kNames[] = {"chain", "pins", "both"};
    *out << kNames[static_cast<std::size_t>(wiring)];
}
inline NodeConfig wired(NodeConfig config, XshutWiring wiring) {
    for (std::uint8_t i = 0; i < config.sensor_count; ++i) {
        const bool is_pin = wiring == XshutWiring::pins || (wiring == XshutWiring::both && i % 2 == 1);
        config.sensors.at(i).xshut_line = static_cast<std::uint8_t>(is_pin ? 40 + i : i);
    }
    return config;
}

/// An instruction costs one cycle or three; I2C edges are typical or as slow as the specification allows.
struct Speed {
    std::uint32_t cycles_per_instruction;
    BusEdges edges;
};
inline void PrintTo(const Speed& speed, std::ostream* out) {
    *out << speed.cycles_per_instruction
         << (speed.edges == BusEdges::slowest ? "_slow_edges" : "_typical_edges");
}
inline NucleoOptions options_of(const Speed& speed) {
    NucleoOptions options;
    options.cycles_per_instruction = speed.cycles_per_instruction;
    options.edges = speed.edges;
    return options;
}

/// Of a sensor, since power-up: readings that were said, rangings that ended.
struct Counts {
    double taken = 0.0;
    double made = 0.0;
};
inline std::vector<Counts> counts_of(FlashedBoard& flashed, std::uint8_t sensors) {
    std::vector<Counts> all;
    for (std::uint8_t sensor = 0; sensor < sensors; ++sensor) {
        all.push_back({static_cast<double>(flashed.readings(sensor).size()),
                       static_cast<double>(flashed.rangings(sensor))});
    }
    return all;
}

inline void expect_unbroken(const std::vector<SaidReading>& readings) {
    for (std::size_t i = 1; i < readings.size(); ++i) {
        ASSERT_EQ(readings[i].reading.sequence,
                  (readings[i - 1].reading.sequence + 1) % wire::kSequenceCount);
        ASSERT_NE(readings[i].reading.range_mm, readings[i - 1].reading.range_mm) << "a value said twice";
    }
}

}  // namespace octoskin::sim::stm32
