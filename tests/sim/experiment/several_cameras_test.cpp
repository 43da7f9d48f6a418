// A rig with several depth cameras: each has its own images, at its own rate and with its own noise, and the
// first one those that it has without the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <set>
#include <tuple>
#include <vector>

#include "hw/sim/experiment/experiment.hpp"
#include "hw/sim/experiment/rig_camera.hpp"

namespace octoskin::sim {
namespace {

const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
constexpr std::uint64_t kSeed = 3;

/// Of an eighth of the pixels a side, so that images cost nothing.
rig::Camera small(rig::Camera camera) {
    camera.width /= 8;
    camera.height /= 8;
    for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value /= 8.0;
    return camera;
}

class SeveralCameras : public ::testing::Test {
  protected:
    SeveralCameras() {
        for (rig::Camera& camera : rig_.cameras) camera = small(camera);
        scenario_.rest_s = 1.0;
        scenario_.motion.tick_rate_hz = 300.0;  // one revolution in a second
    }

    [[nodiscard]] std::vector<CameraImage> images_of(const std::vector<rig::Camera>& cameras,
                                                     bool is_noise_free = false) const {
        rig::Rig rig = rig_;
        rig.cameras = cameras;
        const ExperimentInput input{.rig = rig,
                                    .body = body_,
                                    .world = world_,
                                    .arm = arm_,
                                    .scenario = scenario_,
                                    .seed = kSeed,
                                    .is_depth_noise_free = is_noise_free};
        std::vector<CameraImage> images;
        const ExperimentOutput output{
            .on_frame = [](const wire::CanFrame&, WallTime) {},
            .on_depth = [&](CameraImage image) { images.push_back(std::move(image)); },
            .on_progress = {}};
        const auto summary = run_experiment(input, output);
        EXPECT_TRUE(summary);
        EXPECT_EQ(summary ? summary->depth_frames : 0U, images.size());
        return images;
    }

    static std::vector<CameraImage> images_by(std::size_t camera, const std::vector<CameraImage>& all) {
        std::vector<CameraImage> images;
        std::ranges::copy_if(all, std::back_inserter(images),
                             [=](const CameraImage& image) { return image.camera == camera; });
        return images;
    }

    rig::Rig rig_ = rig::read_rig(kHw / "rigs/experiment_two_cameras.yaml").value();
    Scenario scenario_ = read_scenario(kHw / "worlds/experiment.scenario.yaml").value();
    World world_ = World::read(scenario_.world).value();
    Arm arm_ = Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()).value();
    Body body_{rig::read_capsules(rig_.urdf, {}).value()};
};

TEST_F(SeveralCameras, give_their_images_in_the_order_of_capture_each_at_its_own_rate) {
    ASSERT_EQ(rig_.cameras.size(), 2U);
    rig_.cameras[1].rate_hz = 7.0;
    const auto all = images_of(rig_.cameras);
    const auto order = [](const CameraImage& image) { return std::tuple(image.captured.ns, image.camera); };
    EXPECT_TRUE(std::ranges::is_sorted(all, std::ranges::less(), order));
    // Two before START, and the first at START.
    const auto first = images_by(0, all);
    const auto second = images_by(1, all);
    EXPECT_EQ(first.size(), 2U + 10U);
    EXPECT_EQ(second.size(), 2U + 7U);
    EXPECT_EQ(first[2].captured, second[2].captured) << "at START";
    for (std::size_t i = 1; i < first.size(); ++i)
        EXPECT_EQ((first[i].captured - first[i - 1].captured).count(), 100'000'000);
    for (std::size_t i = 1; i < second.size(); ++i)
        EXPECT_NEAR(static_cast<double>((second[i].captured - second[i - 1].captured).count()), 1e9 / 7.0,
                    1001.0);
}

void expect_equal(const std::vector<CameraImage>& images, const std::vector<CameraImage>& others) {
    ASSERT_EQ(images.size(), others.size());
    for (std::size_t i = 0; i < images.size(); ++i) {
        EXPECT_EQ(images[i].captured, others[i].captured);
        EXPECT_EQ(images[i].width, others[i].width);
        EXPECT_EQ(images[i].height, others[i].height);
        EXPECT_TRUE(images[i].depth_mm == others[i].depth_mm) << "image " << i;
    }
}

TEST_F(SeveralCameras, leave_the_images_of_the_first_as_they_are_without_the_others) {
    const rig::Rig single = rig::read_rig(kHw / "rigs/experiment.yaml").value();
    const auto alone = images_of({small(single.cameras.at(0))});
    const auto all = images_of(rig_.cameras);
    expect_equal(images_by(0, all), alone);
    EXPECT_FALSE(images_by(1, all).empty());
}

TEST_F(SeveralCameras, have_noise_of_their_own) {
    const std::vector<rig::Camera> twice{rig_.cameras[0], rig_.cameras[0]};
    const auto clean = images_of(twice, true);
    expect_equal(images_by(0, clean), images_by(1, clean));
    const auto noisy = images_of(twice);
    const auto first = images_by(0, noisy);
    const auto second = images_by(1, noisy);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_FALSE(first[i].depth_mm == second[i].depth_mm) << "image " << i;
}

TEST_F(SeveralCameras, see_from_where_they_are) {
    std::vector<rig::Camera> cameras = rig_.cameras;
    cameras[1] = small(rig::read_rig(kHw / "rigs/experiment_eye_in_hand.yaml").value().cameras.at(0));
    ASSERT_FALSE(cameras[1].link.empty());
    const auto moved = images_by(1, images_of(cameras, true));
    const auto still = images_by(1, images_of(rig_.cameras, true));
    ASSERT_EQ(moved.size(), still.size());
    EXPECT_FALSE(moved[2].depth_mm == moved[6].depth_mm) << "the camera on the flange moves";
    EXPECT_FALSE(still[2].depth_mm == moved[2].depth_mm);
}

TEST(NoiseSeed, is_the_seed_for_the_first_camera_and_another_for_each_other) {
    std::set<std::uint64_t> seeds;
    for (const std::uint64_t seed : {0U, 1U, 2U}) {
        EXPECT_EQ(noise_seed_of(seed, 0), seed);
        for (std::size_t camera = 0; camera < rig::kCamerasMax; ++camera)
            seeds.insert(noise_seed_of(seed, camera));
    }
    EXPECT_EQ(seeds.size(), 3U * rig::kCamerasMax);
}

}  // namespace
}  // namespace octoskin::sim
