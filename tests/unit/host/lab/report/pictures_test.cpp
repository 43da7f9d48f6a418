#include "host/lab/report/pictures.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::report {
namespace {

using evaluation::box;
using evaluation::key;
using evaluation::SurfaceVoxel;

/// Two layers of five voxels along x, nothing known yet.
evaluation::Truth five_by_two() {
    const evaluation::KeyBox region{key(0, 0, 1), key(4, 0, 2)};
    return {0.04, evaluation::VoxelGrid<Occupancy>(region), evaluation::VoxelGrid<SurfaceVoxel>(region)};
}

constexpr PictureSize kSmall{90, 65};

bool is_blank(const Image& image) {
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
        if (image.rgba[i] != 0) {
            return false;
        }
    }
    return true;
}

int opaque_pixels(const Image& image) {
    int count = 0;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4) {
        count += image.rgba[i] == 255 ? 1 : 0;
    }
    return count;
}

TEST(PaintMap, tells_right_hidden_wrong_lost_and_floor_apart) {
    evaluation::Truth truth = five_by_two();
    truth.surface.at(key(0, 0, 1)) = {.is_surface = true};
    truth.surface.at(key(1, 0, 1)) = {.is_surface = true, .is_hidden_object = true};
    truth.surface.at(key(3, 0, 1)) = {.is_surface = true};
    truth.surface.at(key(4, 0, 1)) = {.is_surface = true};
    truth.surface.at(key(0, 0, 2)) = {.is_interior = true};
    FusedMap map{MapConfig{}};
    feed(map, std::vector<VoxelUpdate>{{key(0, 0, 1), 1.0F},
                                       {key(1, 0, 1), 1.0F},
                                       {key(2, 0, 1), 1.0F},
                                       {key(3, 0, 1), -1.0F},
                                       {key(0, 0, 2), 1.0F},
                                       {key(1, 0, 2), -1.0F},
                                       {key(2, 0, 0), 1.0F},
                                       {key(3, 0, 0), -1.0F},
                                       {key(2, 0, -1), 1.0F},
                                       {key(2, 1, 1), 1.0F}});
    std::map<VoxelKey, VoxelKind> kinds;
    for (const auto& voxel : paint_map(map, truth)) {
        kinds.emplace(voxel.key, voxel.kind);
    }
    // Not painted: unknown, rightly free, below the floor's layer, beside the region.
    EXPECT_EQ(kinds, (std::map<VoxelKey, VoxelKind>{{key(0, 0, 1), VoxelKind::right},
                                                    {key(1, 0, 1), VoxelKind::hidden_object},
                                                    {key(2, 0, 1), VoxelKind::wrong},
                                                    {key(3, 0, 1), VoxelKind::lost},
                                                    {key(0, 0, 2), VoxelKind::right},
                                                    {key(2, 0, 0), VoxelKind::floor}}));
}

TEST(PaintTruth, shows_every_surface_voxel) {
    evaluation::Truth truth = five_by_two();
    truth.surface.at(key(0, 0, 1)) = {.is_surface = true};
    truth.surface.at(key(1, 0, 2)) = {.is_surface = true, .is_hidden_object = true};
    truth.surface.at(key(2, 0, 2)) = {.is_interior = true};
    const auto painted = paint_truth(truth);
    ASSERT_EQ(painted.size(), 2U);
    EXPECT_EQ(painted[0].kind, VoxelKind::right);
    EXPECT_EQ(painted[1].kind, VoxelKind::hidden_object);
}

TEST(RenderVoxels, shows_the_map_from_both_sides_and_the_same_every_time) {
    const std::vector<PaintedVoxel> voxels = {{key(0, 0, 0), VoxelKind::right},
                                              {key(1, 0, 0), VoxelKind::hidden_object},
                                              {key(3, 0, 0), VoxelKind::wrong},
                                              {key(5, 0, 0), VoxelKind::lost}};
    const std::vector<Eigen::Vector3d> corners = {{0.0, 0.0, 0.0}, {0.24, 0.04, 0.04}};
    const ViewPair views = views_of(corners, kSmall);
    const ImagePair first = render_voxels(voxels, 0.04, views);
    EXPECT_FALSE(is_blank(first.front));
    EXPECT_FALSE(is_blank(first.back));
    EXPECT_NE(first.front.rgba, first.back.rgba);
    const ImagePair second = render_voxels(voxels, 0.04, views);
    EXPECT_EQ(first.front.rgba, second.front.rgba);
    EXPECT_EQ(first.back.rgba, second.back.rgba);
}

TEST(RenderVoxels, draws_a_lost_voxel_as_a_frame_that_one_can_look_through) {
    const std::vector<Eigen::Vector3d> corners = {{0.0, 0.0, 0.0}, {0.04, 0.04, 0.04}};
    const ViewPair views = views_of(corners, kSmall);
    const std::vector<PaintedVoxel> solid = {{key(0, 0, 0), VoxelKind::right}};
    const std::vector<PaintedVoxel> lost = {{key(0, 0, 0), VoxelKind::lost}};
    const int of_solid = opaque_pixels(render_voxels(solid, 0.04, views).front);
    const int of_lost = opaque_pixels(render_voxels(lost, 0.04, views).front);
    EXPECT_GT(of_lost, 0);
    EXPECT_LT(of_lost, of_solid / 2);
}

TEST(RenderVoxels, of_an_empty_map_is_a_blank_picture) {
    const std::vector<Eigen::Vector3d> corners = {{0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}};
    EXPECT_TRUE(is_blank(render_voxels({}, 0.04, views_of(corners, kSmall)).front));
}

