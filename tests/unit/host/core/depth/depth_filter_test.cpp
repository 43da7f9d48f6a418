#include "host/core/depth/depth_filter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "tests/support/instruction_sets.hpp"

namespace octoskin {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

DepthImage flat_image(std::uint32_t width, std::uint32_t height, float depth_m) {
    return {.width = width, .height = height, .depth_m = std::vector<float>(width * height, depth_m)};
}

float& at(DepthImage& image, std::uint32_t u, std::uint32_t v) {
    return image.depth_m[v * image.width + u];
}

/// As a camera tells it.
float in_whole_mm(float depth_m) {
    return static_cast<float>(std::round(1000.0 * static_cast<double>(depth_m)) / 1000.0);
}

DepthImage filter_depth(DepthImage image, const DepthFilterConfig& config) {
    DepthFilter(config).filter(image);
    return image;
}

/// The filter as its documentation says it, pixel by pixel. The oracle.
float filtered_pixel(const DepthImage& image, int u, int v, const DepthFilterConfig& config) {
    const int reach = static_cast<int>(config.window / 2);
    const float centre =
        image.depth_m[static_cast<std::size_t>(v) * image.width + static_cast<std::size_t>(u)];
    if (std::isnan(centre)) return kNan;
    // Depths are whole millimetres, and half of one is nothing that a gate tells apart.
    const double gate_m = config.gate_m() + 2e-4;
    const double mean_gate_m = config.mean_gate_m() + 2e-4;
    std::vector<float> near;
    for (int row = std::max(0, v - reach);
         row <= std::min<int>(static_cast<int>(image.height) - 1, v + reach); ++row) {
        for (int column = std::max(0, u - reach);
             column <= std::min<int>(static_cast<int>(image.width) - 1, u + reach); ++column) {
            const float value =
                image.depth_m[static_cast<std::size_t>(row) * image.width + static_cast<std::size_t>(column)];
            if (!std::isnan(value) && static_cast<double>(std::fabs(value - centre)) <= gate_m)
                near.push_back(value);
        }
    }
    std::sort(near.begin(), near.end());
    const float median = 0.5F * (near[(near.size() - 1) / 2] + near[near.size() / 2]);
    double sum = 0.0;
    std::uint32_t support = 0;
    for (const float value : near) {
        if (static_cast<double>(std::fabs(value - median)) > mean_gate_m) continue;
        sum += static_cast<double>(value);
        ++support;
    }
    return support > config.min_support ? static_cast<float>(sum / support) : kNan;
}

TEST(DepthFilter, leaves_a_flat_image_as_it_is_up_to_the_border) {
    const DepthImage filtered = filter_depth(flat_image(9, 7, 2.0F), {});
    EXPECT_EQ(filtered.width, 9U);
    EXPECT_EQ(filtered.height, 7U);
    for (const float depth_m : filtered.depth_m) EXPECT_EQ(depth_m, 2.0F);
}

TEST(DepthFilter, keeps_a_step_between_two_surfaces_sharp) {
    DepthImage image = flat_image(10, 6, 2.0F);
    for (std::uint32_t v = 0; v < 6; ++v) {
        for (std::uint32_t u = 5; u < 10; ++u) at(image, u, v) = 2.5F;
    }
    EXPECT_EQ(filter_depth(image, {}).depth_m, image.depth_m);
}

TEST(DepthFilter, drops_a_pixel_that_stands_alone) {
    DepthImage image = flat_image(9, 9, 2.0F);
    at(image, 4, 4) = 1.0F;
    DepthImage filtered = filter_depth(image, {});
    EXPECT_TRUE(std::isnan(at(filtered, 4, 4)));
    EXPECT_EQ(at(filtered, 3, 4), 2.0F);
}

TEST(DepthFilter, needs_more_than_five_values_of_its_window) {
    DepthImage image = flat_image(9, 9, kNan);
    for (std::uint32_t u = 2; u < 7; ++u) at(image, u, 4) = 2.0F;
    EXPECT_TRUE(std::isnan(filter_depth(image, {}).depth_m[4 * 9 + 4]));
    at(image, 4, 5) = 2.0F;
    EXPECT_EQ(filter_depth(image, {}).depth_m[4 * 9 + 4], 2.0F);
}

TEST(DepthFilter, makes_no_value_where_there_was_none) {
    DepthImage image = flat_image(9, 9, 2.0F);
    at(image, 4, 4) = kNan;
    EXPECT_TRUE(std::isnan(filter_depth(image, {}).depth_m[4 * 9 + 4]));
}

TEST(DepthFilter, averages_what_lies_near_the_median) {
    // Sorted 1.94 and 24 x 2.0: all within the gate and within 7.5 cm of the median.
    DepthImage image = flat_image(5, 5, 2.0F);
    at(image, 0, 0) = 1.94F;
    EXPECT_NEAR(filter_depth(image, {}).depth_m[2 * 5 + 2], 2.0 - 0.06 / 25.0, 1e-6);
    // 1.91 is within the gate of the centre (12 cm), not within 7.5 cm of the median.
    at(image, 0, 0) = 1.91F;
    EXPECT_EQ(filter_depth(image, {}).depth_m[2 * 5 + 2], 2.0F);
}

TEST(DepthFilter, takes_images_smaller_than_its_window) {
    EXPECT_EQ(filter_depth(flat_image(3, 2, 2.0F), {}).depth_m, std::vector<float>(6, 2.0F));
    EXPECT_TRUE(std::isnan(filter_depth(flat_image(1, 1, 2.0F), {}).depth_m[0]));
    EXPECT_TRUE(filter_depth(flat_image(0, 0, 2.0F), {}).depth_m.empty());
}

TEST(DepthFilter, a_window_of_one_pixel_and_no_support_changes_nothing) {
    const DepthImage image = flat_image(4, 4, 1.5F);
    EXPECT_EQ(filter_depth(image, {.window = 1, .min_support = 0}).depth_m, image.depth_m);
}

// Oracle: the definition, pixel by pixel, on noisy steps with holes; window sizes 3, 5 and 7.
TEST(DepthFilter, equals_its_definition_on_noisy_images_with_holes) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        std::mt19937 random(seed);
        std::normal_distribution<float> noise(0.0F, 0.03F);
        std::uniform_int_distribution<unsigned> percent(0, 99);
        DepthImage image = flat_image(61, 37, 2.0F);
        for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
            const float surface_m = (i / 7) % 3 == 0 ? 2.15F : 2.0F;
            image.depth_m[i] =
                percent(random) < 20 + 5 * seed ? kNan : in_whole_mm(surface_m + noise(random));
        }
        const DepthFilterConfig config{.window = 3 + 2 * (seed % 3)};
        const DepthImage filtered = filter_depth(image, config);
        for (int v = 0; v < 37; ++v) {
            for (int u = 0; u < 61; ++u) {
                const float expected = filtered_pixel(image, u, v, config);
                const float actual =
                    filtered.depth_m[static_cast<std::size_t>(v) * 61 + static_cast<std::size_t>(u)];
                ASSERT_EQ(std::isnan(actual), std::isnan(expected))
                    << "seed " << seed << " at " << u << "," << v;
                if (std::isnan(expected)) continue;
                ASSERT_NEAR(actual, expected, 1e-6F) << "seed " << seed;
            }
        }
    }
}

