#include "host/core/depth/repeated_images.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

using namespace std::chrono_literals;

DepthFrame frame(Nanoseconds captured, std::uint16_t mm) {
    return {HostTime{captured.count()}, 2, 1, {0, mm}};
}

TEST(RepeatedImages, are_those_that_equal_more_than_five_before_them_for_over_half_a_second) {
    RepeatedImages images;
    for (int i = 0; i <= 5; ++i) EXPECT_FALSE(images.take(frame(i * 200ms, 900))) << "too few: " << i;
    EXPECT_TRUE(images.take(frame(1200ms, 900)));
    EXPECT_EQ(images.lasted(), 1200ms);
    EXPECT_FALSE(images.take(frame(1300ms, 901)));
    EXPECT_EQ(images.lasted(), 0ms);
    for (int i = 1; i <= 50; ++i)
        EXPECT_FALSE(images.take(frame(1300ms + i * 10ms, 901))) << "too short: " << i;
    EXPECT_TRUE(images.take(frame(1801ms, 901)));
}

TEST(RepeatedImages, are_none_while_a_single_value_changes) {
    RepeatedImages images;
    for (int i = 0; i < 100; ++i)
        EXPECT_FALSE(images.take(frame(i * 100ms, static_cast<std::uint16_t>(900 + i))));
}

// A driver's ring of buffers.
TEST(RepeatedImages, are_those_of_a_ring_of_up_to_sixteen_by_turns) {
    for (const int ring : {2, 3, 4, 8, 16}) {
        RepeatedImages images;
        for (int i = 0; i < 100; ++i) {
            const auto mm = static_cast<std::uint16_t>(900 + i % ring);
            EXPECT_EQ(images.take(frame(i * 100ms, mm)), i >= ring + 5) << ring << ' ' << i;
        }
        EXPECT_EQ(images.lasted(), (100 - ring) * 100ms);
        EXPECT_FALSE(images.take(frame(10s, 1))) << "it goes on";
        EXPECT_FALSE(images.take(frame(11s, 1)));
    }
}

TEST(RepeatedImages, are_none_where_an_image_comes_again_now_and_then) {
    RepeatedImages images;
    for (int i = 0; i < 300; ++i) {
        const auto mm = static_cast<std::uint16_t>(i % 6 == 0 ? 900 + i : 0);  // five of six show nothing
        EXPECT_FALSE(images.take(frame(i * 100ms, mm))) << i;
    }
}

TEST(RepeatedImages, are_found_wherever_they_differ_and_are_none_there) {
    std::vector<std::uint16_t> pixels(11, 900);
    RepeatedImages images;
    for (std::uint64_t i = 0; i < 16 * pixels.size(); ++i) {
        pixels[i % 11] = static_cast<std::uint16_t>(pixels[i % 11] ^ (1U << (i / 11)));
        EXPECT_FALSE(images.take({HostTime{static_cast<std::int64_t>(i) * 100'000'000}, 11, 1, pixels})) << i;
        EXPECT_EQ(images.lasted(), 0ms) << i;
    }
}

TEST(RepeatedImages, go_on_where_a_camera_is_opened_anew_and_last_from_there) {
    RepeatedImages images;
    for (int i = 0; i <= 20; ++i) (void)images.take(frame(i * 100ms, 900));
    EXPECT_EQ(images.lasted(), 2s);
    images.begin_opening();
    EXPECT_EQ(images.lasted(), 0ms);
    EXPECT_TRUE(images.take(frame(4s, 900)));
    EXPECT_EQ(images.lasted(), 0ms);
    EXPECT_TRUE(images.take(frame(5s, 900)));
    EXPECT_EQ(images.lasted(), 1s);
    images.begin_opening();
    EXPECT_FALSE(images.take(frame(8s, 901))) << "it is well again";
}

// Each opening begins with an image of its own, as a sensor that starts gives noise.
TEST(RepeatedImages, are_those_known_from_earlier_openings_whatever_comes_first_in_this_one) {
    RepeatedImages images;
    for (int i = 0; i <= 20; ++i) (void)images.take(frame(i * 100ms, 900));
    int other = 900;
    for (int opening = 1; opening <= 50; ++opening) {
        images.begin_opening();
        for (int i = 0; i < opening; ++i)
            EXPECT_FALSE(images.take(frame(opening * 10s + i * 100ms, static_cast<std::uint16_t>(++other))));
        for (int i = 0; i < 10; ++i)
            EXPECT_TRUE(images.take(frame(opening * 10s + 5s + i * 100ms, 900))) << opening << ' ' << i;
        EXPECT_GE(images.lasted(), 900ms) << opening;
    }
}

