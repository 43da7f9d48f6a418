#include "host/lab/evaluation/seen.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <set>

#include "host/lab/evaluation/metrics.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "tests/support/evidence.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

constexpr auto kOccupied = Occupancy::occupied;
constexpr auto kFree = Occupancy::free;
constexpr auto kUnknown = Occupancy::unknown;
const Eigen::Isometry3d kAtOrigin = Eigen::Isometry3d::Identity();

/// At the origin, looks along +x: image right is -y.
rig::Camera camera(double focal_px = 400.0) {
    rig::Camera camera{.width = 401, .height = 401, .fx = focal_px, .fy = focal_px, .cx = 200.5, .cy = 200.5};
    camera.depth_min_m = 0.2;
    camera.depth_max_m = 4.5;
    camera.T_link_camera = T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    return camera;
}

/// 4 cm voxels with x in 0.4..2.6 m, y and z in -0.4..0.4 m.
TruthConfig config() {
    TruthConfig config;
    config.region = {{0.4, -0.4, -0.4}, {2.6, 0.4, 0.4}, std::nullopt};
    return config;
}

/// Beyond the region: without it, pixels beside a solid see nothing, and no space before it is seen.
sim::Solid far_wall() {
    return box("far_wall", {4.0, -6.0, -6.0}, {4.2, 6.0, 6.0});
}

/// Its faces are in the middle of voxels; the camera sees its front: 10 x 10 voxels, x key 50.
sim::World plate() {
    return sim::World({box("plate", {2.02, -0.18, -0.18}, {2.30, 0.18, 0.18}), far_wall()});
}

SeenTruth truth_of(const sim::World& world, const rig::Camera& of_camera = camera(),
                   const Eigen::Isometry3d& T_map_base = kAtOrigin) {
    auto truth = seen_truth(world, {&of_camera, 1}, config(), T_map_base);
    EXPECT_TRUE(truth) << truth.error().message();
    return std::move(*truth);
}

/// A map with a state for each voxel of the region and 16 cm round it.
FusedMap map_of(const SeenTruth& truth, const std::function<Occupancy(VoxelKey)>& state) {
    FusedMap map{MapConfig{}};
    std::vector<VoxelUpdate> updates;
    const KeyBox box = truth.region().padded(4);
    for (std::size_t i = 0; i < box.size(); ++i) {
        const Occupancy of_voxel = state(box.key_at(i));
        if (of_voxel != kUnknown) updates.push_back({box.key_at(i), of_voxel == kOccupied ? 2.0F : -1.0F});
    }
    feed(map, updates);
    return map;
}

FusedMap uniform(const SeenTruth& truth, Occupancy state) {
    return map_of(truth, [=](VoxelKey) { return state; });
}

bool is_plate(VoxelKey voxel) {
    return key(50, -5, -5).x <= voxel.x && key(0, -5, -5).y <= voxel.y && voxel.y <= key(0, 4, 4).y &&
           key(0, -5, -5).z <= voxel.z && voxel.z <= key(0, 4, 4).z;
}

/// What a noise-free image of the plate makes: the front occupied, behind it unknown, all else free.
Occupancy ideal(VoxelKey voxel) {
    if (!is_plate(voxel)) return kFree;
    return voxel.x == key(50, 0, 0).x ? kOccupied : kUnknown;
}

const SeenShares& of_class(const SeenMetrics& metrics, ThicknessClass thickness) {
    return metrics.by_class[static_cast<std::size_t>(thickness)];
}

TEST(SeenTruth, holds_the_front_of_a_plate) {
    const SeenTruth truth = truth_of(plate());
    ASSERT_EQ(truth.voxels.size(), 100U);
    for (const SeenVoxel& voxel : truth.voxels) {
        EXPECT_TRUE(is_plate(voxel.key) && voxel.key.x == key(50, 0, 0).x);
        EXPECT_EQ(voxel.thickness, ThicknessClass::other);
        EXPECT_TRUE(voxel.is_resolved);
        const Eigen::Vector3d off_centre =
            voxel.p_map_point - VoxelLattice(truth.resolution_m).centre_of(voxel.key);
        EXPECT_LT(off_centre.norm(), 0.0052) << "the pixel nearest to the centre: pixels are 5 mm apart";
        EXPECT_NEAR(voxel.outwards_map.x(), -1.0, 1e-9);
    }
    // By hand: a shell of 10 x 10 x 8 voxels less 8 x 8 x 6, 100 of them seen.
    EXPECT_DOUBLE_EQ(truth.f1_noise_free.value(), 200.0 / 516.0);
    EXPECT_GT(truth.p_map_clear_spheres.size(), 1000U);
}

