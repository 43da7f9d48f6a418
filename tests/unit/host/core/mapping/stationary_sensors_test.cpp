#include "host/core/mapping/stationary_sensors.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace octoskin {
namespace {

class CountedEvidence final : public EvidenceSink {
  public:
    void apply(const Evidence&, const std::function<bool(VoxelKey)>*) override { ++applied; }
    [[nodiscard]] bool is_occupied(VoxelKey) const override { return false; }
    int applied = 0;
};

Beam beam(int number, double range_m, BeamOptics optics) {
    Beam beam;
    beam.source = {1, 2, 0};
    beam.captured = HostTime{number * std::int64_t{300'000'000}};
    beam.range_m = range_m;
    beam.sigma_m = 0.02;
    beam.optics = optics;
    return beam;
}

int evidence_after(BeamOptics before) {
    StationarySensors sensors(fast_mapping());
    for (int i = 0; i < 8; ++i) {
        if (!before.is_cone()) {
            sensors.take_ray(beam(i, 0.9, before));
            continue;
        }
        CountedEvidence unused;
        const Beam cone = beam(i, 0.9, before);
        sensors.conclude(cone, sensors.take(cone), unused);
    }
    CountedEvidence sink;
    const Beam cone = beam(8, 1.5, {0.23, 0.1, false});
    sensors.conclude(cone, sensors.take(cone), sink);
    return sink.applied;
}

TEST(StationarySensors, clear_nothing_by_the_history_of_a_ray) {
    EXPECT_GE(evidence_after({0.23, 0.1, false}), 1) << "what a cone has seen through is cleared";
    EXPECT_EQ(evidence_after({}), 0);
}

}  // namespace
}  // namespace octoskin
