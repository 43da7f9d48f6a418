#include "host/core/depth/depth_denoiser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace octoskin {
namespace {

using Memory = DepthDenoiser::Memory;
using Pixel = DepthDenoiser::Pixel;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint32_t kWidth = 60;
constexpr std::uint32_t kHeight = 40;

CameraIntrinsics camera_of(std::uint32_t width, std::uint32_t height) {
    return {
        .width = width, .height = height, .fx = 365.0, .fy = 365.0, .cx = 0.5 * width, .cy = 0.5 * height};
}

/// Depth of a pixel, metres.
using Scene = std::function<float(std::uint32_t u, std::uint32_t v)>;

DepthImage image_of(const Scene& scene, std::uint32_t width = kWidth, std::uint32_t height = kHeight) {
    DepthImage image{.width = width, .height = height, .depth_m = {}};
    for (std::uint32_t v = 0; v < height; ++v)
        for (std::uint32_t u = 0; u < width; ++u) image.depth_m.push_back(scene(u, v));
    return image;
}

float& at(DepthImage& image, std::uint32_t u, std::uint32_t v) {
    return image.depth_m[v * image.width + u];
}

Scene wall(float depth_m) {
    return [depth_m](std::uint32_t, std::uint32_t) { return depth_m; };
}

/// Images of a still camera, each of which goes into the memory.
class Stream {
  public:
    explicit Stream(const DepthDenoiserConfig& config = {}, unsigned seed = 1)
        : denoiser(config, camera_of(kWidth, kHeight)), random_(seed) {}

    DepthImage next(DepthImage image) {
        denoiser.denoise(image, Memory::used);
        denoiser.keep();
        return image;
    }
    DepthImage next(const Scene& scene, float sigma_m = 0.0F) {
        DepthImage image = image_of(scene);
        std::normal_distribution<float> noise(0.0F, sigma_m);
        if (sigma_m > 0.0F)
            for (float& depth_m : image.depth_m) depth_m += noise(random_);
        return next(std::move(image));
    }
    DepthImage after(int images, const Scene& scene, float sigma_m) {
        for (int i = 1; i < images; ++i) (void)next(scene, sigma_m);
        return next(scene, sigma_m);
    }

    DepthDenoiser denoiser;

  private:
    std::mt19937 random_;
};

struct Errors {
    double mean_m = 0.0;
    double worst_m = 0.0;
    std::size_t missing = 0;
};

/// Of the pixels with a whole window.
Errors errors_of(const DepthImage& image, const Scene& truth) {
    Errors errors;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::uint32_t v = 2; v + 2 < image.height; ++v) {
        for (std::uint32_t u = 2; u + 2 < image.width; ++u) {
            const float depth_m = image.depth_m[v * image.width + u];
            if (std::isnan(depth_m)) {
                ++errors.missing;
                continue;
            }
            const double error_m = static_cast<double>(depth_m) - static_cast<double>(truth(u, v));
            sum += error_m;
            errors.worst_m = std::max(errors.worst_m, std::fabs(error_m));
            ++count;
        }
    }
    errors.mean_m = sum / static_cast<double>(count);
    return errors;
}

/// Root of the mean squared error of a pixel of a wall with a whole window, over streams of several images.
double wall_sigma_m(const DepthDenoiserConfig& config, int images) {
    constexpr unsigned kStreams = 150;
    double squares = 0.0;
    for (unsigned seed = 0; seed < kStreams; ++seed) {
        DepthImage image = Stream(config, seed).after(images, wall(2.0F), 0.03F);
        const double error_m = static_cast<double>(at(image, kWidth / 2, kHeight / 2)) - 2.0;
        squares += error_m * error_m;
    }
    return std::sqrt(squares / kStreams);
}

