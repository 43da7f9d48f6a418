// Which range sensors the camera finds out in the experiment, and that it wrongs none. The figures are in
// docs/results.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/sim/witness/witness_bench.hpp"

namespace octoskin {
namespace {

using testing_support::RigFault;
using testing_support::SensorNumber;
using testing_support::WitnessBench;
using testing_support::WitnessOutcome;

constexpr double kFramesHz = 10.0;
constexpr SensorNumber kPerNode = 17;

/// Exchanged within a node, as connectors are: `with` says who with whom, 0 .. 15; sensor 16 stays.
RigFault swapped(SensorNumber (*with)(SensorNumber)) {
    return {.wired_to =
                [with](SensorNumber sensor) {
                    const SensorNumber on_node = sensor % kPerNode;
                    return on_node == 16 ? sensor : sensor - on_node + with(on_node);
                },
            .altered = {}};
}

RigFault altered(double (*to)(double range_m)) {
    return {.wired_to = {}, .altered = [to](SensorNumber, double range_m) { return to(range_m); }};
}

/// Of 16 pairs, those of which at least one sensor was flagged.
std::size_t pairs_flagged(const WitnessOutcome& outcome, SensorNumber (*with)(SensorNumber)) {
    std::size_t pairs = 0;
    for (SensorNumber sensor = 0; sensor < outcome.flagged_s.size(); ++sensor) {
        const SensorNumber on_node = sensor % kPerNode;
        if (on_node == 16 || with(on_node) < on_node) continue;
        const SensorNumber other = sensor - on_node + with(on_node);
        pairs += outcome.flagged_s[sensor] || outcome.flagged_s[other] ? 1U : 0U;
    }
    return pairs;
}

SensorNumber across(SensorNumber sensor) {
    return (sensor + 8) % 16;
}
SensorNumber neighbour(SensorNumber sensor) {
    return sensor ^ 1U;
}

class Witness : public testing::Test {
  protected:
    static WitnessOutcome run(const char* what, std::uint64_t seed, const RigFault& fault) {
        static const WitnessBench kBench(4);
        WitnessOutcome outcome = kBench.run(seed, fault, kFramesHz);
        std::printf("%s, seed %lu: %zu of %zu flagged, half of them within %.1f s\n", what,
                    static_cast<unsigned long>(seed), outcome.flagged(), outcome.flagged_s.size(),
                    outcome.flagged_s_median());
        return outcome;
    }
};

TEST_F(Witness, wrongs_no_sound_sensor_over_sixteen_seeds) {
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const WitnessOutcome outcome = run("sound", seed, {});
        ASSERT_EQ(outcome.flagged(), 0U) << "seed " << seed;
        std::uint64_t agreed = 0;
        for (const SensorEvidence& evidence : outcome.evidence) {
            agreed += evidence.agreed;
            EXPECT_EQ(evidence.in_free_space + evidence.behind_surface, 0U) << "seed " << seed;
        }
        EXPECT_GT(agreed, 200U) << "seed " << seed << ": nothing was compared";
    }
}

TEST_F(Witness, finds_sensors_swapped_at_the_harness) {
    for (const std::uint64_t seed : {0U, 1U}) {
        EXPECT_GE(pairs_flagged(run("swapped across", seed, swapped(across)), across), 3U);
        EXPECT_GE(pairs_flagged(run("swapped with the neighbour", seed, swapped(neighbour)), neighbour), 4U);
    }
}

TEST_F(Witness, finds_sensors_that_are_off_by_40_cm) {
    for (const std::uint64_t seed : {0U, 1U}) {
        EXPECT_GE(
            run("0.4 m too long", seed, altered([](double range_m) { return range_m + 0.4; })).flagged(), 7U);
        EXPECT_GE(
            run("0.4 m too short", seed, altered([](double range_m) { return range_m - 0.4; })).flagged(),
            6U);
    }
}

TEST_F(Witness, finds_sensors_that_are_stuck) {
    for (const std::uint64_t seed : {0U, 1U})
        EXPECT_GE(run("stuck at 250 mm", seed, altered([](double) { return 0.25; })).flagged(), 18U);
}

}  // namespace
}  // namespace octoskin
