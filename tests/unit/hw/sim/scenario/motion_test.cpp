#include "hw/sim/scenario/motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace octoskin::sim {
namespace {

using testing::HasSubstr;

class Motion : public testing::Test {
  protected:
    Motion() {
        for (const char* model : {"ball", "box"})
            solids_.push_back({std::string(model) + "/l/v", model, {}, {}, true});
    }
    ~Motion() override { std::filesystem::remove(file_); }
    Result<std::vector<ModelMotion>, rig::RigError> read(const std::string& text) {
        std::ofstream(file_) << text;
        return read_motion(file_, solids_);
    }
    std::string error(const std::string& places) {
        const auto motion = read("models:\n  - model: ball\n    places: " + places + "\n");
        return motion ? "none" : motion.error().message();
    }

    std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) / "motion_test.motion.yaml";
    std::vector<Solid> solids_;
};

TEST_F(Motion, is_read_with_every_place) {
    const auto motion = read(
        "models:\n  - model: ball\n    places: [{at_s: -1, is_there: false}, {at_s: 2, moves_on: true}, "
        "{at_s: 4, offset_m: [0, 1, -0.5]}]\n");
    ASSERT_TRUE(motion) << motion.error().message();
    ASSERT_EQ(motion->size(), 1U);
    const ModelMotion expected{
        "ball", {{-1, false, {0, 0, 0}, false}, {2, true, {0, 0, 0}, true}, {4, true, {0, 1, -0.5}, false}}};
    EXPECT_EQ(motion->front(), expected);
}

TEST_F(Motion, is_refused_with_file_line_and_reason) {
    EXPECT_THAT(error("[{at_s: 2}, {at_s: 2}]"),
                HasSubstr("motion_test.motion.yaml:3: models[0].places[1].at_s: expected later"));
    for (const char* at_s : {"-601", "601"})
        EXPECT_THAT(error(std::string("[{at_s: ") + at_s + "}]"),
                    HasSubstr("at_s: expected a number from -600 to 600"));
    EXPECT_THAT(error("[{at_s: 2, offset: [0, 0, 0]}]"), HasSubstr("offset"));
    EXPECT_THAT(error("[{at_s: 2, moves_on: true}]"), HasSubstr("needs a next place"));
    EXPECT_THAT(error("[{at_s: 2, moves_on: true}, {at_s: 3, is_there: false}]"),
                HasSubstr("the model is not there"));
    EXPECT_THAT(error("[]"), HasSubstr("at least one place"));
    EXPECT_THAT(error("[{at_s: 2}]\n  - model: cat\n    places: [{at_s: 1}]"),
                HasSubstr("the world has no model 'cat'"));
    EXPECT_THAT(error("[{at_s: 2}]\n  - model: ball\n    places: [{at_s: 1}]"), HasSubstr("comes twice"));
}

}  // namespace
}  // namespace octoskin::sim
