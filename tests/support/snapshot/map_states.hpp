// States of maps with every kind of content: images, counts, times, readings of stationary and of moving
// sensors.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "host/core/mapping/map_state.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/range_model.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::testing_support {

/// One map, at the time of a measurement.
class OneMap final : public EvidenceSink {
  public:
    explicit OneMap(FusedMap& map) : map_(map) {}
    void apply(const Evidence& evidence, const std::function<bool(VoxelKey)>* spares) override {
        map_.apply(evidence, {.spares = spares, .changes = nullptr});
    }
    [[nodiscard]] bool is_occupied(VoxelKey key) const override {
        return map_.occupancy(key) == Occupancy::occupied;
    }

  private:
    FusedMap& map_;
};

/// A map and its range sensors, which measure different objects one after the other.
class MeasuredMap {
  public:
    explicit MeasuredMap(const MappingConfig& mapping) : map_(mapping.map), ranges_(mapping, true) {}
    MeasuredMap(const MappingConfig& mapping, MapState state)
        : map_(std::move(state.map)), ranges_(mapping, true) {
        ranges_.resume_with(std::move(state.histories));
    }

    /// `count` measurements, 50 ms apart, from `from_s` on.
    void measure(unsigned seed, int steps, double from_s) {
        std::mt19937 random(seed);
        for (int step = 0; step < steps; ++step) {
            const HostTime now{std::llround((from_s + 0.05 * step) * 1e9)};
            map_.advance_time(now);
            step % 9 == 8 ? see(random) : range(random, now);
        }
    }
    [[nodiscard]] MapState state() const { return {map_.copy(), ranges_.histories()}; }
    [[nodiscard]] FusedMap& map() noexcept { return map_; }

  private:
    void see(std::mt19937& random) {
        std::vector<VoxelUpdate> updates;
        for (int x = 0; x < 5; ++x)
            for (int y = 0; y < 4; ++y)
                updates.push_back(
                    {key(x, y, static_cast<int>(random() % 3)), random() % 2 == 0 ? -0.4F : 0.85F});
        Evidence image;
        image.miss = -0.4F;
        image.take_image(updates);
        map_.apply(image);
    }
    void range(std::mt19937& random, HostTime now) {
        Beam beam;
        beam.source = {.node_id = static_cast<std::uint8_t>(1 + random() % 2),
                       .sensor = static_cast<std::uint8_t>(random() % 2),
                       .zone = static_cast<std::uint8_t>(random() % 2)};
        beam.captured = now;
        beam.p_map_sensor = Eigen::Vector3d(0.1 * beam.source.node_id, random() % 20 == 0 ? 0.2 : 0.0, 0.0);
        if (random() % 6 != 0) beam.range_m = 0.3 + (random() % 12 == 0 ? 0.3 : 0.0);
        beam.sigma_m = 0.01;
        beam.clear_limit_m = 0.5;
        if (beam.source.sensor == 0) beam.optics = {.half_angle_rad = 0.2, .sigma_rad = 0.1};
        (void)ranges_.integrate(beam, sink_);
    }
    static VoxelKey key(int x, int y, int z) {
        constexpr int kZero = 32768;
        return {static_cast<std::uint16_t>(kZero + x), static_cast<std::uint16_t>(kZero + y),
                static_cast<std::uint16_t>(kZero + z)};
    }

    FusedMap map_;
    RangeModel ranges_;
    OneMap sink_{map_};
};

/// A configuration in which voxels become stale or expire within seconds, and the camera has a memory.
[[nodiscard]] inline MappingConfig quickly_aging() {
    MappingConfig mapping = fast_mapping();
    mapping.depth_update = DepthUpdate::denoised;
    mapping.map.age = {.stale_after_s = 4, .unknown_after_s = 9};
    mapping.map.memory_max_mib = 4;
    return mapping;
}

}  // namespace octoskin::testing_support
