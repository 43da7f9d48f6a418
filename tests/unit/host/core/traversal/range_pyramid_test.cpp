#include "host/core/traversal/range_pyramid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace octoskin {
namespace {

ProjectedImage image_of(std::uint32_t width, std::uint32_t height, std::mt19937& random) {
    ProjectedImage image;
    image.width = width;
    image.height = height;
    std::uniform_real_distribution<float> reach(-1.0F, 4.0F);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        image.reach_m.push_back(reach(random));
        image.passed_m.push_back(image.reach_m.back() - 0.1F * reach(random));
    }
    return image;
}

RangePyramid::Span least_and_most(const ProjectedImage& image, const PixelBox& box) {
    RangePyramid::Span span;
    for (std::uint32_t v = box.v_first; v <= box.v_last; ++v) {
        for (std::uint32_t u = box.u_first; u <= box.u_last; ++u) {
            span.shortest = std::min(span.shortest, image.passed_m[std::size_t{v} * image.width + u]);
            span.longest = std::max(span.longest, image.reach_m[std::size_t{v} * image.width + u]);
        }
    }
    return span;
}

PixelBox in_whole_blocks(const ProjectedImage& image, PixelBox box) {
    constexpr std::uint32_t kBlock = RangePyramid::kBlock;
    const auto last_of = [](std::uint32_t at, std::uint32_t size) {
        return std::min(at / kBlock * kBlock + kBlock - 1, size - 1);
    };
    return {box.u_first / kBlock * kBlock, last_of(box.u_last, image.width), box.v_first / kBlock * kBlock,
            last_of(box.v_last, image.height)};
}

TEST(RangePyramid, tell_the_least_and_the_most_of_any_box_in_whole_blocks) {
    std::mt19937 random(1);
    RangePyramid windows;
    // Odd and even, larger than the largest windows, and as small as can be.
    for (const auto& [width, height] :
         {std::pair{1U, 1U}, {2U, 3U}, {7U, 5U}, {64U, 53U}, {201U, 96U}, {3U, 150U}}) {
        const ProjectedImage image = image_of(width, height, random);
        windows.take(image);
        for (int i = 0; i < 400; ++i) {
            const auto [u_first, u_last] = std::minmax({random() % width, random() % width});
            const auto [v_first, v_last] = std::minmax({random() % height, random() % height});
            const PixelBox box{static_cast<std::uint32_t>(u_first), static_cast<std::uint32_t>(u_last),
                               static_cast<std::uint32_t>(v_first), static_cast<std::uint32_t>(v_last)};
            const auto expected = least_and_most(image, in_whole_blocks(image, box));
            const auto span = windows.of(box);
            ASSERT_EQ(span.shortest, expected.shortest) << width << " x " << height;
            ASSERT_EQ(span.longest, expected.longest) << width << " x " << height;
        }
    }
}

TEST(RangePyramid, of_each_level_begin_at_every_block_and_end_with_the_image) {
    std::mt19937 random(2);
    const ProjectedImage image = image_of(37, 22, random);
    RangePyramid windows;
    windows.take(image);
    ASSERT_EQ(windows.columns(), 19U);
    ASSERT_EQ(windows.rows(), 11U);
    for (std::uint32_t k = 0; k < RangePyramid::kLevels; ++k) {
        const std::uint32_t edge = RangePyramid::kBlock << k;
        for (std::uint32_t row = 0; row < windows.rows(); ++row) {
            for (std::uint32_t column = 0; column < windows.columns(); ++column) {
                const std::uint32_t u = RangePyramid::kBlock * column;
                const std::uint32_t v = RangePyramid::kBlock * row;
                const auto expected = least_and_most(
                    image, {u, std::min(u + edge, image.width) - 1, v, std::min(v + edge, image.height) - 1});
                const std::size_t at = std::size_t{row} * windows.columns() + column;
                ASSERT_EQ(windows.level(k).shortest[at], expected.shortest) << k;
                ASSERT_EQ(windows.level(k).longest[at], expected.longest) << k;
            }
        }
    }
}

}  // namespace
}  // namespace octoskin