// 27 x 27 pixels of n images. The pixels that noise alone excludes, 5 to 10 %, make it more.
TEST(DepthDenoiser, averages_a_wall_over_27_x_27_pixels_and_all_images) {
    for (const int images : {1, 10, 50}) {
        const double least_m = 0.03 / (27.0 * std::sqrt(images));
        const double sigma_m = wall_sigma_m({}, images);
        EXPECT_GT(sigma_m, 0.85 * least_m) << images;
        EXPECT_LT(sigma_m, 1.3 * least_m) << images;
    }
}

TEST(DepthDenoiser, gives_the_mean_no_more_weight_than_of_its_largest_count) {
    DepthDenoiserConfig config;
    config.count_max = 4;
    // A running mean that takes a quarter of each value.
    const double least_m = 0.03 / 27.0 * std::sqrt(0.25 / (2.0 - 0.25));
    const double sigma_m = wall_sigma_m(config, 30);
    EXPECT_GT(sigma_m, 0.85 * least_m);
    EXPECT_LT(sigma_m, 1.3 * least_m);
}

// Seen 80 degrees off its normal: 4 m deeper for each metre to the side, and more.
TEST(DepthDenoiser, keeps_the_slope_of_a_plane) {
    for (const double slope : {0.0, 0.3, 1.0, 4.0}) {
        const Scene plane = [slope](std::uint32_t u, std::uint32_t v) {
            return static_cast<float>(1.0 / (0.5 + slope * (0.5 * u - 0.15 * v) / 365.0));
        };
        const Errors exact = errors_of(Stream().next(plane), plane);
        EXPECT_LT(exact.worst_m, 2e-6) << slope;
        EXPECT_EQ(exact.missing, 0U) << slope;
        for (const int images : {1, 10, 50})
            EXPECT_NEAR(errors_of(Stream().after(images, plane, 0.03F), plane).mean_m, 0.0, 0.001)
                << slope << " after " << images;
    }
}

/// Two walls at 2 m and behind it, side by side.
Scene edge(float step_m) {
    return [step_m](std::uint32_t u, std::uint32_t) { return u < kWidth / 2 ? 2.0F : 2.0F + step_m; };
}

TEST(DepthDenoiser, keeps_an_edge_sharp) {
    struct Case {
        float step_m;
        int images;
    };
    // In 20 cm of a first image are less than 7 sigmas: it takes a few images.
    for (const Case& each : {Case{0.5F, 1}, Case{0.5F, 10}, Case{0.2F, 5}, Case{0.2F, 50}}) {
        DepthImage image = Stream().after(each.images, edge(each.step_m), 0.03F);
        for (std::uint32_t v = 0; v < kHeight; ++v) {
            for (std::uint32_t u = 0; u < kWidth; ++u) {
                const float depth_m = at(image, u, v);
                EXPECT_FALSE(depth_m > 2.0F + 0.3F * each.step_m && depth_m < 2.0F + 0.7F * each.step_m)
                    << each.step_m << " after " << each.images << " at " << u << "," << v;
            }
        }
    }
    EXPECT_LT(errors_of(Stream().after(10, edge(0.2F), 0.0F), edge(0.2F)).worst_m, 1e-6);
}

TEST(DepthDenoiser, holds_one_wrong_value_back_and_begins_anew_with_the_second) {
    Stream stream;
    (void)stream.after(10, wall(2.0F), 0.0F);
    DepthImage wrong = image_of(wall(2.0F));
    at(wrong, 20, 10) = 1.0F;
    DepthImage first = stream.next(wrong);
    EXPECT_TRUE(std::isnan(at(first, 20, 10)));
    EXPECT_EQ(at(first, 21, 10), 2.0F) << "nor do its neighbours have any of it";
    EXPECT_EQ(std::ranges::count(stream.denoiser.changes(), 1), 0);
    EXPECT_EQ(stream.denoiser.pixel(20, 10).mean_m, 2.0F);
    EXPECT_EQ(stream.denoiser.pixel(20, 10).count, -10.0F);

    at(wrong, 20, 10) = 0.5F;
    (void)stream.next(wrong);
    EXPECT_EQ(stream.denoiser.pixel(20, 10), (Pixel{.mean_m = 0.5F, .count = 1.0F, .drift = 0.0F}));
    EXPECT_EQ(std::ranges::count(stream.denoiser.changes(), 1), 1);
    EXPECT_EQ(stream.denoiser.changes()[10 * kWidth + 20], 1);
}

