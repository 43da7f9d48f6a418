#include "host/core/depth/repeated_images.hpp"

#include <gtest/gtest.h>

#include <chrono>

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
        EXPECT_FALSE(images.take(frame(i * 100ms, static_cast<std::uint16_t>(900 + i % 2))));
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