TEST(SeenTruth, moves_with_the_world) {
    Eigen::Isometry3d T_map_base = kAtOrigin;
    T_map_base.translation() << 0.08, -0.04, 0.12;
    const SeenTruth truth = truth_of(plate(), camera(), T_map_base);
    ASSERT_EQ(truth.voxels.size(), 100U);
    EXPECT_EQ(truth.voxels.front().key, key(52, -6, -2));
    EXPECT_NEAR(truth.voxels.front().p_map_point.x(), 2.10, 1e-6);
}

/// In the plane of the plate's middle.
rig::Camera camera_at(double x, double y) {
    rig::Camera placed = camera();
    placed.T_link_camera = T_base_camera_of({{x, y, 0.0}, {2.16, 0.0, 0.0}});
    return placed;
}

SeenTruth truth_of_both(const rig::Camera& one, const rig::Camera& other) {
    const std::array both{one, other};
    auto truth = seen_truth(plate(), both, config(), kAtOrigin);
    EXPECT_TRUE(truth) << truth.error().message();
    return std::move(*truth);
}

std::set<VoxelKey> keys_of(const SeenTruth& truth) {
    std::set<VoxelKey> keys;
    for (const SeenVoxel& voxel : truth.voxels) keys.insert(voxel.key);
    return keys;
}

void expect_equal(const SeenTruth& one, const SeenTruth& other) {
    ASSERT_EQ(one.voxels.size(), other.voxels.size());
    for (std::size_t i = 0; i < one.voxels.size(); ++i) {
        EXPECT_EQ(one.voxels[i].key, other.voxels[i].key);
        EXPECT_EQ(one.voxels[i].p_map_point, other.voxels[i].p_map_point);
        EXPECT_EQ(one.voxels[i].outwards_map, other.voxels[i].outwards_map);
        EXPECT_EQ(one.voxels[i].to_camera_map, other.voxels[i].to_camera_map);
        EXPECT_EQ(one.voxels[i].is_resolved, other.voxels[i].is_resolved);
    }
    EXPECT_EQ(one.p_map_clear_spheres, other.p_map_clear_spheres);
    EXPECT_EQ(one.f1_noise_free, other.f1_noise_free);
}

TEST(SeenTruth, of_two_cameras_holds_what_either_sees) {
    const std::array cameras{camera(), camera_at(3.7, 0.0), camera_at(0.2, 1.2), camera_at(3.6, -0.8)};
    for (const rig::Camera& one : cameras) {
        for (const rig::Camera& other : cameras) {
            std::set<VoxelKey> either = keys_of(truth_of(plate(), one));
            either.merge(keys_of(truth_of(plate(), other)));
            EXPECT_EQ(keys_of(truth_of_both(one, other)), either);
        }
    }
    // The front and the back of the plate.
    EXPECT_EQ(truth_of_both(camera(), camera_at(3.7, 0.0)).voxels.size(), 200U);
}

TEST(SeenTruth, of_a_camera_given_twice_is_that_of_the_camera) {
    expect_equal(truth_of_both(camera(), camera()), truth_of(plate()));
}

TEST(SeenTruth, of_two_cameras_has_the_surface_and_the_camera_of_each_voxel) {
    const SeenTruth truth = truth_of_both(camera(), camera_at(3.7, 0.0));
    for (const SeenVoxel& voxel : truth.voxels) {
        const double towards = voxel.key.x == key(50, 0, 0).x ? -1.0 : 1.0;
        EXPECT_NEAR(voxel.outwards_map.x(), towards, 1e-9);
        EXPECT_GT(towards * voxel.to_camera_map.x(), 0.9);
    }
}

TEST(SeenTruth, of_two_cameras_has_clear_spheres_that_one_sees) {
    const SeenTruth front = truth_of(plate());
    const SeenTruth both = truth_of_both(camera(), camera_at(3.7, 0.0));
    const auto is_behind = [](const Eigen::Vector3d& p_map) {
        return p_map.x() > 2.35 && p_map.tail<2>().norm() < 0.1;
    };
    EXPECT_TRUE(std::ranges::none_of(front.p_map_clear_spheres, is_behind));
    EXPECT_TRUE(std::ranges::any_of(both.p_map_clear_spheres, is_behind));
}

