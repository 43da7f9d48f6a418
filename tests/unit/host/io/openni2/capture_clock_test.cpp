#include "host/io/openni2/capture_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin::openni2 {
namespace {

TEST(CaptureClock, is_the_arrival_at_first) {
    CaptureClock clock;
    EXPECT_EQ(clock.captured_us(500, 1'000'000), 1'000'000);
}

TEST(CaptureClock, settles_on_the_quickest_and_is_never_later_than_the_arrival) {
    std::mt19937_64 random(3);
    std::exponential_distribution<double> delay_us(1.0 / 3'000.0);
    for (const double ppm : {-100.0, 0.0, 100.0}) {
        CaptureClock clock;
        std::int64_t worst = 0;
        for (int i = 0; i < 30 * 60; ++i) {  // a minute at 30 Hz; a frame takes 2 ms and more
            const std::int64_t true_us = 33'333LL * i;
            const auto stamp_us =
                static_cast<std::int64_t>(static_cast<double>(true_us) * (1.0 + ppm * 1e-6));
            const std::int64_t arrived_us =
                10'000'000'000 + true_us + 2'000 + static_cast<std::int64_t>(delay_us(random));
            const std::int64_t captured_us = clock.captured_us(stamp_us, arrived_us);
            ASSERT_LE(captured_us, arrived_us);
            if (i > 150) worst = std::max(worst, std::abs(captured_us - (10'000'000'000 + true_us + 2'000)));
        }
        EXPECT_LE(worst, 1'500) << ppm << " ppm";  // 100 ppm over two windows is 1 ms
    }
}

TEST(CaptureClock, begins_anew_when_the_camera_does) {
    CaptureClock clock;
    (void)clock.captured_us(9'000'000, 20'000'000);
    EXPECT_EQ(clock.captured_us(0, 21'000'000), 21'000'000);  // its count began again
    EXPECT_EQ(clock.captured_us(33'000, 21'040'000), 21'033'000);
    EXPECT_EQ(clock.captured_us(90'000'000, 21'080'000), 21'080'000);  // or jumped ahead
}

}  // namespace
}  // namespace octoskin::openni2