TEST(DepthDenoiser, goes_on_with_the_mean_after_a_wrong_value_or_none) {
    for (const float wrong_m : {1.0F, kNan}) {
        Stream stream;
        (void)stream.after(10, wall(2.0F), 0.0F);
        DepthImage wrong = image_of(wall(2.0F));
        at(wrong, 20, 10) = wrong_m;
        DepthImage first = stream.next(wrong);
        EXPECT_TRUE(std::isnan(at(first, 20, 10)));
        DepthImage second = stream.next(wall(2.0F));
        EXPECT_EQ(at(second, 20, 10), 2.0F);
        EXPECT_EQ(stream.denoiser.pixel(20, 10).count, 11.0F);
    }
}

// 5 mm an image, a sixth of the noise: the mean of all would lag by 12 cm in the end.
TEST(DepthDenoiser, follows_a_slow_drift) {
    Stream stream;
    (void)stream.after(20, wall(2.0F), 0.03F);
    for (int i = 1; i <= 50; ++i) {
        const Scene now = wall(2.0F - 0.005F * static_cast<float>(i));
        EXPECT_NEAR(errors_of(stream.next(now, 0.03F), now).mean_m, 0.0, 0.015) << i;
    }
}

// A step of all pixels by one sigma is five of the mean of 25.
TEST(DepthDenoiser, begins_anew_at_once_where_a_surface_has_moved) {
    for (const float step_m : {-0.5F, -0.04F, 0.04F, 0.5F}) {
        Stream stream;
        (void)stream.after(10, wall(2.0F), 0.0F);
        const DepthImage moved = stream.next(edge(step_m));
        for (std::uint32_t v = 0; v < kHeight; ++v) {
            for (std::uint32_t u = 0; u < kWidth; ++u) {
                const bool has_moved = u >= kWidth / 2;
                // Those within two pixels of the edge have both in their window.
                if (u + 3 >= kWidth / 2 && u < kWidth / 2 + 3) continue;
                ASSERT_EQ(stream.denoiser.changes()[v * kWidth + u], has_moved ? 1 : 0) << u;
                ASSERT_EQ(stream.denoiser.pixel(u, v).count, has_moved ? 1.0F : 11.0F) << u;
            }
        }
        EXPECT_NEAR(moved.depth_m[10 * kWidth + 50], 2.0F + step_m, 1e-6F);
    }
}

/// Walls at 2 m and 3 m; between them a column of values 20 cm apart, others in each image.
Scene with_flying_pixels(std::uint32_t image) {
    return [image](std::uint32_t u, std::uint32_t v) {
        if (u == kWidth / 2) return 2.3F + 0.2F * static_cast<float>((v + image) % 3);
        return u < kWidth / 2 ? 2.0F : 3.0F;
    };
}

TEST(DepthDenoiser, drops_values_between_two_surfaces) {
    Stream stream;
    for (std::uint32_t number = 0; number < 12; ++number) {
        DepthImage image = stream.next(with_flying_pixels(number));
        for (std::uint32_t v = 0; v < kHeight; ++v) {
            EXPECT_TRUE(std::isnan(at(image, kWidth / 2, v))) << number << ": " << v;
            EXPECT_NEAR(at(image, kWidth / 2 - 1, v), 2.0F, 1e-6F) << number << ": " << v;
            EXPECT_NEAR(at(image, kWidth / 2 + 1, v), 3.0F, 1e-6F) << number << ": " << v;
        }
    }
}

// support_min is 3: the value itself does not count.
TEST(DepthDenoiser, takes_a_single_pixel_that_shows_the_same_four_times) {
    Stream stream;
    for (int i = 1; i <= 6; ++i) {
        DepthImage image = image_of(wall(kNan));
        at(image, 20, 10) = 1.5F;
        EXPECT_EQ(std::isnan(at(image = stream.next(image), 20, 10)), i < 4) << i;
    }
}