TEST(SeenTruth, clear_spheres_keep_their_distance) {
    const sim::World world = plate();
    const SeenTruth truth = truth_of(world);
    const Eigen::AlignedBox3d solid(Eigen::Vector3d(2.02, -0.18, -0.18), Eigen::Vector3d(2.30, 0.18, 0.18));
    const Eigen::AlignedBox3d region(Eigen::Vector3d(0.4, -0.4, -0.4), Eigen::Vector3d(2.6, 0.4, 0.4));
    for (const Eigen::Vector3d& p_map : truth.p_map_clear_spheres) {
        EXPECT_GE(solid.exteriorDistance(p_map), 0.09 - 0.006) << "less a pixel at the edge";
        EXPECT_FALSE(world.cast(Eigen::Vector3d::Zero(), p_map.normalized(), p_map.norm()));
        EXPECT_TRUE(region.contains(p_map - Eigen::Vector3d::Constant(0.0499)));
        EXPECT_TRUE(region.contains(p_map + Eigen::Vector3d::Constant(0.0499)));
    }
}

TEST(SeenTruth, refuses_a_region_that_cannot_be_judged) {
    TruthConfig empty = config();
    empty.region.p_map_max = empty.region.p_map_min;
    const rig::Camera one = camera();
    const auto refused = seen_truth(plate(), {&one, 1}, empty, kAtOrigin);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::no_content);
    TruthConfig slow = config();
    slow.surface_pitch_m = 1e-6;
    const auto too_slow = seen_truth(plate(), {&one, 1}, slow, kAtOrigin);
    ASSERT_FALSE(too_slow);
    EXPECT_EQ(too_slow.error().code, ErrorCode::limit_exceeded);
}

TEST(SeenMetrics, of_an_empty_map) {
    const SeenMetrics metrics = seen_metrics(FusedMap{MapConfig{}}, truth_of(plate()));
    EXPECT_EQ(metrics.all.voxels, 100U);
    EXPECT_EQ(metrics.seen_unknown.value(), 1.0);
    EXPECT_EQ(metrics.seen_occupied.value(), 0.0);
    EXPECT_EQ(metrics.seen_free.value(), 0.0);
    EXPECT_EQ(metrics.body_2cm.value(), 0.0);
    EXPECT_EQ(metrics.body_5cm.value(), 0.0);
    EXPECT_EQ(metrics.availability_5cm.value(), 0.0);
    EXPECT_FALSE(metrics.precision);
    EXPECT_EQ(metrics.f1_seen.value(), 0.0);
}

TEST(SeenMetrics, of_a_map_that_is_all_free) {
    const SeenTruth truth = truth_of(plate());
    const SeenMetrics metrics = seen_metrics(uniform(truth, kFree), truth);
    EXPECT_EQ(metrics.seen_free.value(), 1.0);
    EXPECT_EQ(metrics.all.body_2cm.spheres, 400U);
    EXPECT_EQ(metrics.body_2cm.value(), 1.0);
    EXPECT_EQ(metrics.body_5cm.value(), 1.0);
    EXPECT_EQ(metrics.availability_5cm.value(), 1.0);
    EXPECT_EQ(metrics.clear_spheres, truth.p_map_clear_spheres.size());
    EXPECT_EQ(metrics.f1_seen.value(), 0.0);
}

TEST(SeenMetrics, of_a_map_that_is_all_occupied) {
    const SeenTruth truth = truth_of(plate());
    const SeenMetrics metrics = seen_metrics(uniform(truth, kOccupied), truth);
    EXPECT_EQ(metrics.seen_occupied.value(), 1.0);
    EXPECT_EQ(metrics.body_2cm.value(), 0.0);
    EXPECT_EQ(metrics.body_5cm.value(), 0.0);
    EXPECT_EQ(metrics.availability_5cm.value(), 0.0);
    // 55 x 20 x 20 voxels, 384 inside the plate, 416 on its surface.
    EXPECT_DOUBLE_EQ(metrics.precision.value(), 416.0 / (22000.0 - 384.0));
    EXPECT_DOUBLE_EQ(metrics.f1_seen.value(), 2.0 * 416.0 / (22000.0 - 384.0 + 416.0));
}

