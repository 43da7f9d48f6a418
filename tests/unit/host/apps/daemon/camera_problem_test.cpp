#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "host/apps/daemon/status.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin {
namespace {

using test::expect_parts_in_text;
using test::is_problem;
using test::key_is;
using test::remedy_has;
using test::what_has;
using testing::AllOf;
using testing::Optional;

constexpr double kRateHz = 20.0;
constexpr Nanoseconds kPeriod{50'000'000};
constexpr Nanoseconds kSecond{1'000'000'000};
constexpr HostTime kBegun{7'000'000'000};

std::optional<Problem> reported(const CameraRecord& camera, Nanoseconds after) {
    auto problem = camera_problem(camera, kRateHz, kBegun + after);
    if (problem) expect_parts_in_text(*problem);
    return problem;
}

/// A problem of this code of the camera, whose condition contains `part`.
auto is_of_camera(ProblemCode code, const std::string& part = {}) {
    return Optional(is_problem(code, "camera", part));
}

CameraRecord looked_for() {
    CameraRecord camera;
    camera.begun = kBegun;
    camera.why = "not opened yet";
    return camera;
}

TEST(CameraProblem, is_that_it_was_never_opened) {
    const CameraRecord camera = looked_for();
    EXPECT_THAT(reported(camera, kSecond), is_of_camera(ProblemCode::camera_closed, "not opened yet"));
    EXPECT_THAT(reported(camera, 6 * kSecond), is_of_camera(ProblemCode::camera_no_frames, "not opened yet"));
}

TEST(CameraProblem, has_the_remedy_while_it_is_not_open) {
    CameraRecord camera = looked_for();
    camera.why = "ros:/depth: no program feeds it";
    camera.remedy = "start the program";
    for (const Nanoseconds after : {kSecond, 6 * kSecond})
        EXPECT_THAT(reported(camera, after),
                    Optional(AllOf(what_has("ros:/depth"), remedy_has("start the program"))));
    camera.is_open = true;
    const auto open = reported(camera, 6 * kSecond);
    ASSERT_TRUE(open);
    EXPECT_EQ(open->remedy, "");
}

TEST(CameraProblem, is_that_it_opens_and_never_shows_anything_however_often) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    EXPECT_EQ(reported(camera, 4 * kSecond), std::nullopt) << "it may just need time";
    const auto open = reported(camera, 6 * kSecond);
    EXPECT_THAT(open, is_of_camera(ProblemCode::camera_no_frames, "it is open"));
    camera.is_open = false;
    camera.why = "no data in time";
    const auto closed = reported(camera, 7 * kSecond);
    EXPECT_THAT(closed, is_of_camera(ProblemCode::camera_no_frames, "no data in time"));
    ASSERT_TRUE(open && closed);
    EXPECT_TRUE(closed->is_same(*open));
}

TEST(CameraProblem, is_that_no_frame_has_a_time) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.frames = camera.untimed = 90;
    EXPECT_THAT(reported(camera, 6 * kSecond),
                Optional(AllOf(is_problem(ProblemCode::camera_no_frames, "camera", "90 frames"),
                               what_has("it is open"))));
}

TEST(CameraProblem, is_that_frames_have_no_time_any_more_while_they_come) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 6 * kSecond;
    camera.newest_untimed = kBegun + 9 * kSecond;
    EXPECT_THAT(reported(camera, 9 * kSecond + 3 * kPeriod), is_of_camera(ProblemCode::camera_untimed));
    EXPECT_THAT(reported(camera, 9 * kSecond + 3 * kPeriod + Nanoseconds{1}),
                is_of_camera(ProblemCode::camera_silent));
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), std::nullopt);
}

TEST(CameraProblem, is_that_it_shows_one_image_again_and_again) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 6 * kSecond;
    camera.newest_repeated = kBegun + 9 * kSecond;
    const auto problem = reported(camera, 9 * kSecond + 3 * kPeriod);
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->code, ProblemCode::camera_repeats);
    EXPECT_EQ(problem->key, "repeated");
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), std::nullopt);
    camera.repeats_often = true;
    const auto still = reported(camera, 9 * kSecond + 3 * kPeriod);
    ASSERT_TRUE(still) << "one that differs now and then ends nothing";
    EXPECT_TRUE(still->is_same(*problem));
    camera.newest = kBegun + 11 * kSecond;
    EXPECT_EQ(reported(camera, 11 * kSecond), std::nullopt) << "none for long";
}

TEST(CameraProblem, is_that_it_fell_silent_and_nothing_while_it_is_well) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + 3 * kPeriod), std::nullopt);
    EXPECT_THAT(reported(camera, 9 * kSecond + 3 * kPeriod + Nanoseconds{1}),
                is_of_camera(ProblemCode::camera_silent));
    camera.is_open = false;
    camera.why = "gone";
    EXPECT_THAT(reported(camera, 9 * kSecond), is_of_camera(ProblemCode::camera_closed, "gone"));
}

TEST(CameraProblem, is_no_silence_of_one_that_is_as_slow_as_its_mode) {
    CameraRecord camera = looked_for();
    camera.is_open = true;
    camera.rate_hz = 5.0;
    camera.newest = kBegun + 9 * kSecond;
    EXPECT_EQ(reported(camera, 9 * kSecond + Nanoseconds{600'000'000}), std::nullopt);
    EXPECT_THAT(reported(camera, 9 * kSecond + Nanoseconds{600'000'001}),
                is_of_camera(ProblemCode::camera_silent));
    camera.rate_hz = 40.0;
    EXPECT_EQ(reported(camera, 9 * kSecond + Nanoseconds{75'000'000}), std::nullopt);
    EXPECT_NE(reported(camera, 9 * kSecond + Nanoseconds{75'000'001}), std::nullopt);
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
    const auto slow = camera_rate_problem(camera, 30.0);
    ASSERT_TRUE(slow);
    expect_parts_in_text(*slow);
    EXPECT_THAT(*slow, AllOf(is_problem(ProblemCode::camera_rate, "camera", "10 frames a second, the rig 30"),
                             key_is("camera.rate_hz"), remedy_has("`octoskin cameras`")));
}

}  // namespace
}  // namespace octoskin
