// HitBricks: the largest term of each voxel, and voxels in which all ends are uncertain.
#include "host/core/mapping/hit_bricks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/traversal/image_bands.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {
namespace {

constexpr double kEdge_m = 0.04;
constexpr HitModel kModel{.offset = 1.0, .slope_per_m = 0.1};

/// Rays from the origin, whose ends are given in voxels.
class Rays {
  public:
    explicit Rays(std::size_t count) {
        image.width = static_cast<std::uint32_t>(count);
        image.height = 1;
        for (auto* values : {&image.end_x, &image.end_y, &image.end_z, &image.reach_m, &image.passed_m})
            values->resize(count + kLanesMax, -1.0F);
        image.range_m.resize(count + kLanesMax, -1.0);
        image.key_xy.resize(count + kLanesMax, 0);
        image.key_z.resize(count + kLanesMax, ProjectedImage::kNoKey);
        doubts_m.resize(count + kLanesMax, 0.0F);
    }
    /// `doubt`: of the depth, as a share of it.
    void put(std::size_t i, const Eigen::Vector3d& end_voxels, double doubt) {
        const Eigen::Vector3f end = (kEdge_m * end_voxels).cast<float>();
        image.end_x[i] = end.x();
        image.end_y[i] = end.y();
        image.end_z[i] = end.z();
        image.reach_m[i] = 2.0F * end.norm();  // as if the optical axis were 60 degrees off
        image.range_m[i] = static_cast<double>(end.norm());
        const VoxelKey key = *VoxelLattice(kEdge_m).key_of(end.cast<double>());
        image.key_xy[i] = key.x | static_cast<std::uint32_t>(key.y) << 16U;
        image.key_z[i] = key.z;
        doubts_m[i] = static_cast<float>(doubt) * image.reach_m[i];
    }
    [[nodiscard]] VoxelKey key(std::size_t i) const {
        return {static_cast<std::uint16_t>(image.key_xy[i]),
                static_cast<std::uint16_t>(image.key_xy[i] >> 16U),
                static_cast<std::uint16_t>(image.key_z[i])};
    }

    ProjectedImage image;
    std::vector<float> doubts_m;
};

KeyBox box_of(const Rays& rays) {
    KeyBox box{rays.key(0), rays.key(0)};
    for (std::size_t i = 0; i < rays.image.pixels(); ++i) {
        const VoxelKey key = rays.key(i);
        box.lowest = {std::min(box.lowest.x, key.x), std::min(box.lowest.y, key.y),
                      std::min(box.lowest.z, key.z)};
        box.highest = {std::max(box.highest.x, key.x), std::max(box.highest.y, key.y),
                       std::max(box.highest.z, key.z)};
    }
    return box;
}

/// Whether single precision decides as exact arithmetic does: nothing that is compared is nearly equal.
bool is_clear(const Eigen::Vector3d& end_voxels, double doubt) {
    constexpr double kRounding = 2e-6;
    std::array<double, 4> compared{0.0, 0.0, 0.0, doubt};
    for (int axis = 0; axis < 3; ++axis) {
        const double to_face = std::fabs(std::round(end_voxels[axis]) - end_voxels[axis]);
        compared[static_cast<std::size_t>(axis)] = to_face / std::fabs(end_voxels[axis]);
    }
    std::ranges::sort(compared);
    return compared[0] > kRounding && compared[1] - compared[0] > kRounding &&
           compared[2] - compared[1] > kRounding && compared[3] - compared[2] > kRounding;
}

/// The next voxel that the end of a ray may as well be in, if there is one: the first that it comes to on its
/// way along the ray, to either side.
std::optional<VoxelKey> doubted(const Rays& rays, std::size_t i) {
    const std::array<float, 3> end{rays.image.end_x[i], rays.image.end_y[i], rays.image.end_z[i]};
    double least = static_cast<double>(rays.doubts_m[i] / rays.image.reach_m[i]);
    std::optional<VoxelKey> found;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double voxels = static_cast<double>(end[axis]) / kEdge_m;
        const double face = std::round(voxels);
        const double share = std::fabs(face - voxels) / std::fabs(voxels);
        if (!(share < least)) continue;
        least = share;
        std::array<int, 3> key{rays.key(i).x, rays.key(i).y, rays.key(i).z};
        key[axis] += face > voxels ? 1 : -1;
        found = VoxelKey{static_cast<std::uint16_t>(key[0]), static_cast<std::uint16_t>(key[1]),
                         static_cast<std::uint16_t>(key[2])};
    }
    return found;
}

struct Expected {
    float largest = -9.0F;
    bool is_certain = false;
    std::set<VoxelKey> doubted;
};

