#include "hw/sim/scenario/motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/errors/error_fields.hpp"

namespace octoskin::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::value_is;
using testing_support::what_is;

class Motion : public testing::Test {
  protected:
    Motion() {
        for (const char* model : {"ball", "box"})
            solids_.push_back({std::string(model) + "/l/v", model, {}, {}, true});
    }
    ~Motion() override { std::filesystem::remove(file_); }
    Result<std::vector<ModelMotion>, Error> read(const std::string& text) {
        std::ofstream(file_) << text;
        return read_motion(file_, solids_);
    }
    Error error(const std::string& places) {
        return error_in(read("models:\n  - model: ball\n    places: " + places + "\n"));
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
    const Error later = error("[{at_s: 2}, {at_s: 2}]");
    EXPECT_THAT(later, AllOf(code_is(ErrorCode::out_of_range), file_is("motion_test.motion.yaml"), line_is(3),
                             key_is("models[0].places[1].at_s"), value_is("2")));
    EXPECT_TRUE(has_its_fields(later));
    for (const char* at_s : {"-601", "601"})
        EXPECT_THAT(error(std::string("[{at_s: ") + at_s + "}]"),
                    AllOf(code_is(ErrorCode::out_of_range), key_is("models[0].places[0].at_s"),
                          what_is(HasSubstr("from -600 to 600"))));
    EXPECT_THAT(error("[{at_s: 2, offset: [0, 0, 0]}]"),
                AllOf(code_is(ErrorCode::unknown_key), key_is("models[0].places[0].offset")));
    EXPECT_THAT(error("[{at_s: 2, moves_on: true}]"),
                AllOf(code_is(ErrorCode::conflict), what_is(HasSubstr("needs a next place"))));
    EXPECT_THAT(error("[{at_s: 2, moves_on: true}, {at_s: 3, is_there: false}]"),
                AllOf(code_is(ErrorCode::conflict), what_is(HasSubstr("the model is not there"))));
    EXPECT_THAT(error("[]"), AllOf(code_is(ErrorCode::missing_key), key_is("models[0].places")));
    EXPECT_THAT(error("[{at_s: 2}]\n  - model: cat\n    places: [{at_s: 1}]"),
                AllOf(code_is(ErrorCode::unknown_name), key_is("models[1].model"), value_is("'cat'")));
    EXPECT_THAT(error("[{at_s: 2}]\n  - model: ball\n    places: [{at_s: 1}]"),
                AllOf(code_is(ErrorCode::duplicate), value_is("'ball' again")));
}

}  // namespace
}  // namespace octoskin::sim
