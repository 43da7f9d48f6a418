// Oracles: every voxel one by one; a field made anew; the search without a field.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "host/core/query/distance_field.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/evidence.hpp"
#include "tests/support/random_space.hpp"

namespace octoskin {
namespace {

constexpr double kResolution_m = 0.04;

/// So many voxels about the origin, along each axis.
FieldExtent about_origin(int voxels, double reach_m) {
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(voxels * kResolution_m - 1e-6);
    return {{-corner, corner}, reach_m};
}

VoxelKey voxel_at(int x, int y, int z) {
    const auto at = [](int offset) { return static_cast<std::uint16_t>(kOriginKey + offset); };
    return {at(x), at(y), at(z)};
}

int squared_between(VoxelKey a, VoxelKey b) {
    const auto square = [](int p, int q) { return (p - q) * (p - q); };
    return square(a.x, b.x) + square(a.y, b.y) + square(a.z, b.z);
}

/// Voxels from -half to half - 1 along each axis, and beyond them so many more as the field reaches.
class Oracle {
  public:
    Oracle(const FusedMap& map, int half, int reach) : map_(map), half_(half), reach_(reach) {
        const int all = half + reach;
        for (int x = -all; x < all; ++x)
            for (int y = -all; y < all; ++y)
                for (int z = -all; z < all; ++z) {
                    const Occupancy state = map.occupancy(voxel_at(x, y, z));
                    if (state == Occupancy::occupied) occupied_.push_back(voxel_at(x, y, z));
                    if (state != Occupancy::free) not_free_.push_back(voxel_at(x, y, z));
                }
    }
    [[nodiscard]] std::optional<double> occupied_m(VoxelKey at) const { return nearest_m(occupied_, at); }
    /// Most of these are unknown and far away: a look about is enough.
    [[nodiscard]] std::optional<double> not_free_m(VoxelKey at) const {
        int least = std::numeric_limits<int>::max();
        for (int dx = -reach_; dx <= reach_; ++dx)
            for (int dy = -reach_; dy <= reach_; ++dy)
                for (int dz = -reach_; dz <= reach_; ++dz) {
                    const int squared = dx * dx + dy * dy + dz * dz;
                    if (squared >= least || squared > reach_ * reach_) continue;
                    const VoxelKey other{static_cast<std::uint16_t>(at.x + dx),
                                         static_cast<std::uint16_t>(at.y + dy),
                                         static_cast<std::uint16_t>(at.z + dz)};
                    if (map_.occupancy(other) != Occupancy::free) least = squared;
                }
        return metres(least);
    }

    /// A sample of all voxels, and how many of them were near something, and how many not.
    void compare(const DistanceField& field, std::mt19937& random, std::size_t samples) const {
        std::uniform_int_distribution<int> along(-half_ - reach_ - 2, half_ + reach_ + 1);
        for (std::size_t i = 0; i < samples; ++i) {
            const VoxelKey at = voxel_at(along(random), along(random), along(random));
            ASSERT_EQ(field.occupied_m(at), occupied_m(at));
            ASSERT_EQ(field.not_free_m(at), not_free_m(at));
        }
    }

  private:
    [[nodiscard]] std::optional<double> nearest_m(const std::vector<VoxelKey>& sites, VoxelKey at) const {
        int least = std::numeric_limits<int>::max();
        for (const VoxelKey site : sites) least = std::min(least, squared_between(site, at));
        return metres(least);
    }
    [[nodiscard]] std::optional<double> metres(int squared) const {
        if (squared > reach_ * reach_) return std::nullopt;
        return std::sqrt(static_cast<double>(squared)) * kResolution_m;
    }