std::map<VoxelKey, Expected> expected_of(const Rays& rays) {
    std::map<VoxelKey, Expected> voxels;
    for (std::size_t i = 0; i < rays.image.pixels(); ++i) {
        Expected& voxel = voxels[rays.key(i)];
        voxel.largest = std::max(voxel.largest, kModel.log_odds(rays.image.range_m[i]));
        if (const auto other = doubted(rays, i))
            voxel.doubted.insert(*other);
        else
            voxel.is_certain = true;
    }
    for (auto& [key, voxel] : voxels) {
        const auto is_certain = [&](const VoxelKey& other) {
            const auto found = voxels.find(other);
            return found != voxels.end() && found->second.is_certain;
        };
        if (!voxel.is_certain && std::ranges::all_of(voxel.doubted, is_certain)) voxel.largest = 0.0F;
    }
    return voxels;
}

/// Returns how many voxels have a term of 0.
std::size_t expect_as_expected(HitBricks& hits, const Rays& rays) {
    EXPECT_TRUE(hits.take(rays.image, {rays.doubts_m, kEdge_m}, box_of(rays), kModel, 1U << 26U));
    const auto expected = expected_of(rays);
    std::set<MortonCode> bricks;
    for (const auto& [key, voxel] : expected) bricks.insert(brick_of(key));
    std::size_t voxels = 0;
    std::size_t zeros = 0;
    for (const MortonCode brick : bricks) {
        const BrickHits found = hits.of(brick);
        for_each_cell(found.mask(), [&](std::size_t cell) {
            const auto voxel = expected.find(key_of_morton(brick + cell));
            ++voxels;
            if (voxel == expected.end()) {
                ADD_FAILURE() << "a hit without an end";
                return;
            }
            EXPECT_EQ(found.largest(cell), voxel->second.largest);
            zeros += found.largest(cell) == 0.0F ? 1U : 0U;
        });
    }
    EXPECT_EQ(voxels, expected.size());
    return zeros;
}

TEST(HitBricks, leave_a_voxel_of_uncertain_ends_at_0_beside_a_certain_one) {
    // Three columns along x: an uncertain end alone; beside an uncertain one; beside a certain one.
    Rays rays(5);
    const double doubt = 0.002;  // 0.1 voxels at 50
    rays.put(0, {50.05, 0.5, 0.5}, doubt);
    rays.put(1, {50.05, 2.5, 0.5}, doubt);
    rays.put(2, {49.95, 2.5, 0.5}, doubt);
    rays.put(3, {50.05, 4.5, 0.5}, doubt);
    rays.put(4, {49.85, 4.5, 0.5}, doubt);
    HitBricks hits;
    EXPECT_EQ(expect_as_expected(hits, rays), 1U);
    const auto term = [&](const Rays& of, std::size_t i) {
        return hits.of(brick_of(of.key(i))).largest(cell_of(of.key(i)));
    };
    EXPECT_EQ(term(rays, 3), 0.0F);
    for (const std::size_t i : {0U, 1U, 2U, 4U}) EXPECT_GT(term(rays, i), 0.0F) << i;
    // One certain end more, and the voxel is hit.
    rays.put(0, {50.15, 4.5, 0.5}, doubt);
    EXPECT_EQ(expect_as_expected(hits, rays), 0U);
}

TEST(HitBricks, have_no_uncertain_ends_without_doubts) {
    Rays rays(3);
    rays.put(0, {50.0001, 0.5, 0.5}, 0.0);
    rays.put(1, {49.9999, 0.5, 0.5}, 0.0);
    rays.put(2, {48.5, 0.5, 0.5}, 0.0);
    HitBricks hits;
    EXPECT_EQ(expect_as_expected(hits, rays), 0U);
    EXPECT_TRUE(hits.take(rays.image, {}, box_of(rays), kModel, 1U << 26U));
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_GT(hits.of(brick_of(rays.key(i))).largest(cell_of(rays.key(i))), 0.0F);
}

/// Across the faces of voxels, words and bricks, on all sides of the camera.
TEST(HitBricks, equal_what_each_end_says_by_itself) {
    HitBricks hits;
    std::size_t zeros = 0;
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> place(0.0, 20.0);
        std::uniform_real_distribution<double> share(0.0, 1.0);
        const Eigen::Vector3d corner(seed % 2 == 0 ? 40.0 : -60.0, seed % 3 == 0 ? -10.0 : 15.0,
                                     seed % 5 == 0 ? -30.0 : 5.0);
        Rays rays(3000);
        for (std::size_t i = 0; i < rays.image.pixels();) {
            Eigen::Vector3d end = corner;
            for (double& coordinate : end) coordinate += place(random);
            const double doubt = (seed % 4 == 0 ? 0.05 : 0.01) * share(random);
            if (is_clear(end, doubt)) rays.put(i++, end, doubt);
        }
        zeros += expect_as_expected(hits, rays);
    }
    EXPECT_GT(zeros, 1000U);
}

}  // namespace
}  // namespace octoskin