TEST(SeenMetrics, of_a_noise_free_image_are_perfect) {
    const SeenTruth truth = truth_of(plate());
    const SeenMetrics metrics = seen_metrics(map_of(truth, ideal), truth);
    EXPECT_EQ(metrics.seen_occupied.value(), 1.0);
    EXPECT_EQ(metrics.precision.value(), 1.0);
    EXPECT_EQ(metrics.f1_seen.value(), 1.0);
    EXPECT_EQ(metrics.body_2cm.value(), 0.0);
    EXPECT_EQ(metrics.body_5cm.value(), 0.0);
    EXPECT_EQ(metrics.f1_noise_free, truth.f1_noise_free);
    EXPECT_GT(metrics.availability_5cm.value(), 0.99)
        << "some spheres beside the plate touch its outer voxels";
}

TEST(SeenMetrics, a_hole_of_three_voxels_lets_one_large_sphere_through) {
    // Only along the normal of the middle voxel: there the sphere meets the layer in a disc of 46 mm, the
    // hole has 60. The tilted ones reach 65 mm or more, those of the outer voxels 86.
    const SeenTruth truth = truth_of(plate());
    const auto with_hole = [](VoxelKey voxel) {
        const bool is_hole = std::abs(voxel.y - kOriginKey) <= 1 && std::abs(voxel.z - kOriginKey) <= 1;
        return ideal(voxel) == kOccupied && is_hole ? kFree : ideal(voxel);
    };
    const SeenMetrics metrics = seen_metrics(map_of(truth, with_hole), truth);
    EXPECT_EQ(metrics.all.free, 9U);
    EXPECT_EQ(metrics.all.body_5cm.free, 1U);
    EXPECT_GE(metrics.all.body_2cm.free, 4U);
    EXPECT_LE(metrics.all.body_2cm.free, 36U);
    EXPECT_DOUBLE_EQ(metrics.seen_occupied.value(), 0.91);
    EXPECT_DOUBLE_EQ(metrics.f1_seen.value(), 2.0 * 0.91 / 1.91);
}

/// 6 mm thick, upright, in the voxels with x key 25 and y key 0; behind it a wall in the middle of key 38.
sim::World rod_before_wall(double rod_x_m = 1.017) {
    return sim::World({box("rod", {rod_x_m, 0.017, -0.5}, {rod_x_m + 0.006, 0.023, 0.5}),
                       box("wall", {1.54, -3.0, -3.0}, {2.54, 3.0, 3.0})});
}

Occupancy wall_only(VoxelKey voxel) {
    return voxel.x < key(38, 0, 0).x ? kFree : voxel.x == key(38, 0, 0).x ? kOccupied : kUnknown;
}

TEST(SeenMetrics, a_lost_rod_before_a_wall_is_the_rods_class_alone) {
    const SeenTruth truth = truth_of(rod_before_wall());
    const SeenMetrics metrics = seen_metrics(map_of(truth, wall_only), truth);
    const SeenShares& rod = of_class(metrics, ThicknessClass::rod_5_8_mm);
    EXPECT_EQ(rod.voxels, 20U);
    EXPECT_EQ(rod.free_share().value(), 1.0);
    EXPECT_EQ(rod.body_2cm.free_share().value(), 1.0);
    EXPECT_EQ(rod.body_5cm.free_share().value(), 1.0) << "a planner would drive into it";
    const SeenShares& wall = of_class(metrics, ThicknessClass::other);
    EXPECT_EQ(wall.occupied_share().value(), 1.0);
    EXPECT_EQ(wall.body_5cm.free, 0U);
    EXPECT_EQ(metrics.too_coarse.voxels, 0U);
    EXPECT_DOUBLE_EQ(metrics.body_5cm.value(), 20.0 / static_cast<double>(20 + wall.voxels));
}

TEST(SeenMetrics, a_found_rod_stops_every_sphere) {
    const SeenTruth truth = truth_of(rod_before_wall());
    const auto with_rod = [](VoxelKey voxel) {
        const bool is_rod = voxel.x == key(25, 0, 0).x && voxel.y == key(0, 0, 0).y;
        return is_rod ? kOccupied : wall_only(voxel);
    };
    const SeenMetrics metrics = seen_metrics(map_of(truth, with_rod), truth);
    EXPECT_EQ(of_class(metrics, ThicknessClass::rod_5_8_mm).occupied_share().value(), 1.0);
    EXPECT_EQ(of_class(metrics, ThicknessClass::rod_5_8_mm).body_2cm.free, 0U);
    EXPECT_EQ(of_class(metrics, ThicknessClass::rod_5_8_mm).body_5cm.free, 0U);
    EXPECT_EQ(metrics.f1_seen.value(), 1.0);
}