TEST(DepthDenoiser, takes_a_thin_line_in_the_first_image) {
    DepthImage image = image_of([](std::uint32_t u, std::uint32_t) { return u == 20 ? 1.5F : 2.5F; });
    image = Stream().next(image);
    for (std::uint32_t v = 1; v + 1 < kHeight; ++v) EXPECT_NEAR(at(image, 20, v), 1.5F, 1e-6F) << v;
    EXPECT_TRUE(std::isnan(at(image, 20, 0))) << "two neighbours are not enough";
}

TEST(DepthDenoiser, has_no_value_where_there_is_none) {
    Stream stream;
    (void)stream.after(5, wall(2.0F), 0.03F);
    for (const float none_m : {kNan, 0.0F}) {
        const DepthImage image = stream.next(image_of(wall(none_m)));
        EXPECT_TRUE(std::ranges::all_of(image.depth_m, [](float value) { return std::isnan(value); }));
    }
    EXPECT_EQ(stream.denoiser.pixel(3, 3).count, 5.0F) << "and remembers what it had";
}

// An image that is not kept leaves no trace, nor do the places behind it.
TEST(DepthDenoiser, knows_nothing_of_an_image_that_is_not_kept) {
    Stream with;
    Stream without;
    std::mt19937 random(3);
    for (int i = 0; i < 8; ++i) {
        DepthImage other = image_of([&](std::uint32_t, std::uint32_t) {
            return random() % 3 == 0 ? kNan : 1.0F + 0.001F * static_cast<float>(random() % 1000);
        });
        with.denoiser.denoise(other, i % 2 == 0 ? Memory::used : Memory::of_other_place);
        const DepthImage one = with.next(edge(0.5F), 0.03F);
        const DepthImage same = without.next(edge(0.5F), 0.03F);
        ASSERT_TRUE(std::ranges::equal(one.depth_m, same.depth_m, [](float a, float b) {
            return a == b || (std::isnan(a) && std::isnan(b));
        })) << i;
        ASSERT_TRUE(std::ranges::equal(with.denoiser.changes(), without.denoiser.changes())) << i;
    }
}

TEST(DepthDenoiser, compares_an_image_from_another_place_with_nothing_and_replaces_the_memory_with_it) {
    Stream stream;
    (void)stream.after(10, wall(2.0F), 0.0F);
    DepthImage image = image_of(edge(0.02F));
    at(image, 5, 5) = kNan;
    DepthImage denoised = image;
    stream.denoiser.denoise(denoised, Memory::of_other_place);
    EXPECT_NEAR(at(denoised, 50, 10), 2.02F, 1e-6F) << "no mean with the 2 m before";
    EXPECT_EQ(std::ranges::count(stream.denoiser.changes(), 1), 0);
    EXPECT_EQ(stream.denoiser.pixel(50, 10).count, 10.0F) << "not kept yet";
    stream.denoiser.keep();
    EXPECT_EQ(stream.denoiser.pixel(50, 10), (Pixel{.mean_m = 2.02F, .count = 1.0F, .drift = 0.0F}));
    EXPECT_EQ(stream.denoiser.pixel(5, 5), Pixel{});
}

TEST(DepthNoiseLaw, grows_with_the_square_of_the_distance) {
    const DepthNoiseLaw kinect{.constant_m = 0.0012, .quadratic_per_m = 0.0019, .from_m = 0.4};
    EXPECT_DOUBLE_EQ(kinect.sigma_m(0.4), 0.0012);
    EXPECT_DOUBLE_EQ(kinect.sigma_m(2.4), 0.0012 + 0.0019 * 4.0);
    EXPECT_DOUBLE_EQ(DepthNoiseLaw{}.sigma_m(7.0), 0.03);
}

}  // namespace
}  // namespace octoskin