/// The same as `filtered_pixel`, in whole numbers of half millimetres, rounded where `filter_row` rounds.
float filtered_bit_for_bit(const DepthImage& image, int u, int v, const DepthFilterConfig& config) {
    const int reach = static_cast<int>(config.window / 2);
    const auto mm_at = [&](int column, int row) -> std::optional<int> {
        const bool is_inside = column >= 0 && row >= 0 && column < static_cast<int>(image.width) &&
                               row < static_cast<int>(image.height);
        if (!is_inside) return std::nullopt;
        const float depth_m =
            image.depth_m[static_cast<std::size_t>(row) * image.width + static_cast<std::size_t>(column)];
        return std::isnan(depth_m) ? std::nullopt
                                   : std::optional(static_cast<int>(std::lround(1000.0F * depth_m)));
    };
    const auto centre = mm_at(u, v);
    if (!centre) return kNan;
    std::vector<int> near;
    for (int row = v - reach; row <= v + reach; ++row) {
        for (int column = u - reach; column <= u + reach; ++column) {
            const auto mm = mm_at(column, row);
            if (mm && std::abs(*mm - *centre) <= 1000.0 * config.gate_m() + 1e-6) near.push_back(*mm);
        }
    }
    std::sort(near.begin(), near.end());
    const int median_mm2 = near[(near.size() - 1) / 2] + near[near.size() / 2];
    int sum = 0;
    std::uint32_t support = 0;
    for (const int mm : near) {
        const int offset = 2 * mm - median_mm2;
        if (std::abs(offset) > 2000.0 * config.mean_gate_m() + 1e-6) continue;
        sum += offset;
        ++support;
    }
    if (support <= config.min_support) return kNan;
    const float mean_mm2 =
        static_cast<float>(median_mm2) + static_cast<float>(sum) / static_cast<float>(support);
    return mean_mm2 / 2000.0F;
}

