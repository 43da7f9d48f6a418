// VoxelTrace where rays weaken what is occupied: the map is the oracle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "host/apps/explain/voxel_trace.hpp"
#include "host/core/mapping/range_model.hpp"
#include "host/core/pipeline/map_feeder.hpp"

namespace octoskin {
namespace {

TEST(WeakenedTrace, follows_the_map_through_every_weakening) {
    const MappingConfig config = denoised_mapping();
    RangeModel ranges(config, false);
    std::vector<FedMap> maps;
    maps.push_back({MapFeed::both, FusedMap(config.map)});
    std::vector<VoxelTrace> traces;
    for (std::uint16_t x = 32768; x < 32768 + 20; ++x)
        traces.emplace_back(VoxelKey{x, 32768, 32768}, config.map, 10);
    std::mt19937 random(1);
    std::normal_distribution<double> range_m(0.5, 0.03);
    std::size_t forgotten = 0;
    for (int i = 0; i < 500; ++i) {
        RangeMeasurement reading;
        reading.captured = HostTime{100'000'000LL * i};
        reading.range_m = range_m(random);
        Beam beam;
        beam.p_map_sensor = {0.02, 0.02, 0.02};
        beam.direction_map = Eigen::Vector3d::UnitX();
        beam.range_m = reading.range_m;
        beam.sigma_m = 0.03;
        std::vector<VoxelUpdate> changes;
        MapFeeder feeder(maps, reading.captured, &changes, nullptr);
        ASSERT_TRUE(ranges.integrate(beam, feeder));
        for (VoxelTrace& trace : traces) {
            const std::uint64_t before = trace.forgotten().times;
            trace.on_reading(reading, beam, changes);
            trace.on_maps(maps);
            ASSERT_EQ(trace.log_odds(), maps.front().map.log_odds(trace.key())) << i;
            ASSERT_NEAR(trace.sum(), static_cast<double>(trace.log_odds().value_or(0.0F)), 1e-6);
            if (trace.forgotten().times == before) continue;
            ++forgotten;
            EXPECT_EQ(trace.forgotten().last, reading.captured);
        }
    }
    EXPECT_GT(forgotten, 10U);
}

}  // namespace
}  // namespace octoskin
