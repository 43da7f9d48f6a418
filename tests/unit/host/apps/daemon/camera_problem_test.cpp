#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/apps/daemon/status.hpp"

namespace octoskin {
namespace {

constexpr double kRateHz = 20.0;
constexpr Nanoseconds kPeriod{50'000'000};
constexpr Nanoseconds kSecond{1'000'000'000};
constexpr HostTime kBegun{7'000'000'000};

std::string reported(const CameraRecord& camera, Nanoseconds after) {
    const auto problem = camera_problem(camera, kRateHz, kBegun + after);
    return problem ? problem->text : "";
}

CameraRecord looked_for() {
    CameraRecord camera;
    camera.begun = kBegun;
    camera.why = "not opened yet";
    return camera;
}

TEST(CameraProblem, is_that_it_was_never_opened) {
    const CameraRecord camera = looked_for();
    EXPECT_EQ(reported(camera, kSecond), "camera: not opened yet");
    EXPECT_EQ(reported(camera, 6 * kSecond), "camera: no frame has come yet: not opened yet");
}

TEST(CameraProblem, is_that_it_opens_and_never_shows_anything_however_often) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    EXPECT_EQ(reported(camera, 4 * kSecond), "") << "it may just need time";
    EXPECT_EQ(reported(camera, 6 * kSecond), "camera: no frame has come yet, and it is open");
    const auto open = camera_problem(camera, kRateHz, kBegun + 6 * kSecond);
    camera.is_open = false;
    camera.why = "no data in time";
    EXPECT_EQ(reported(camera, 7 * kSecond), "camera: no frame has come yet: no data in time");
    EXPECT_EQ(camera_problem(camera, kRateHz, kBegun + 7 * kSecond)->about, open->about)
        << "the same problem";
}

TEST(CameraProblem, is_that_no_frame_has_a_time) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.frames = camera.untimed = 90;
    EXPECT_EQ(reported(camera, 6 * kSecond),
              "camera: 90 frames came, none with a known capture time, and it is open");
}

TEST(CameraProblem, is_that_frames_have_no_time_any_more_while_they_come) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 6 * kSecond;
    camera.newest_untimed = kBegun + 9 * kSecond;
    EXPECT_THAT(reported(camera, 9 * kSecond + 3 * kPeriod),
                testing::StartsWith("camera: frames come, but none for three"));
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod + Nanoseconds{1}),
              "camera: no frame for three periods");
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), "");
}

TEST(CameraProblem, is_that_it_shows_one_image_again_and_again) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 6 * kSecond;
    camera.newest_repeated = kBegun + 9 * kSecond;
    const auto problem = camera_problem(camera, kRateHz, kBegun + 9 * kSecond + 3 * kPeriod);
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->about, "camera repeats");
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), "");
    camera.repeats_often = true;
    const auto still = camera_problem(camera, kRateHz, kBegun + 9 * kSecond + 3 * kPeriod);
    ASSERT_TRUE(still) << "one that differs now and then ends nothing";
    EXPECT_EQ(still->about, problem->about);
    camera.newest = kBegun + 11 * kSecond;
    EXPECT_EQ(reported(camera, 11 * kSecond), "") << "none for long";
}

TEST(CameraProblem, is_that_it_fell_silent_and_nothing_while_it_is_well) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), "");
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod + Nanoseconds{1}),
              "camera: no frame for three periods");
    camera.is_open = false;
    camera.why = "gone";
    EXPECT_EQ(reported(camera, 9 * kSecond), "camera: gone");
}

TEST(CameraProblem, is_no_silence_of_one_that_is_as_slow_as_its_mode) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.rate_hz = 5.0;
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + Nanoseconds{600'000'000}), "");
    EXPECT_EQ(reported(camera, 9 * kSecond + Nanoseconds{600'000'001}), "camera: no frame for three periods");
    camera.rate_hz = 40.0;
    EXPECT_EQ(reported(camera, 9 * kSecond + Nanoseconds{75'000'000}), "");
    EXPECT_NE(reported(camera, 9 * kSecond + Nanoseconds{75'000'001}), "");
}

TEST(CameraProblem, is_a_mode_of_a_rate_far_off_the_rigs) {
    CameraRecord camera = looked_for();
    EXPECT_FALSE(camera_rate_problem(camera, kRateHz)) << "not told";
    for (const double near : {14.0, 20.0, 25.0, 30.0}) {
        camera.rate_hz = near;
        EXPECT_FALSE(camera_rate_problem(camera, kRateHz)) << near;
    }
    for (const double far : {10.0, 13.0, 31.0, 60.0}) {
        camera.rate_hz = far;
        EXPECT_TRUE(camera_rate_problem(camera, kRateHz)) << far;
    }
    camera.rate_hz = 10.0;
    EXPECT_EQ(camera_rate_problem(camera, 30.0)
                  ->text.find("camera: its mode of the rig's size has 10 frames a "
                              "second, the rig 30: "),
              0U);
}

}  // namespace
}  // namespace octoskin