TEST(SeenMetrics, a_voxel_with_rod_and_wall_is_the_walls) {
    const SeenMetrics metrics = seen_metrics(FusedMap{MapConfig{}}, truth_of(rod_before_wall(1.53)));
    EXPECT_EQ(of_class(metrics, ThicknessClass::rod_5_8_mm).voxels, 0U);
    EXPECT_EQ(of_class(metrics, ThicknessClass::other).voxels, 400U);
}

TEST(SeenMetrics, a_rod_thinner_than_a_pixel_counts_apart) {
    // 10 mm a pixel, rod 6 mm: more than 2 mm coarser. One column of pixels meets the rod.
    const SeenTruth coarse = truth_of(rod_before_wall(), camera(100.0));
    const SeenMetrics metrics = seen_metrics(map_of(coarse, wall_only), coarse);
    EXPECT_EQ(of_class(metrics, ThicknessClass::rod_5_8_mm).voxels, 0U);
    EXPECT_EQ(metrics.too_coarse.voxels, 20U);
    EXPECT_EQ(metrics.too_coarse.free, 20U);
    EXPECT_EQ(metrics.all.free, 20U) << "overall they count";
    // 6.8 mm a pixel: fine enough.
    EXPECT_EQ(of_class(seen_metrics(FusedMap{MapConfig{}}, truth_of(rod_before_wall(), camera(150.0))),
                       ThicknessClass::rod_5_8_mm)
                  .voxels,
              20U);
}

TEST(SeenMetrics, without_anything_seen_are_empty) {
    const sim::World nothing({box("behind", {-3.0, -1.0, -1.0}, {-2.0, 1.0, 1.0})});
    const SeenTruth truth = truth_of(nothing);
    EXPECT_TRUE(truth.voxels.empty());
    EXPECT_TRUE(truth.p_map_clear_spheres.empty()) << "a ray without a return shows no free space";
    const SeenMetrics metrics = seen_metrics(uniform(truth, kFree), truth);
    EXPECT_FALSE(metrics.seen_occupied || metrics.seen_free || metrics.seen_unknown);
    EXPECT_FALSE(metrics.precision || metrics.f1_seen || metrics.f1_noise_free);
    EXPECT_FALSE(metrics.body_2cm || metrics.body_5cm || metrics.availability_5cm);
}

TEST(BodyCentres, hold_the_point_one_centimetre_deep_on_the_cameras_side) {
    // A floor that is seen almost from its edge, a rod that is seen on all of its near side, and a wall.
    const sim::World world({box("floor", {0.4, -1.0, -0.16}, {3.0, 1.0, -0.1}),
                            box("wall", {2.5, -1.0, -1.0}, {3.0, 1.0, 1.0}),
                            box("post", {1.0, 0.05, -1.0}, {1.03, 0.08, 1.0})});
    const SeenTruth truth = truth_of(world);
    ASSERT_GT(truth.voxels.size(), 500U);
    double most_grazing = 1.0;
    for (const SeenVoxel& voxel : truth.voxels) {
        EXPECT_NEAR(voxel.outwards_map.norm(), 1.0, 1e-9);
        most_grazing = std::min(most_grazing, voxel.outwards_map.dot(voxel.to_camera_map));
        EXPECT_GE(voxel.outwards_map.dot(voxel.to_camera_map), std::cos(55.0 / 180.0 * M_PI) - 1e-9);
        for (const double radius_m : kBodyRadii_m) {
            const auto centres = body_centres(voxel, radius_m);
            for (std::size_t i = 0; i < centres.size(); ++i) {
                const Eigen::Vector3d away = centres[i] - voxel.p_map_point;
                EXPECT_NEAR(away.norm(), radius_m - 0.01, 1e-9);
                EXPECT_GE(away.dot(voxel.to_camera_map), -1e-9);
                if (i > 0) {
                    EXPECT_NEAR(away.normalized().dot(voxel.outwards_map), std::cos(35.0 / 180.0 * M_PI),
                                1e-9);
                }
            }
            EXPECT_GE((centres[1] - centres[2]).dot(voxel.to_camera_map), -1e-9)
                << "the first looks at the camera";
        }
    }
    EXPECT_NEAR(most_grazing, std::cos(55.0 / 180.0 * M_PI), 1e-9) << "some are turned";
}

