// Seeded random maps of free, occupied and unknown voxels, and random capsules.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Within ten voxels of the origin, and four more of a capsule's radius.
class RandomSpace {
  public:
    RandomSpace(unsigned seed, double resolution_m) : random_(seed), resolution_m_(resolution_m) {}

    /// 4 x 4 x 4 bricks about the origin: unknown, alike, or with a few voxels unlike the others.
    FusedMap map() {
        FusedMap map(MapConfig{.resolution_m = resolution_m_});
        for (MortonCode i = 0; i < 64; ++i) {
            const VoxelKey part = key_of_morton(i);
            const VoxelCube brick{{at(8 * part.x - 16), at(8 * part.y - 16), at(8 * part.z - 16)},
                                  kBrickHeight};
            const auto kind = random_() % 16;
            if (kind > 1) set(map, brick, kind == 2 ? 1.0F : -1.0F);
            if (kind > 7 || kind == 0) change_some(map, brick);
        }
        return map;
    }

    PosedCapsule capsule(unsigned i) {
        PosedCapsule capsule{point(), point(), uniform(0.0, 4.0) * resolution_m_};
        if (i % 4 == 0) capsule.p_b = capsule.p_a + 0.3 * (capsule.p_b - capsule.p_a);
        if (i % 4 ==
            1) {  // on corners, edges, faces and centres, along an axis: many voxels are equally near
            capsule.p_a = snapped(capsule.p_a, 0.5);
            capsule.p_b = capsule.p_a;
            capsule.p_b[i / 4 % 3] += std::round(uniform(-6.0, 6.0)) * resolution_m_;
            capsule.radius_m = std::round(uniform(0.0, 6.0)) * 0.5 * resolution_m_;
        }
        if (i % 16 == 2) capsule.p_b = capsule.p_a;
        if (i % 16 == 3) capsule.radius_m = 1e-12;
        if (i % 16 == 7) capsule.radius_m = 0.0;
        return capsule;
    }

  private:
    static std::uint16_t at(int offset) { return static_cast<std::uint16_t>(kOriginKey + offset); }
    double uniform(double lowest, double highest) {
        return std::uniform_real_distribution<double>(lowest, highest)(random_);
    }
    Eigen::Vector3d point() {
        return resolution_m_ * Eigen::Vector3d(uniform(-9, 9), uniform(-9, 9), uniform(-9, 9));
    }
    [[nodiscard]] Eigen::Vector3d snapped(const Eigen::Vector3d& point, double voxels) const {
        const double step = voxels * resolution_m_;
        return (point / step).array().round() * step;
    }
    static void set(FusedMap& map, const VoxelCube& cube, float log_odds) {
        EXPECT_TRUE(map.set_cube(cube, log_odds));
    }
    void change_some(FusedMap& map, const VoxelCube& brick) {
        for (auto n = random_() % 6; n > 0; --n) {
            const VoxelKey key = key_of_morton(morton_of(brick.lowest) + random_() % kBrickVoxels);
            set(map, {key, 0}, random_() % 3 == 0 ? -0.5F : 1.0F);
        }
    }

    std::mt19937 random_;
    double resolution_m_;
};

}  // namespace octoskin
