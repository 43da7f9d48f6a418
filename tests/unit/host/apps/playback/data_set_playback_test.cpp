// A camera that moves, against the depth stage of a rig whose camera stands where it was, frame by frame.
#include "host/apps/playback/data_set_playback.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>
#include <random>

#include "host/core/pipeline/depth_stage.hpp"
#include "tests/support/data_set/written_data_set.hpp"
#include "tests/support/lens/published_lens.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::Grey;
using testing_support::ScratchFolder;
using testing_support::WrittenDataSet;

constexpr int kFrames = 4;
const std::string kOneSensor = "extends: " OCTOSKIN_SOURCE_DIR "/tests/data/rigs/one-sensor.yaml\n";

/// In a rig file, as wide as this.
std::string camera_text(int width_px) {
    return "{width_px: " + std::to_string(width_px) +
           ", height_px: 480, fx_px: 525, fy_px: 525, cx_px: 250, cy_px: 240, rate_hz: 30, "
           "pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]}}";
}

/// A wall 1.5 to 2.5 m away with holes, of whole millimetres: in every third pixel of every third row, 14 mm
/// apart at most, so that no voxel of 5 cm goes without.
Grey wall(unsigned seed) {
    std::mt19937 random(seed);
    Grey image{640, 480, {}};
    for (unsigned i = 0; i < 640 * 480; ++i) {
        const bool is_hole = i % 640 % 3 != 0 || i / 640 % 3 != 0 || random() % 16 == 0;
        image.values.push_back(static_cast<std::uint16_t>(is_hole ? 0 : 5 * (1'500 + (i / 640) * 2)));
    }
    return image;
}

std::string time_of(int frame) {
    return "1305031102." + std::to_string(100'000 + 33'333 * frame);
}

/// It turns about the vertical and goes sideways.
Eigen::Isometry3d pose_of(int frame) {
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    T_map_camera.translation() = Eigen::Vector3d(0.05 * frame, -0.02 * frame, 1.0);
    T_map_camera.linear() =
        (Eigen::AngleAxisd(0.03 * frame, Eigen::Vector3d::UnitZ()) * Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5))
            .toRotationMatrix();
    return T_map_camera;
}

std::string text_of(const Eigen::Isometry3d& T_map_camera) {
    const Eigen::Quaterniond q(T_map_camera.linear());
    const Eigen::Vector3d p = T_map_camera.translation();
    std::string text;
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) {
        char digits[40];
        std::snprintf(digits, sizeof(digits), "%.17g ", value);
        text += digits;
    }
    return text;
}

std::map<VoxelKey, float> voxels_of(const FusedMap& map) {
    std::map<VoxelKey, float> voxels;
    map.for_each_known([&voxels](VoxelKey key, float log_odds) { voxels[key] = log_odds; });
    return voxels;
}

class DataSetPlayback : public testing::Test {
  protected:
    PlaybackRequest request() const {
        PlaybackRequest request{.recording = RecordingPaths(written_.folder()),
                                .mapping = {},
                                .configuration = "test",
                                .maps = every_feed(),
                                .rig = {},
                                .robot = {}};
        request.mapping.map.resolution_m = 0.05;
        request.mapping.depth_filter.is_enabled = false;  // quicker, and no part of this
        return request;
    }
    Error refused(const PlaybackRequest& request) {
        const auto played = play_recording(request);
        if (played) ADD_FAILURE() << "no error";
        return played ? Error{} : played.error().error;
    }

    ScratchFolder scratch_;
    WrittenDataSet written_{scratch_ / "rgbd_dataset_freiburg1_xyz"};
};

TEST_F(DataSetPlayback, maps_each_image_from_where_the_camera_was) {
    FusedMap expected(request().mapping.map);
    HostRig rig;
    rig.cameras = {HostCamera{}};
    rig.cameras.front().intrinsics = {640, 480, 525.0, 525.0, 320.0, 240.0};
    for (int i = 0; i < kFrames; ++i) {
        written_.add_pose(time_of(i), text_of(pose_of(i)));
        written_.add_image(time_of(i), wall(static_cast<unsigned>(i)));
        DepthFrame frame{HostTime{i}, 640, 480, {}};
        for (const std::uint16_t value : wall(static_cast<unsigned>(i)).values)
            frame.depth_mm.push_back(static_cast<std::uint16_t>(value / 5));
        rig.cameras.front().T_link_camera = pose_of(i);
        MappingConfig mapping = request().mapping;
        mapping.removes_robot_from_depth = false;
        expected.apply(DepthStage(rig, mapping).updates(frame, nullptr)->terms);
    }
    const auto played = play_recording(request());
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_FALSE(failure_of(*played)) << failure_of(*played)->message();
    ASSERT_GT(expected.known_voxels(), 10'000U);
    EXPECT_EQ(played->outcome.progress.depth_frames, std::uint64_t{kFrames});
    EXPECT_EQ(voxels_of(played->pipeline.map(MapFeed::camera)), voxels_of(expected));
    EXPECT_EQ(voxels_of(played->pipeline.map()), voxels_of(expected));
}

/// A plane that leans, 2 m from the camera, as this lens pictures it: in millimetres, every fourth pixel of
/// every fourth row, 65535 elsewhere.
Grey leaning_plane(const testing_support::PublishedCamera& camera, const Eigen::Vector3d& normal) {
    Grey image{640, 480, std::vector<std::uint16_t>(640 * 480, 65'535)};
    for (unsigned v = 0; v < 480; v += 4) {
        for (unsigned u = 0; u < 640; u += 4) {
            const auto [x, y] = testing_support::unproject(camera, u, v);
            image.values[v * 640 + u] =
                static_cast<std::uint16_t>(std::lround(2'000.0 / normal.dot(Eigen::Vector3d(x, y, 1.0))));
        }
    }
    return image;
}

/// How far the furthest occupied voxel's centre is from that plane.
double furthest_m(const FusedMap& map, const Eigen::Vector3d& normal) {
    const VoxelLattice lattice(map.resolution_m());
    double furthest_m = 0.0;
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (log_odds > 0.0F)
            furthest_m = std::max(furthest_m, std::abs(normal.dot(lattice.centre_of(key)) - 2.0));
    });
    return furthest_m;
}

// Oracle: the plane, and OpenCV's published lens.
TEST_F(DataSetPlayback, scale_missing_value_intrinsics_and_lens_are_the_rigs) {
    const auto& camera = testing_support::kTumCameras.at(0);  // freiburg1's colour one, a bare lens
    const Eigen::Vector3d normal = Eigen::Vector3d(0.5, 0.2, 1.0).normalized();
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", leaning_plane(camera, normal));
    const std::string rig = "extends: " OCTOSKIN_SOURCE_DIR
                            "/tests/data/rigs/one-sensor.yaml\ncamera:\n"
                            "  {width_px: 640, height_px: 480, fx_px: 517.3, fy_px: 516.5, cx_px: 319.1, "
                            "cy_px: 255.8, rate_hz: 30,\n   pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]},\n"
                            "   data_set: {depth_units_per_m: 1000, depth_no_value: 65535}";
    PlaybackRequest with_lens = request();
    with_lens.mapping.map.resolution_m = 0.02;
    PlaybackRequest without_lens = with_lens;
    with_lens.rig = scratch_.write(
        "lens.yaml",
        rig + ",\n   distortion: {k1: 0.2624, k2: -0.9531, p1: -0.0054, p2: 0.0026, k3: 1.1633}}\n");
    without_lens.rig = scratch_.write("pinhole.yaml", rig + "}\n");
    const auto played = play_recording(with_lens);
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_EQ(played->pipeline.builder().depth_stage(0).pixels().used, 160U * 120U);
    constexpr double kHalfDiagonalM = 0.0174;  // of a voxel of 2 cm
    EXPECT_LT(furthest_m(played->pipeline.map(MapFeed::camera), normal), kHalfDiagonalM + 0.001);
    const auto bent = play_recording(without_lens);
    ASSERT_TRUE(bent) << bent.error().message();
    EXPECT_GT(furthest_m(bent->pipeline.map(MapFeed::camera), normal), 0.03);
    EXPECT_NE(bent->origin.rig_hash, played->origin.rig_hash);
}

// As fast as it goes, step by step and at its own pace: the same map.
TEST_F(DataSetPlayback, pace_decides_when_an_image_is_mapped_and_not_what_the_map_becomes) {
    for (int i = 0; i < kFrames; ++i) {
        written_.add_pose(time_of(i), text_of(pose_of(i)));
        written_.add_image(time_of(i), wall(static_cast<unsigned>(i)));
    }
    const auto expected = play_recording(request());
    ASSERT_TRUE(expected) << expected.error().message();

    struct Mapped : CommitListener {
        void on_joints(const JointMeasurement&) override {}
        void on_reading(const RangeMeasurement&, const Beam&, std::span<const VoxelUpdate>) override {}
        void on_depth(const DepthFrame&, const Evidence&) override { ++images; }
        int images = 0;
    };
    Mapped mapped;
    std::vector<std::string> shown;
    PlaybackRequest stepped = request();
    stepped.listener = &mapped;
    stepped.pace = Pace::by_step([&](const std::string& what) {
        EXPECT_LE(mapped.images, static_cast<int>(shown.size())) << "mapped before it was shown";
        shown.push_back(what);
    });
    const auto by_step = play_recording(stepped);
    ASSERT_TRUE(by_step) << by_step.error().message();
    EXPECT_EQ(mapped.images, kFrames);
    EXPECT_EQ(shown, (std::vector<std::string>{"depth image 0 of 1305031102.100000000: 640 x 480",
                                               "depth image 1 of 1305031102.133333000: 640 x 480",
                                               "depth image 2 of 1305031102.166666000: 640 x 480",
                                               "depth image 3 of 1305031102.199999000: 640 x 480"}));
    EXPECT_EQ(voxels_of(by_step->pipeline.map(MapFeed::camera)),
              voxels_of(expected->pipeline.map(MapFeed::camera)));

    // 100 ms of images at a quarter of their speed: at least 400 ms, however fast the machine is.
    PlaybackRequest slow = request();
    slow.pace = Pace::times(0.25);
    const auto began = std::chrono::steady_clock::now();
    const auto paced = play_recording(slow);
    EXPECT_GE(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(399));
    ASSERT_TRUE(paced) << paced.error().message();
    EXPECT_EQ(voxels_of(paced->pipeline.map(MapFeed::camera)),
              voxels_of(expected->pipeline.map(MapFeed::camera)));
}

TEST_F(DataSetPlayback, accounts_for_every_image) {
    written_.add_image("99.9", {640, 480, wall(1).values});
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", wall(1));
    written_.add_image("100.000000000", wall(1));  // the same time again
    const auto played = play_recording(request());
    ASSERT_TRUE(played) << played.error().message();
    const CounterTable& images = played->inputs.front();
    EXPECT_EQ(images.in, 3U);
    EXPECT_EQ(images.used, 2U);
    EXPECT_EQ(images.rejected.front().count, 1U);
    EXPECT_EQ(played->pipeline.inputs().depth_frames.front().used(), 1U);
    EXPECT_EQ(played->pipeline.inputs().depth_frames.front().rejected(DepthReason::out_of_order), 1U);
    EXPECT_FALSE(failure_of(*played));
}

TEST_F(DataSetPlayback, accounts_for_every_line_of_both_lists) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_pose("100.01", "nan nan nan nan nan nan nan");
    written_.add_pose("100.02", "0 0 0 0 0 0 1");
    written_.add_pose("100.02", "0 0 0 0 0 0 1");
    written_.add_line("groundtruth.txt", "lost");
    written_.add_image("100", wall(1));
    written_.add_line("depth.txt", "also lost");
    written_.add_image("100.02", wall(2));
    const auto played = play_recording(request());
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_FALSE(failure_of(*played));
    const CounterTable& images = played->inputs.at(0);
    EXPECT_EQ(images.in, 3U);
    EXPECT_EQ(images.used, 2U);
    EXPECT_EQ(images.rejected.at(1).name, "bad_line");
    EXPECT_EQ(images.rejected.at(1).count, 1U);
    const CounterTable& poses = played->inputs.at(1);
    EXPECT_EQ(poses.unit, "camera poses");
    EXPECT_EQ(poses.in, 5U);
    EXPECT_EQ(poses.used, 2U);
    for (const auto& rejected : poses.rejected) EXPECT_EQ(rejected.count, 1U) << rejected.name;
    EXPECT_TRUE(poses.is_balanced);
    EXPECT_THAT(played->warnings, testing::Contains(HasSubstr("groundtruth.txt:8: expected a time")));
    EXPECT_THAT(played->warnings, testing::Contains(HasSubstr("depth.txt:5: expected a time")));
}

/// Where a wall stands that the camera looks at from the origin, and how wide the image of it is.
struct SeenWall {
    double nearest_m;
    double widest_m;
};
SeenWall seen_wall(const Playback& played) {
    const FusedMap& map = played.pipeline.map(MapFeed::camera);
    const VoxelLattice lattice(map.resolution_m());
    SeenWall seen{100.0, 0.0};
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (log_odds <= 0.0F) return;
        seen.nearest_m = std::min(seen.nearest_m, lattice.centre_of(key).z());
        seen.widest_m = std::max(seen.widest_m, lattice.centre_of(key).x());
    });
    return seen;
}

// Each layout's camera sees x from the middle to the image's right edge: 320 pixels at 2 m.
TEST_F(DataSetPlayback, each_layout_has_its_own_camera_scale_and_lists) {
    const Grey fifths{640, 480, std::vector<std::uint16_t>(640 * 480, 10'000)};
    const Grey millimetres{640, 480, std::vector<std::uint16_t>(640 * 480, 2'000)};
    const auto icl = scratch_ / "icl";
    std::filesystem::create_directories(icl / "depth");
    testing_support::write_grey_png(icl / "depth/0.png", fifths);
    std::ofstream(icl / "associations.txt") << "\xEF\xBB\xBF"
                                               "0 depth/0.png 0 rgb/0.png\n";
    std::ofstream(icl / "livingRoom.gt.freiburg") << "0 0 0 0 0 0 0 1\n";
    const auto scenes = scratch_ / "seq-01";
    std::filesystem::create_directories(scenes);
    testing_support::write_grey_png(scenes / "frame-000000.depth.png", millimetres);
    std::ofstream(scenes / "frame-000000.pose.txt") << "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
    written_.add_pose("1.000000000000000000e+00", "0 0 0 0 0 0 1");
    written_.add_image("1.0", fifths);
    std::ofstream(written_.folder() / "calibration.txt") << "1000 1000 319.5 239.5\n";
    struct Layout {
        std::filesystem::path folder;
        double fx;
    };
    for (const Layout& layout :
         {Layout{icl, 481.2}, Layout{scenes, 585.0}, Layout{written_.folder(), 1000.0}}) {
        PlaybackRequest asked = request();
        asked.recording = RecordingPaths(layout.folder);
        asked.mapping.map.resolution_m = 0.01;
        const auto played = play_recording(asked);
        ASSERT_TRUE(played) << played.error().message();
        EXPECT_NEAR(seen_wall(*played).nearest_m, 2.0, 0.011) << layout.folder;
        EXPECT_NEAR(seen_wall(*played).widest_m, 320.0 / layout.fx * 2.0, 0.02) << layout.folder;
    }
}

TEST_F(DataSetPlayback, an_image_that_cannot_be_read_makes_the_map_one_that_must_not_be_used) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", wall(1));
    written_.add_pose("100.03", "0 0 0 0 0 0 1");
    written_.add_image("100.03", wall(2));
    std::filesystem::resize_file(written_.image("100.03"), 5'000);
    const auto played = play_recording(request());
    ASSERT_TRUE(played) << played.error().message();
    ASSERT_TRUE(failure_of(*played));
    EXPECT_EQ(failure_of(*played)->exit, ExitCode::bad_data);
    const Error error = failure_of(*played)->error;
    EXPECT_EQ(error.file, written_.folder() / "depth.txt");
    EXPECT_EQ(error.line, 5);
    EXPECT_EQ(error.key, "depth/100.03.png");
    EXPECT_THAT(error.what, HasSubstr("cannot be read completely"));
    EXPECT_TRUE(played->inputs.front().is_balanced);
}

TEST_F(DataSetPlayback, an_image_of_another_size_than_the_cameras_is_counted_and_the_empty_map_refused) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", {2, 1, {5000, 5000}});
    const auto played = play_recording(request());
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_EQ(played->pipeline.inputs().depth_frames.front().rejected(DepthReason::wrong_size), 1U);
    ASSERT_TRUE(failure_of(*played));
    EXPECT_EQ(failure_of(*played)->error.code, ErrorCode::no_content);
    EXPECT_THAT(failure_of(*played)->error.what, HasSubstr("wrong_size"));
}

TEST_F(DataSetPlayback, what_a_data_set_does_not_have_is_refused) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_line("depth.txt", "100 depth/absent.png");
    PlaybackRequest robot = request();
    robot.robot.urdf = "panda.urdf";
    EXPECT_EQ(refused(robot).code, ErrorCode::bad_argument);
    EXPECT_EQ(refused(robot).key, "--robot");
    PlaybackRequest two = request();
    two.rig = scratch_.write("rig.yaml", kOneSensor + "camera: " + camera_text(512) + "\n");
    two.camera = "freiburg1";
    EXPECT_EQ(refused(two).code, ErrorCode::conflict);
    EXPECT_THAT(refused(two).remedy, HasSubstr("--rig or --camera"));
    PlaybackRequest unknown = request();
    unknown.camera = "freiburg4";
    EXPECT_EQ(refused(unknown).code, ErrorCode::unknown_word);
    EXPECT_EQ(refused(unknown).key, "--camera");
    EXPECT_EQ(refused(unknown).value, "'freiburg4'");
    EXPECT_THAT(refused(unknown).what,
                HasSubstr("kinect, freiburg1, freiburg2, freiburg3, icl_nuim, seven_scenes"));
    const Error absent = refused(request());
    EXPECT_EQ(absent.code, ErrorCode::not_found);
    EXPECT_EQ(absent.file, written_.folder() / "depth.txt");
    EXPECT_EQ(absent.line, 4);
    EXPECT_EQ(absent.key, "depth/absent.png");
}

TEST_F(DataSetPlayback, of_a_rig_with_several_cameras_the_one_that_is_named_is_used) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", wall(1));
    PlaybackRequest named = request();
    named.rig =
        scratch_.write("rig.yaml", kOneSensor + "cameras:\n- {name: left, " + camera_text(640).substr(1) +
                                       "\n- {name: right, " + camera_text(512).substr(1) + "\n");
    EXPECT_EQ(refused(named).code, ErrorCode::bad_argument);
    EXPECT_EQ(refused(named).key, "--camera");
    EXPECT_THAT(refused(named).what, HasSubstr("left, right"));
    EXPECT_THAT(refused(named).remedy, HasSubstr("--camera left"));
    named.camera = "kinect";
    EXPECT_EQ(refused(named).code, ErrorCode::unknown_word);
    EXPECT_EQ(refused(named).value, "'kinect'");
    named.camera = "left";
    const auto of_left = play_recording(named);
    ASSERT_TRUE(of_left) << of_left.error().message();
    EXPECT_EQ(of_left->pipeline.inputs().depth_frames.front().used(), 1U);
    EXPECT_EQ(of_left->rig.cameras.size(), 1U);
    named.camera = "right";
    const auto of_right = play_recording(named);
    ASSERT_TRUE(of_right) << of_right.error().message();
    EXPECT_EQ(of_right->pipeline.inputs().depth_frames.front().rejected(DepthReason::wrong_size), 1U);
}

TEST_F(DataSetPlayback, a_folder_with_a_log_of_the_bus_is_a_recording) {
    EXPECT_TRUE(is_data_set(RecordingPaths(written_.folder())));
    std::ofstream(written_.folder() / "can.log") << "";
    EXPECT_FALSE(is_data_set(RecordingPaths(written_.folder())));
    EXPECT_FALSE(is_data_set(RecordingPaths(scratch_.path())));
}

}  // namespace
}  // namespace octoskin