/// Noise on surfaces with steps and holes, in millimetres, as a camera gives them: differences meet the gates
/// exactly.
DepthImage noisy_image(unsigned seed) {
    std::mt19937 random(seed);
    const auto up_to = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1)); };
    // From no pixel at all to several vectors of any instruction set.
    DepthImage image{.width = seed < 20 ? seed : up_to(150), .height = up_to(23), .depth_m = {}};
    std::normal_distribution<float> noise(0.0F, seed % 3 == 0 ? 0.004F : 0.03F);
    const std::uint32_t holes_percent = up_to(1) == 0 ? 0 : up_to(90);
    const std::uint32_t step_px = 1 + up_to(30);
    for (std::uint32_t v = 0; v < image.height; ++v) {
        for (std::uint32_t u = 0; u < image.width; ++u) {
            const float surface_m = 1.0F + 0.15F * static_cast<float>((u / step_px + v / step_px) % 4);
            image.depth_m.push_back(up_to(99) < holes_percent ? kNan
                                                              : in_whole_mm(surface_m + noise(random)));
        }
    }
    return image;
}

/// The least and the most that a camera may tell, and neighbours as far away as can be: nothing wraps round.
TEST(DepthFilter, keeps_apart_the_nearest_and_the_farthest_depths) {
    for (const double sigma_m : {0.03, 0.5}) {  // a gate of 0.12 m, and the widest
        const DepthFilterConfig config{.window = 3, .sigma_m = sigma_m, .min_support = 3};
        const auto most_m = static_cast<float>((65'535.0 - 1000.0 * config.gate_m()) / 1000.0);
        for (const float depth_m : {0.001F, 0.002F, 32.767F, 32.768F, in_whole_mm(most_m)}) {
            for (const float other_m : {kNan, 0.001F, 32.767F, 32.768F, in_whole_mm(most_m)}) {
                if (std::fabs(other_m - depth_m) <= static_cast<float>(config.gate_m())) continue;
                DepthImage image = flat_image(6, 6, depth_m);
                for (std::uint32_t v = 0; v < 6; ++v) {
                    for (std::uint32_t u = 3; u < 6; ++u) at(image, u, v) = other_m;
                }
                const DepthImage filtered = filter_depth(image, config);
                for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
                    EXPECT_TRUE(filtered.depth_m[i] == image.depth_m[i] ||
                                (std::isnan(filtered.depth_m[i]) && std::isnan(image.depth_m[i])))
                        << filtered.depth_m[i] << " for " << image.depth_m[i] << " beside " << other_m;
                }
            }
        }
        for (const float none_m :
             {0.0F, -1.0F, in_whole_mm(most_m) + 0.001F, 1e9F, std::numeric_limits<float>::infinity()}) {
            for (const float depth_m : filter_depth(flat_image(6, 6, none_m), config).depth_m)
                EXPECT_TRUE(std::isnan(depth_m)) << none_m;
        }
    }
}

// Oracle: `filtered_bit_for_bit`. One filter takes images of all sizes in turn, as a stream may.
TEST(DepthFilter, is_bit_for_bit_the_same_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        for (const std::uint32_t window : {1U, 3U, 5U, 7U}) {
            const DepthFilterConfig config{.window = window, .min_support = window};
            DepthFilter filter(config);
            for (unsigned seed = 0; seed < 40; ++seed) {
                const DepthImage image = noisy_image(seed);
                DepthImage filtered = image;
                filter.filter(filtered);
                ASSERT_EQ(filtered.depth_m.size(), image.depth_m.size());
                for (std::size_t i = 0; i < image.depth_m.size(); ++i) {
                    const auto u = static_cast<int>(i % image.width);
                    const auto v = static_cast<int>(i / image.width);
                    const float expected = filtered_bit_for_bit(image, u, v, config);
                    ASSERT_EQ(std::bit_cast<std::uint32_t>(filtered.depth_m[i]),
                              std::bit_cast<std::uint32_t>(expected))
                        << name << " window " << window << " seed " << seed << " at " << u << "," << v << ": "
                        << filtered.depth_m[i] << " for " << expected;
                }
            }
        }
    });
}

}  // namespace
}  // namespace octoskin