TEST(RepeatedImages, are_those_of_a_ring_though_one_in_ten_differs) {
    for (const int ring : {1, 2, 8}) {
        RepeatedImages images;
        int known_used = 0;
        for (int i = 0; i < 1000; ++i) {
            const bool is_new = i % 10 == 9;
            const int mm = is_new ? 2000 + i : 900 + i % ring;
            const bool is_repeated = images.take(frame(i * 33ms, static_cast<std::uint16_t>(mm)));
            EXPECT_FALSE(is_new && is_repeated) << ring << ' ' << i;
            if (!is_new && !is_repeated) ++known_used;
            EXPECT_TRUE(i < 60 || images.are_many()) << ring << ' ' << i;
        }
        EXPECT_LE(known_used, 16) << ring << ": of 0.5 s";
        EXPECT_EQ(images.lasted(), 0ms) << "the last one is new";
        (void)images.take(frame(33s, 900));
        EXPECT_GT(images.lasted(), 30s);
    }
}

TEST(RepeatedImages, are_many_until_as_many_new_ones_came) {
    RepeatedImages images;
    for (int i = 0; i <= 30; ++i) (void)images.take(frame(i * 100ms, 900));
    EXPECT_TRUE(images.are_many());
    for (int i = 1; i <= 12; ++i)
        EXPECT_FALSE(images.take(frame(3s + i * 100ms, static_cast<std::uint16_t>(900 + i))));
    EXPECT_FALSE(images.are_many());
}

TEST(RepeatedImages, are_none_of_a_device_that_gives_each_one_twice) {
    RepeatedImages images;
    for (int i = 0; i < 300; ++i) {
        EXPECT_FALSE(images.take(frame(i * 100ms, static_cast<std::uint16_t>(900 + i / 2)))) << i;
        EXPECT_FALSE(images.are_many()) << i;
        EXPECT_LE(images.lasted(), 100ms) << i;
    }
}

TEST(RepeatedImages, are_none_where_one_in_thirty_equals_one_of_a_second_ago) {
    RepeatedImages images;
    for (int i = 0; i < 600; ++i) {
        const auto mm = static_cast<std::uint16_t>(900 + i - (i % 30 == 29 ? 10 : 0));
        EXPECT_FALSE(images.take(frame(i * 100ms, mm))) << i;
    }
}

// A scene with noise in one pixel of ten: of 64 x 64 pixels.
class Noisy {
  public:
    static constexpr std::size_t kPixels = std::size_t{64} * 64;
    std::vector<std::uint16_t> next() {
        std::vector<std::uint16_t> pixels(kPixels);
        for (std::size_t i = 0; i < kPixels; ++i)
            pixels[i] = static_cast<std::uint16_t>(900 + i % 64 + (random_() % 10 == 0 ? 1 : 0));
        return pixels;
    }

  private:
    std::mt19937 random_{7};
};

bool is_repeated(RepeatedImages& images, Nanoseconds captured, std::vector<std::uint16_t> pixels) {
    return images.take({HostTime{captured.count()}, 64, 64, std::move(pixels)});
}

TEST(RepeatedImages, are_those_of_which_some_pixels_or_half_of_them_differ) {
    Noisy noisy;
    const auto hung = noisy.next();
    RepeatedImages images;
    for (int i = 0; i <= 20; ++i) (void)is_repeated(images, i * 100ms, hung);
    images.begin_opening();
    for (std::size_t i = 0; i < 100; ++i) {
        auto spotted = hung;
        for (std::size_t k = 0; k < 4; ++k)
            spotted[(i * 40 + k) % spotted.size()] = static_cast<std::uint16_t>(i);
        EXPECT_TRUE(is_repeated(images, 5s + i * 100ms, spotted)) << i;
    }
    auto torn = noisy.next();
    std::copy_n(hung.begin(), hung.size() / 2 + 64, torn.begin());
    EXPECT_TRUE(is_repeated(images, 20s, torn));
    std::fill(torn.begin() + static_cast<std::ptrdiff_t>(hung.size() / 2 + 64), torn.end(), std::uint16_t{0});
    EXPECT_TRUE(is_repeated(images, 21s, torn));
    EXPECT_FALSE(is_repeated(images, 22s, noisy.next())) << "it is well again";
}

TEST(RepeatedImages, are_none_of_a_scene_with_noise_whatever_does_not_change) {
    Noisy noisy;
    RepeatedImages images;
    for (int i = 0; i < 300; ++i) {
        auto pixels = noisy.next();  // a sky, filled in, over three quarters, and what gives no return
        std::fill_n(pixels.begin(), Noisy::kPixels / 2, std::uint16_t{10'000});
        std::fill_n(pixels.begin() + Noisy::kPixels / 2, Noisy::kPixels / 4, std::uint16_t{0});
        EXPECT_FALSE(is_repeated(images, i * 100ms, std::move(pixels))) << i;
    }
}

TEST(RepeatedImages, may_be_without_any_value) {
    RepeatedImages images;
    bool is_repeated = false;
    for (int i = 0; i < 10; ++i) is_repeated = images.take(frame(i * 100ms, 0));
    EXPECT_TRUE(is_repeated);
    EXPECT_FALSE(images.has_value());
    EXPECT_FALSE(images.take(frame(2s, 7)));
    EXPECT_TRUE(images.has_value());
}

}  // namespace
}  // namespace octoskin