    const FusedMap& map_;
    int half_;
    int reach_;
    std::vector<VoxelKey> occupied_;
    std::vector<VoxelKey> not_free_;
};

void put(FusedMap& map, VoxelKey at, float log_odds) {
    ASSERT_TRUE(map.set_cube({at, 0}, log_odds));
}

TEST(DistanceField, of_an_empty_map_knows_of_nothing_occupied_and_of_nothing_free) {
    const DistanceField field(MapConfig{}, about_origin(8, 0.5));
    EXPECT_EQ(field.occupied_m(voxel_at(0, 0, 0)), std::nullopt);
    EXPECT_EQ(field.not_free_m(voxel_at(0, 0, 0)), 0.0);
    EXPECT_NEAR(field.reach_m(), 0.52, 1e-12);  // 13 voxels
}

TEST(DistanceField, of_one_occupied_voxel_is_what_pythagoras_says_up_to_its_reach) {
    FusedMap map{MapConfig{}};
    put(map, voxel_at(0, 0, 0), 1.0F);
    DistanceField field(map.config(), about_origin(16, 0.52));
    (void)field.update(map);
    EXPECT_DOUBLE_EQ(field.occupied_m(voxel_at(0, 0, 0)).value(), 0.0);
    EXPECT_DOUBLE_EQ(field.occupied_m(voxel_at(-3, 4, 12)).value(), 0.52);
    EXPECT_DOUBLE_EQ(field.occupied_m(voxel_at(0, 0, -13)).value(), 0.52);
    EXPECT_EQ(field.occupied_m(voxel_at(1, 0, -13)), std::nullopt);
    EXPECT_EQ(field.occupied_m(voxel_at(0, 14, 0)), std::nullopt);
}

class ChangingMap : public testing::TestWithParam<int> {};

/// Some voxels of one region become something else at each step, or a whole brick does; sometimes another map
/// altogether comes.
TEST_P(ChangingMap, has_the_field_of_a_look_at_every_voxel_at_each_step) {
    const int reach = GetParam();
    std::mt19937 random(static_cast<unsigned>(reach));
    RandomSpace space(7, kResolution_m);
    FusedMap map = space.map();
    DistanceField field(map.config(), about_origin(16 + reach + 2, reach * kResolution_m));
    const auto steps = testing_support::cases(12);
    for (unsigned step = 0; step < steps; ++step) {
        if (step % 5 == 4) map = space.map();
        std::uniform_int_distribution<int> along(-16, 15);
        for (auto n = random() % 30; n > 0; --n)
            put(map, voxel_at(along(random), along(random), along(random)), random() % 3 == 0 ? 2.0F : -1.5F);
        if (step % 3 == 1) {
            const VoxelKey corner =
                key_of_morton(brick_of(voxel_at(along(random), along(random), along(random))));
            ASSERT_TRUE(map.set_cube({corner, kBrickHeight}, random() % 2 == 0 ? 2.0F : -1.5F));
        }
        const auto update = field.update(map);
        EXPECT_LE(update.changed, update.written);
        Oracle(map, 16, reach).compare(field, random, 150);
        if (testing::Test::HasFatalFailure()) FAIL() << "step " << step;
    }
}

INSTANTIATE_TEST_SUITE_P(Reaches, ChangingMap, testing::Values(1, 7, 8, 13));

TEST(DistanceField, works_on_nothing_if_no_voxel_changed_its_state) {
    FusedMap map = RandomSpace(3, kResolution_m).map();
    DistanceField field(map.config(), about_origin(24, 0.5));
    EXPECT_GT(field.update(map).worked, 0U);
    const FusedMap before = map.copy();
    const VoxelUpdate more{voxel_at(0, 0, 0),
                           map.occupancy(voxel_at(0, 0, 0)) == Occupancy::occupied ? 0.01F : -0.01F};
    feed(map, std::span(&more, 1));
    const auto update = field.update(map);
    EXPECT_EQ(update.written, 1U);
    EXPECT_LE(update.changed,
              map.log_odds(voxel_at(0, 0, 0)) && !before.log_odds(voxel_at(0, 0, 0)) ? 1U : 0U);
}

TEST(DistanceField, forgets_bricks_that_are_as_they_would_be_without_any_change) {
    FusedMap map{MapConfig{}};
    DistanceField field(map.config(), about_origin(24, 0.5));
    const std::size_t bytes = field.memory_bytes();
    put(map, voxel_at(3, 3, 3), 1.0F);
    (void)field.update(map);
    EXPECT_GT(field.memory_bytes(), bytes);
    (void)field.update(FusedMap{MapConfig{}});
    EXPECT_EQ(field.memory_bytes(), bytes);
}

TEST(DistanceField, finds_the_clearance_of_a_capsule_that_a_search_finds) {
    RandomSpace space(8, kResolution_m);
    unsigned beyond = 0;
    unsigned between = 0;
    for (unsigned i = 0; i < testing_support::cases(150); ++i) {
        const FusedMap map = space.map();
        DistanceField field(map.config(), about_origin(i % 3 == 0 ? 6 : 24, 0.3));
        (void)field.update(map);
        const PosedCapsule capsule = space.capsule(i);
        const double reach_m = field.axis_reach_m() - capsule.radius_m;
        const auto expected = clearance(map, capsule, std::max(0.0, reach_m));
        const auto found = field.clearance(capsule);
        ASSERT_TRUE(expected && found);
        ASSERT_EQ(found->occupied_m, expected->occupied_m) << i;
        ASSERT_EQ(found->not_free_m, expected->not_free_m) << i;
        beyond += field.tells_of(capsule) ? 0U : 1U;
        between += found->occupied_m.value_or(0.0) > 0.0 ? 1U : 0U;
    }
    EXPECT_GT(between, testing_support::cases(150) / 20);
    EXPECT_GT(beyond, testing_support::cases(150) / 20) << "of the region: these are searched for";
}

TEST(DistanceField, looks_no_further_than_it_is_told_to) {
    RandomSpace space(9, kResolution_m);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> uniform(0.0, 0.2);
    for (unsigned i = 0; i < testing_support::cases(150); ++i) {
        const FusedMap map = space.map();
        DistanceField field(map.config(), about_origin(24, 0.4));
        (void)field.update(map);
        const PosedCapsule capsule = space.capsule(i);
        const double not_free_m = i % 4 == 0 ? 0.0 : uniform(random);
        const ClearanceReach reach{i % 3 == 0 ? not_free_m : not_free_m + uniform(random), not_free_m};
        const auto expected = clearance(map, capsule, reach);
        const auto found = field.clearance(capsule, reach);
        ASSERT_TRUE(expected && found);
        ASSERT_EQ(found->occupied_m, expected->occupied_m) << i;
        ASSERT_EQ(found->not_free_m, expected->not_free_m) << i;
    }
}

/// Beyond the octree all is unknown, and there are no voxels.
TEST(DistanceField, ends_with_the_octree) {
    constexpr std::array<std::uint16_t, 2> kMiddle{32752, 32768};
    constexpr std::array<std::uint16_t, 2> kLast{65504, 65520};
    const double edge_m = kOriginKey * kResolution_m;
    FusedMap map{MapConfig{}};
    for (const std::uint16_t y : kMiddle)
        for (const std::uint16_t z : kMiddle)
            for (const std::uint16_t x : kLast) ASSERT_TRUE(map.set_cube({{x, y, z}, 4}, -1.0F));
    put(map, {65520, 32768, 32768}, 1.0F);
    const Eigen::Vector3d corner(edge_m - 0.7, -0.3, -0.3);
    const Eigen::AlignedBox3d region(corner, Eigen::Vector3d(edge_m + 1.0, 0.3, 0.3));
    DistanceField field(map.config(), {region, 0.5});
    (void)field.update(map);
    EXPECT_DOUBLE_EQ(field.not_free_m({65535, 32768, 32768}).value(), kResolution_m);
    for (const double from_edge_m : {0.05, 0.2, 0.33, 0.5}) {
        const PosedCapsule capsule{{edge_m - from_edge_m, 0.1, 0.0}, {edge_m - from_edge_m, 0.15, 0.1}, 0.03};
        ASSERT_TRUE(field.tells_of(capsule));
        const auto expected = clearance(map, capsule, 0.3);
        const auto found = field.clearance(capsule, {0.3, 0.3});
        ASSERT_TRUE(expected && found);
        EXPECT_EQ(found->occupied_m, expected->occupied_m) << from_edge_m;
        EXPECT_EQ(found->not_free_m, expected->not_free_m) << from_edge_m;
        EXPECT_TRUE(found->not_free_m) << from_edge_m;
    }
}

TEST(DistanceField, refuses_a_capsule_that_a_search_refuses) {
    const DistanceField field(MapConfig{}, about_origin(24, 0.3));
    EXPECT_EQ(field.clearance({{std::nan(""), 0, 0}, {0, 0, 0}, 0.1}).error(), CapsuleFault::not_finite);
    EXPECT_EQ(field.clearance({{0, 0, 0}, {0, 0, 0}, -0.1}).error(), CapsuleFault::negative_radius);
    EXPECT_EQ(field.clearance({{2e6, 0, 0}, {0, 0, 0}, 0.1}).error(), CapsuleFault::too_large);
}

}  // namespace
}  // namespace octoskin