/// Each voxel of the map as a box, by Eigen's own distance.
std::uint64_t free_spheres(const FusedMap& map, const std::vector<Eigen::Vector3d>& centres,
                           double radius_m) {
    std::uint64_t free = 0;
    for (const Eigen::Vector3d& centre : centres) {
        bool is_free = true;
        const VoxelKey middle = map.key_of(centre).value();
        for (int i = 0; i < 343; ++i) {
            const auto shifted = [&](std::uint16_t part, int by) {
                return static_cast<std::uint16_t>(part + by - 3);
            };
            const VoxelKey near{shifted(middle.x, i % 7), shifted(middle.y, i / 7 % 7),
                                shifted(middle.z, i / 49)};
            const Eigen::Vector3d half = Eigen::Vector3d::Constant(map.resolution_m() / 2.0);
            const Eigen::AlignedBox3d cube(map.centre_of(near) - half, map.centre_of(near) + half);
            if (cube.exteriorDistance(centre) < radius_m && map.occupancy(near) != kFree) is_free = false;
        }
        free += is_free ? 1U : 0U;
    }
    return free;
}

class RandomMaps : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, RandomMaps, ::testing::Range(0U, 4U));

TEST_P(RandomMaps, add_up_and_agree_with_other_code) {
    const sim::World world = rod_before_wall();
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera()};
    const auto truth = build_truth(world, {}, with_camera, kAtOrigin);
    ASSERT_TRUE(truth && truth->seen);
    const SeenTruth& seen = *truth->seen;
    std::mt19937 random(GetParam());
    // Mostly free, or hardly any sphere would be.
    const FusedMap map = map_of(seen, [&](VoxelKey) {
        const auto draw = random() % 200;
        return draw == 0 ? kOccupied : draw == 1 ? kUnknown : kFree;
    });
    const SeenMetrics metrics = seen_metrics(map, seen);

    EXPECT_EQ(metrics.all.occupied + metrics.all.free + metrics.all.unknown, metrics.all.voxels);
    EXPECT_NEAR(*metrics.seen_occupied + *metrics.seen_free + *metrics.seen_unknown, 1.0, 1e-12);
    SeenShares sum = metrics.too_coarse;
    for (const SeenShares& shares : metrics.by_class) sum.add(shares);
    EXPECT_EQ(sum.voxels, metrics.all.voxels);
    EXPECT_EQ(sum.occupied, metrics.all.occupied);
    EXPECT_EQ(sum.body_5cm.free, metrics.all.body_5cm.free);

    const Metrics plain = evaluate(map, *truth, MissUnits{});
    EXPECT_EQ(metrics.precision, plain.precision);
    EXPECT_EQ(metrics.precision_tolerant, plain.precision_tolerant);

    std::vector<Eigen::Vector3d> small;
    std::vector<Eigen::Vector3d> large;
    for (const SeenVoxel& voxel : seen.voxels) {
        std::ranges::copy(body_centres(voxel, 0.02), std::back_inserter(small));
        std::ranges::copy(body_centres(voxel, 0.05), std::back_inserter(large));
    }
    EXPECT_EQ(metrics.all.body_2cm.free, free_spheres(map, small, 0.02)) << "seed " << GetParam();
    EXPECT_EQ(metrics.all.body_5cm.free, free_spheres(map, large, 0.05));
    EXPECT_EQ(metrics.clear_spheres_free, free_spheres(map, seen.p_map_clear_spheres, 0.05));
    EXPECT_GT(metrics.all.body_5cm.free, 0U);
    EXPECT_LT(metrics.all.body_5cm.free, metrics.all.body_5cm.spheres);
}

TEST(SeenTruth, is_the_same_alone_and_as_part_of_the_truth) {
    const sim::World world = rod_before_wall();
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera()};
    const auto truth = build_truth(world, {}, with_camera, kAtOrigin);
    ASSERT_TRUE(truth && truth->seen);
    const SeenTruth alone = truth_of(world);
    ASSERT_EQ(alone.voxels.size(), truth->seen->voxels.size());
    for (std::size_t i = 0; i < alone.voxels.size(); ++i) {
        EXPECT_EQ(alone.voxels[i].key, truth->seen->voxels[i].key);
        EXPECT_TRUE(truth->surface.at(alone.voxels[i].key).is_seen);
    }
    EXPECT_EQ(alone.f1_noise_free, truth->seen->f1_noise_free);
    EXPECT_EQ(alone.p_map_clear_spheres, truth->seen->p_map_clear_spheres);
    EXPECT_FALSE(build_truth(world, {}, config(), kAtOrigin)->seen) << "without a camera";
}

}  // namespace
}  // namespace octoskin::evaluation
