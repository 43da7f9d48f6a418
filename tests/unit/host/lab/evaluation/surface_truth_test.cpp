#include <gtest/gtest.h>

#include "host/lab/evaluation/truth.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

const Eigen::Isometry3d kAtOrigin = Eigen::Isometry3d::Identity();
const KeyBox kRegion{key(-2, -2, -2), key(9, 9, 9)};

/// Faces in the middle of voxels 0 and 5 along each axis: surface 6^3 - 4^3 = 152 voxels, interior 64.
sim::World cube() {
    return sim::World({box("crate", {0.05, 0.05, 0.05}, {0.55, 0.55, 0.55})});
}

TruthConfig config() {
    TruthConfig config;
    config.resolution_m = 0.1;
    return config;
}

/// Looks along -x at the cube's face at x = 0.55 from its axis: no other face can be seen.
rig::Camera camera_at_positive_x() {
    rig::Camera camera{.width = 200, .height = 200, .fx = 400.0, .fy = 400.0, .cx = 100.0, .cy = 100.0};
    camera.T_link_camera = T_base_camera_of({{2.0, 0.3, 0.3}, {0.0, 0.3, 0.3}});
    return camera;
}

template <class Predicate>
int count(const VoxelGrid<SurfaceVoxel>& truth, Predicate predicate) {
    int counted = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        counted += predicate(truth[i]) ? 1 : 0;
    }
    return counted;
}

TEST(SurfaceTruth, of_a_cube_is_its_shell_with_the_interior_apart) {
    const auto truth = surface_truth(cube(), config(), kRegion, kAtOrigin);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_surface; }), 152);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_interior; }), 64);
    EXPECT_TRUE(truth.at(key(0, 0, 0)).is_surface);
    EXPECT_TRUE(truth.at(key(5, 3, 3)).is_surface);
    EXPECT_TRUE(truth.at(key(1, 1, 1)).is_interior);
    EXPECT_FALSE(truth.at(key(1, 1, 1)).is_surface);
    EXPECT_FALSE(truth.at(key(6, 3, 3)).is_surface);
}

TEST(SurfaceTruth, near_the_surface_is_one_voxel_in_every_direction) {
    const auto truth = surface_truth(cube(), config(), kRegion, kAtOrigin);
    // The shell grown both ways: 8^3 - 2^3.
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_near_surface; }), 504);
    EXPECT_TRUE(truth.at(key(6, 6, 6)).is_near_surface);
    EXPECT_FALSE(truth.at(key(7, 3, 3)).is_near_surface);
}

TEST(SurfaceTruth, flags_only_the_hidden_models) {
    const sim::World world({box("crate", {0.05, 0.05, 0.05}, {0.15, 0.15, 0.15}),
                            box("shelf", {0.45, 0.05, 0.05}, {0.55, 0.15, 0.15})});
    TruthConfig with_crate = config();
    with_crate.hidden_models = {"crate"};
    const auto truth = surface_truth(world, with_crate, kRegion, kAtOrigin);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_surface; }), 16);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_hidden_object; }), 8);
    EXPECT_TRUE(truth.at(key(1, 1, 1)).is_hidden_object);
    EXPECT_FALSE(truth.at(key(5, 1, 1)).is_hidden_object);
}

TEST(SurfaceTruth, sees_the_face_that_looks_at_the_camera) {
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera_at_positive_x()};
    const auto truth = surface_truth(cube(), with_camera, kRegion, kAtOrigin);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_seen; }), 36);
    EXPECT_TRUE(truth.at(key(5, 0, 0)).is_seen);
    EXPECT_TRUE(truth.at(key(5, 5, 5)).is_seen);
    EXPECT_FALSE(truth.at(key(4, 0, 0)).is_seen);
}

TEST(SurfaceTruth, occluded_is_more_than_two_voxels_from_anything_seen) {
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera_at_positive_x()};
    const auto truth = surface_truth(cube(), with_camera, kRegion, kAtOrigin);
    // Seen: layer x = 5. Layers 3 and 4 are within two voxels; of layers 0, 1 and 2 the shell is occluded:
    // 36 + 20 + 20 voxels.
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_occluded; }), 76);
    EXPECT_TRUE(truth.at(key(2, 0, 0)).is_occluded);
    EXPECT_FALSE(truth.at(key(3, 0, 0)).is_occluded);
    EXPECT_FALSE(truth.at(key(1, 2, 2)).is_occluded) << "interior, not surface";
}

