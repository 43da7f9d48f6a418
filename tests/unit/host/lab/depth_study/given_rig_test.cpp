// The rig of a depth study.
#include <gtest/gtest.h>

#include "host/lab/depth_study/depth_study.hpp"

namespace octoskin::depth_study {
namespace {

AppError refusal_of(const char* rig) {
    const std::filesystem::path hw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
    const auto results = run_depth_study({.scenarios = {hw / "worlds/experiment.scenario.yaml"},
                                          .rig = hw / "rigs" / rig,
                                          .configurations = {"robust"},
                                          .noises = {"kinect"},
                                          .seeds = {0},
                                          .times_s = {1.0}},
                                         [](const std::string&) {});
    EXPECT_FALSE(results);
    return results ? AppError{} : results.error();
}

TEST(DepthStudy, refuses_a_rig_with_several_cameras) {
    const AppError refusal = refusal_of("experiment_two_cameras.yaml");
    EXPECT_EQ(refusal.exit, ExitCode::bad_config);
    EXPECT_EQ(refusal.error.file.filename(), "experiment_two_cameras.yaml");
    EXPECT_EQ(refusal.error.key, "cameras");
    EXPECT_EQ(refusal.error.value, "2 cameras");
    EXPECT_FALSE(refusal.error.remedy.empty());
}

TEST(DepthStudy, refuses_a_rig_without_an_external_camera) {
    EXPECT_EQ(refusal_of("one_board_17.yaml").error.code, ErrorCode::missing_key);
    EXPECT_EQ(refusal_of("experiment_eye_in_hand.yaml").error.code, ErrorCode::missing_key);
}

}  // namespace
}  // namespace octoskin::depth_study
