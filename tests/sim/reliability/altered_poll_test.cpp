// I5, while rhythms are being learnt: nothing is known yet that would contradict a poll, and neighbours on
// the bus that learn theirs make the next one late. For every poll of the first ranges: its answer is
// altered, and no reading of the run may tell a time that is false.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/sim/capture_oracle.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::test {
namespace {

struct Fleet {
    std::uint8_t sensors;  ///< all on one bus
    std::uint16_t phase_step_us;
};

class AlteredPollTest : public testing::TestWithParam<Fleet> {
  protected:
    static NodeRig make_rig() {
        NodeConfig config = fleet_config(GetParam().sensors, 1);
        std::vector<SensorSetup> setups(GetParam().sensors);
        for (std::size_t i = 0; i < GetParam().sensors; ++i) {
            config.sensors.at(i).phase_us = static_cast<std::uint16_t>(GetParam().phase_step_us * i);
            setups[i].part.slow_clock_factor = 1.03 + 0.013 * static_cast<double>(i * 5 % 7);
        }
        return NodeRig(config, setups);
    }
};

/// By how much a reading's time is false beyond the bound told for its sensor, at the worst.
std::int64_t worst_excess_us(const NodeRig& rig, std::uint8_t sensor) {
    const ToldBounds bounds(rig);
    std::int64_t worst_us = INT64_MIN;
    for (const SaidReading& said : rig.readings_of(sensor)) {
        const TrueRange* truth = truth_of(rig, sensor, said);
        if (truth == nullptr) return INT64_MAX;
        worst_us =
            std::max(worst_us, std::abs(capture_error_us(rig, said, *truth)) - bounds.at(sensor, said.end));
    }
    return worst_us;
}

TEST_P(AlteredPollTest, I5_makes_no_time_false_while_rhythms_are_learnt) {
    constexpr Microseconds kFirstStarts{250'000};
    constexpr Microseconds kLearnt{440'000};
    constexpr std::int64_t kOnePollUs = 1'000;  // what one altered poll may spoil
    NodeRig whole = make_rig();
    whole.run_for(kFirstStarts);
    const std::uint64_t first = whole.bus(0).transfer_count();
    whole.run_for(kLearnt - kFirstStarts);
    const std::uint64_t last = whole.bus(0).transfer_count();
    ASSERT_GT(last, first + 100);
    for (std::uint64_t transfer = first; transfer < last; ++transfer) {
        NodeRig rig = make_rig();
        // Bit 0 of the first byte read: of a poll, whether data is ready.
        rig.bus(0).inject(
            {.kind = sim::I2cFaultKind::flip_bit, .first = transfer, .count = 1, .position = 7});
        rig.run_for(kLearnt + Microseconds{160'000});
        for (std::uint8_t sensor = 0; sensor < GetParam().sensors; ++sensor)
            ASSERT_LE(worst_excess_us(rig, sensor), kOnePollUs)
                << "transfer " << transfer << " sensor " << int{sensor};
    }
}

std::string name_of(const testing::TestParamInfo<Fleet>& tested) {
    return std::to_string(tested.param.sensors) + "_sensors_" + std::to_string(tested.param.phase_step_us) +
           "_us_apart";
}

INSTANTIATE_TEST_SUITE_P(ReliabilityI5, AlteredPollTest,
                         testing::Values(Fleet{3, 0}, Fleet{3, 500}, Fleet{3, 2'000}, Fleet{5, 1'000},
                                         Fleet{9, 3'666}),
                         name_of);

}  // namespace
}  // namespace octoskin::test
