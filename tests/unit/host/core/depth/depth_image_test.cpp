#include "host/core/depth/depth_image.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octoskin {
namespace {

DepthFrame frame_of(std::uint32_t width, std::uint32_t height, std::vector<std::uint16_t> depth_mm) {
    return {.captured = {}, .width = width, .height = height, .depth_mm = std::move(depth_mm)};
}

TEST(DepthImage, keeps_both_ends_of_the_range_and_nothing_beyond) {
    const auto image = to_depth_image(frame_of(3, 2, {499, 500, 1234, 4500, 4501, 65535}), {0.5, 4.5});
    ASSERT_TRUE(image.has_value());
    EXPECT_EQ(image->width, 3U);
    EXPECT_EQ(image->height, 2U);
    ASSERT_EQ(image->depth_m.size(), 6U);
    EXPECT_TRUE(std::isnan(image->depth_m[0]));
    EXPECT_EQ(image->depth_m[1], 0.5F);
    EXPECT_EQ(image->depth_m[2], 1.234F);
    EXPECT_EQ(image->depth_m[3], 4.5F);
    EXPECT_TRUE(std::isnan(image->depth_m[4]));
    EXPECT_TRUE(std::isnan(image->depth_m[5]));
}

TEST(DepthImage, never_takes_zero_for_a_measurement) {
    const auto image = to_depth_image(frame_of(2, 1, {0, 1}), {0.0, 4.5});
    ASSERT_TRUE(image.has_value());
    EXPECT_TRUE(std::isnan(image->depth_m[0]));
    EXPECT_EQ(image->depth_m[1], 0.001F);
}

TEST(DepthImage, refuses_a_frame_whose_size_is_not_what_it_says) {
    EXPECT_EQ(to_depth_image(frame_of(2, 2, {1, 2, 3}), {}).error(), DepthFrameFault::size_differs);
    EXPECT_EQ(to_depth_image(frame_of(2, 2, {1, 2, 3, 4, 5}), {}).error(), DepthFrameFault::size_differs);
    EXPECT_EQ(to_depth_image(frame_of(65536, 65536, {}), {}).error(), DepthFrameFault::size_differs);
    EXPECT_EQ(to_depth_image(frame_of(0, 2, {}), {}).error(), DepthFrameFault::empty);
    EXPECT_EQ(to_depth_image(frame_of(2, 0, {}), {}).error(), DepthFrameFault::empty);
}

}  // namespace
}  // namespace octoskin