TEST(SurfaceTruth, of_two_cameras_holds_what_either_sees) {
    rig::Camera behind = camera_at_positive_x();
    behind.T_link_camera = T_base_camera_of({{-1.5, 0.3, 0.3}, {0.0, 0.3, 0.3}});
    const auto truth_with = [](const std::vector<rig::Camera>& cameras) {
        TruthConfig with_cameras = config();
        with_cameras.external_cameras = cameras;
        return surface_truth(cube(), with_cameras, kRegion, kAtOrigin);
    };
    const auto first = truth_with({camera_at_positive_x()});
    const auto second = truth_with({behind});
    const auto both = truth_with({camera_at_positive_x(), behind});
    EXPECT_EQ(count(both, [](auto voxel) { return voxel.is_seen; }), 72);
    // Seen: layers 0 and 5. All others are within two voxels of them.
    EXPECT_EQ(count(both, [](auto voxel) { return voxel.is_occluded; }), 0);
    for (std::size_t i = 0; i < both.size(); ++i) {
        EXPECT_EQ(both[i].is_seen, first[i].is_seen || second[i].is_seen);
        EXPECT_LE(both[i].is_occluded, first[i].is_occluded && second[i].is_occluded);
        EXPECT_EQ(both[i].is_surface, first[i].is_surface);
    }
}

TEST(SurfaceTruth, without_a_camera_everything_is_occluded) {
    const auto truth = surface_truth(cube(), config(), kRegion, kAtOrigin);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_occluded; }), 152);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_seen; }), 0);
}

TEST(SurfaceTruth, counts_what_lies_just_outside_the_region_for_the_margins) {
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera_at_positive_x()};
    // Layer 5, which the camera sees, is outside this region; layers 3 and 4 are still near it.
    const KeyBox without_seen_face{key(0, 0, 0), key(4, 5, 5)};
    const auto truth = surface_truth(cube(), with_camera, without_seen_face, kAtOrigin);
    EXPECT_EQ(count(truth, [](auto voxel) { return voxel.is_occluded; }), 76);
    const auto above = surface_truth(cube(), config(), {key(0, 0, 6), key(5, 5, 7)}, kAtOrigin);
    EXPECT_EQ(count(above, [](auto voxel) { return voxel.is_near_surface; }), 36);
}

TEST(SurfaceTruth, moves_with_the_world) {
    Eigen::Isometry3d T_map_base = kAtOrigin;
    T_map_base.translation() << 0.1, -0.1, 0.2;
    TruthConfig with_camera = config();
    with_camera.external_cameras = {camera_at_positive_x()};
    const auto moved = surface_truth(cube(), with_camera, kRegion, T_map_base);
    EXPECT_EQ(count(moved, [](auto voxel) { return voxel.is_surface; }), 152);
    EXPECT_EQ(count(moved, [](auto voxel) { return voxel.is_occluded; }), 76);
    EXPECT_TRUE(moved.at(key(1, -1, 2)).is_surface);
    EXPECT_TRUE(moved.at(key(6, 2, 5)).is_seen);
    EXPECT_TRUE(moved.at(key(2, 0, 3)).is_interior);
}

TEST(BuildTruth, puts_both_truths_over_the_same_region) {
    TruthConfig with_region = config();
    with_region.region = {{-0.2, -0.2, -0.5}, {1.0, 1.0, 1.0}, -0.25};
    const Survey survey{{{{2.05, 0.35, 0.35}, {{0.55F, 0.35F, 0.35F}}}}};
    const auto built = build_truth(cube(), survey, with_region, kAtOrigin);
    ASSERT_TRUE(built) << built.error().message();
    const Truth& truth = *built;
    EXPECT_EQ(truth.region(), (KeyBox{key(-2, -2, -2), key(9, 9, 9)}));
    EXPECT_EQ(truth.surface.box(), truth.region());
    EXPECT_EQ(truth.camera.at(key(5, 3, 3)), Occupancy::occupied);
    EXPECT_EQ(truth.camera.at(key(6, 3, 3)), Occupancy::free);
    EXPECT_EQ(truth.camera.at(key(4, 3, 3)), Occupancy::unknown);
    EXPECT_TRUE(truth.surface.at(key(5, 3, 3)).is_surface);
}

TEST(BuildTruth, refuses_more_points_of_surfaces_than_it_can_look_at) {
    TruthConfig with_region = config();
    with_region.region = {{-0.2, -0.2, -0.5}, {1.0, 1.0, 1.0}, -0.25};
    with_region.surface_pitch_m = 1e-6;  // of 1.5 m^2
    const auto built = build_truth(cube(), {}, with_region, kAtOrigin);
    ASSERT_FALSE(built);
    EXPECT_EQ(built.error().code, ErrorCode::limit_exceeded);
    EXPECT_NE(built.error().what.find("at most 1e+09"), std::string::npos) << built.error().message();
}

}  // namespace
}  // namespace octoskin::evaluation