TEST(ContentOf, is_the_box_round_all_voxels_but_the_floor) {
    const std::vector<std::vector<PaintedVoxel>> lists = {
        {{key(0, 0, 1), VoxelKind::right}, {key(90, 90, 0), VoxelKind::floor}},
        {{key(2, 0, 1), VoxelKind::lost}, {key(0, 1, 3), VoxelKind::wrong}}};
    const Eigen::AlignedBox3d content = content_of(lists, 0.04);
    EXPECT_NEAR((content.min() - Eigen::Vector3d(0.0, 0.0, 0.04)).norm(), 0.0, 1e-9);
    EXPECT_TRUE(content.sizes().isApprox(Eigen::Vector3d(0.12, 0.08, 0.12), 1e-9));
    EXPECT_TRUE(content_of({}, 0.04).isEmpty());
}

/// The smallest rectangle round what is painted, as a share of the picture's width and height.
Eigen::Vector2d painted_share(const Image& image) {
    Eigen::AlignedBox2d painted;
    for (std::uint32_t row = 0; row < image.height; ++row) {
        for (std::uint32_t column = 0; column < image.width; ++column) {
            if (image.rgba[4 * (std::size_t{row} * image.width + column) + 3] != 0) {
                painted.extend(Eigen::Vector2d(column, row));
            }
        }
    }
    return painted.sizes().cwiseQuotient(Eigen::Vector2d(image.width, image.height));
}

TEST(RenderScene, fills_the_picture_with_a_small_scene_on_a_large_stage) {
    const sim::World world({box("mug", {0.4, -0.05, 0.0}, {0.5, 0.05, 0.1})});
    SceneDressing dressing;
    dressing.size = kSmall;
    dressing.stage = Eigen::AlignedBox3d(Eigen::Vector3d(-2.0, -2.0, 0.0), Eigen::Vector3d(2.0, 2.0, 2.0));
    // With the room round it the mug is 20 cm wide, of which it takes up half.
    EXPECT_GT(painted_share(render_scene(world, dressing).front).maxCoeff(), 0.4);
}

TEST(RenderScene, never_cuts_a_camera_off) {
    const sim::World world({box("crate", {0.4, -0.2, 0.0}, {0.8, 0.2, 0.4})});
    SceneDressing dressing;
    dressing.size = kSmall;
    dressing.stage = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -1.0, 0.0), Eigen::Vector3d(1.2, 1.0, 1.0));
    dressing.cameras = {rig::Camera{.width = 40, .height = 30, .fx = 30, .fy = 30, .cx = 20, .cy = 15}};
    for (const double y : {0.0, 0.3, 0.4, 0.5, 0.6, 0.9}) {
        dressing.cameras.front().T_link_camera.translation() << 0.6, y, 0.3;
        const ImagePair images = render_scene(world, dressing);
        for (const Image& image : {images.front, images.back}) {
            for (std::uint32_t row = 0; row < image.height; ++row) {
                const std::size_t first = std::size_t{row} * image.width;
                EXPECT_EQ(image.rgba[4 * first + 3], 0) << "y " << y << ", row " << row;
                EXPECT_EQ(image.rgba[4 * (first + image.width - 1) + 3], 0) << "y " << y << ", row " << row;
            }
        }
    }
}

TEST(RenderScene, shows_every_camera) {
    const sim::World world({box("crate", {0.4, -0.2, 0.0}, {0.8, 0.2, 0.4})});
    SceneDressing dressing;
    dressing.size = kSmall;
    dressing.stage = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -1.0, 0.0), Eigen::Vector3d(1.2, 1.0, 1.0));
    rig::Camera camera{.width = 40, .height = 30, .fx = 30, .fy = 30, .cx = 20, .cy = 15};
    camera.T_link_camera.translation() << 2.0, 0.5, 1.0;
    dressing.cameras = {camera};
    const ImagePair with_one = render_scene(world, dressing);
    camera.T_link_camera.translation() << 2.0, -0.5, 1.0;
    dressing.cameras.push_back(camera);
    const ImagePair with_two = render_scene(world, dressing);
    EXPECT_NE(with_two.back.rgba, with_one.back.rgba);
    EXPECT_GT(painted_share(with_two.back).x(), painted_share(with_one.back).x());
}

TEST(RenderScene, shows_world_robot_camera_and_beams) {
    const sim::World world(
        {box("floor", {-5.0, -5.0, -0.1}, {5.0, 5.0, 0.0}), box("crate", {0.4, -0.2, 0.0}, {0.8, 0.2, 0.4})});
    SceneDressing dressing;
    dressing.size = kSmall;
    dressing.stage = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -1.0, 0.0), Eigen::Vector3d(1.2, 1.0, 1.0));
    const ImagePair plain = render_scene(world, dressing);
    EXPECT_FALSE(is_blank(plain.front));
    EXPECT_EQ(plain.front.width, 90U);
    dressing.robot.push_back({{0.0, 0.0, 0.1}, {0.0, 0.0, 0.6}, 0.08});
    dressing.hidden_models = {"crate"};
    dressing.beams.push_back({{0.0, 0.0, 0.5}, {9.0, 0.0, 0.5}});
    dressing.cameras = {rig::Camera{.width = 40, .height = 30, .fx = 30, .fy = 30, .cx = 20, .cy = 15}};
    dressing.cameras.front().T_link_camera.translation() << 2.0, 0.0, 1.0;
    const ImagePair dressed = render_scene(world, dressing);
    EXPECT_NE(dressed.front.rgba, plain.front.rgba);
    EXPECT_NE(dressed.back.rgba, plain.back.rgba);
}

}  // namespace
}  // namespace octoskin::report
