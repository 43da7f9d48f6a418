// Which pixels show without doubt what is there.
#include "host/core/cross_check/certain_pixels.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace octoskin {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kSide = 60;
/// 100 pixels a radian: margins of 1 and 2 pixels.
constexpr CameraIntrinsics kCamera{.width = kSide, .height = kSide, .fx = 100, .fy = 100, .cx = 30, .cy = 30};

DepthImage wall_at(float depth_m) {
    return {.width = kSide, .height = kSide, .depth_m = std::vector<float>(kSide * kSide, depth_m)};
}

std::vector<Certainty> found(const DepthImage& raw, const DepthImage& filtered) {
    std::vector<Certainty> certainty;
    CertainPixels(kCamera, {.surface_margin_rad = 0.01, .clear_margin_rad = 0.02})
        .find(raw, filtered, certainty);
    return certainty;
}

/// Of pixels in the middle row, from column 25 on.
std::vector<int> middle(const std::vector<Certainty>& certainty) {
    std::vector<int> values;
    for (std::size_t u = 25; u < 36; ++u) values.push_back(static_cast<int>(certainty[30 * kSide + u]));
    return values;
}

TEST(CertainPixels, of_a_wall_are_all_but_those_at_the_border) {
    const auto certainty = found(wall_at(2.0F), wall_at(2.0F));
    EXPECT_EQ(certainty[0], Certainty::none);
    EXPECT_EQ(certainty[1 * kSide + 1], Certainty::surface);
    EXPECT_EQ(certainty[2 * kSide + 2], Certainty::clear);
    EXPECT_EQ(middle(certainty), std::vector<int>(11, 2));
}

TEST(CertainPixels, have_a_margin_about_a_pixel_without_a_value_in_either_image) {
    DepthImage hole = wall_at(2.0F);
    hole.depth_m[30 * kSide + 30] = kNone;
    const std::vector<int> expected = {2, 2, 2, 1, 0, 0, 0, 1, 2, 2, 2};
    EXPECT_EQ(middle(found(hole, wall_at(2.0F))), expected);
    EXPECT_EQ(middle(found(wall_at(2.0F), hole)), expected);
}

// 4 sigma are 12 cm.
TEST(CertainPixels, have_a_margin_about_what_the_filter_changed) {
    DepthImage raw = wall_at(2.0F);
    raw.depth_m[30 * kSide + 30] = 1.89F;
    EXPECT_EQ(middle(found(raw, wall_at(2.0F))), std::vector<int>(11, 2));
    raw.depth_m[30 * kSide + 30] = 1.87F;
    EXPECT_EQ(middle(found(raw, wall_at(2.0F))), (std::vector<int>{2, 2, 2, 1, 0, 0, 0, 1, 2, 2, 2}));
}

// The step is between columns 29 and 30: either side of it is doubtful.
TEST(CertainPixels, have_a_margin_about_a_step_and_none_on_a_slope) {
    DepthImage image = wall_at(2.0F);
    for (std::size_t v = 0; v < kSide; ++v)
        for (std::size_t u = 30; u < kSide; ++u) image.depth_m[v * kSide + u] = 2.2F;
    EXPECT_EQ(middle(found(image, image)), (std::vector<int>{2, 2, 1, 0, 0, 0, 0, 1, 2, 2, 2}));
    // A plane at 70 degrees to the optical axis: its inverse depth is linear.
    for (std::size_t v = 0; v < kSide; ++v)
        for (std::size_t u = 0; u < kSide; ++u)
            image.depth_m[v * kSide + u] = 1.0F / (0.5F + 0.9F * (static_cast<float>(u) - 30.0F) / 100.0F);
    EXPECT_EQ(middle(found(image, image)), std::vector<int>(11, 2));
}

}  // namespace
}  // namespace octoskin
