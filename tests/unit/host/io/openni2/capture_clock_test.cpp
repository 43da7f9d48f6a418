#include "host/io/openni2/capture_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin::openni2 {
namespace {

/// A camera at 30 Hz whose count began 50 s after the arrivals' did; each frame takes 5 ms, and what it is
/// late.
class Camera {
  public:
    std::optional<std::int64_t> frame(std::int64_t late_us = 0) {
        shown_us_ += 33'333;
        return error_us(clock_.captured_us(shown_us_ - begun_us_, shown_us_ + 5'000 + late_us));
    }
    [[nodiscard]] bool is_lost() const { return clock_.is_lost(); }
    void start_anew() { begun_us_ = shown_us_; }
    void jump_ahead(std::int64_t by_us) { begun_us_ -= by_us; }

  private:
    /// Against the truth, but for the 5 ms that every frame takes.
    [[nodiscard]] std::optional<std::int64_t> error_us(std::optional<std::int64_t> captured_us) const {
        if (!captured_us) return std::nullopt;
        return *captured_us - shown_us_ - 5'000;
    }
    CaptureClock clock_;
    std::int64_t begun_us_ = 50'000'000;
    std::int64_t shown_us_ = 50'000'000;
};

TEST(CaptureClock, believes_no_frame_before_five_agree) {
    Camera camera;
    for (int i = 0; i < 4; ++i) EXPECT_EQ(camera.frame(), std::nullopt) << i;
    for (int i = 0; i < 10; ++i) EXPECT_EQ(camera.frame(), 0) << i;
}

TEST(CaptureClock, is_not_misled_by_a_slow_start) {
    for (const std::int64_t first_us : {50'000, 400'000, 900'000, 5'000'000}) {
        Camera camera;
        for (std::int64_t late_us = first_us; late_us > 0; late_us -= 30'000)
            EXPECT_EQ(camera.frame(late_us).value_or(0), 0) << first_us;
        for (int i = 0; i < 5; ++i) (void)camera.frame();
        for (int i = 0; i < 10; ++i) EXPECT_EQ(camera.frame(), 0) << first_us;
    }
}

/// One frame in two seconds is as quick as can be, and hardly two of the others take alike.
TEST(CaptureClock, takes_the_quickest_of_a_window_where_no_five_agree) {
    Camera camera;
    int without_time = 0;
    for (int i = 0; i < 30 * 30; ++i) {
        const auto error_us = camera.frame(i % 60 == 59 ? 0 : 30'000 + i * 7 % 15 * 30'000);
        without_time += error_us ? 0 : 1;
        EXPECT_EQ(error_us.value_or(0), 0) << i;
    }
    EXPECT_LE(without_time, 165) << "a window of 5 s, and no more";
}

TEST(CaptureClock, gives_no_time_to_a_frame_that_is_very_late_and_the_true_one_to_the_next) {
    Camera camera;
    for (int i = 0; i < 30; ++i) (void)camera.frame();
    for (const std::int64_t late_us : {499'000, 501'000, 700'000, 3'000'000, 6'000'000}) {
        EXPECT_EQ(camera.frame(late_us), late_us < 500'000 ? std::optional<std::int64_t>(0) : std::nullopt);
        EXPECT_EQ(camera.frame(), 0) << late_us;
    }
    // A driver that hung for 2 s and then hands over what waited: each is late by less.
    for (std::int64_t late_us = 2'000'000; late_us > 0; late_us -= 33'333)
        EXPECT_EQ(camera.frame(late_us).value_or(0), 0) << late_us;
}

TEST(CaptureClock, is_lost_after_five_seconds_of_nothing_but_late_frames) {
    Camera camera;
    for (int i = 0; i < 30; ++i) (void)camera.frame();
    EXPECT_FALSE(camera.is_lost());
    int frames = 0;
    for (; !camera.is_lost() && frames < 1'000; ++frames) EXPECT_EQ(camera.frame(600'000), std::nullopt);
    EXPECT_GE(frames, 130);  // the first of them comes 0.63 s after the last timely one
    EXPECT_LE(frames, 133);
}

TEST(CaptureClock, is_not_lost_while_a_timely_frame_comes_now_and_then) {
    Camera camera;
    for (int i = 0; i < 30; ++i) (void)camera.frame();
    for (int i = 0; i < 600; ++i) {
        const bool is_timely = i % 120 == 119;
        EXPECT_EQ(camera.frame(is_timely ? 0 : 600'000).has_value(), is_timely) << i;
        EXPECT_FALSE(camera.is_lost()) << i;
    }
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
            const auto captured_us = clock.captured_us(stamp_us, arrived_us);
            if (!captured_us) {
                ASSERT_LT(i, 10);
                continue;
            }
            ASSERT_LE(*captured_us, arrived_us);
            if (i > 150) worst = std::max(worst, std::abs(*captured_us - (10'000'000'000 + true_us + 2'000)));
        }
        EXPECT_LE(worst, 1'500) << ppm << " ppm";  // 100 ppm over two windows is 1 ms
    }
}

TEST(CaptureClock, begins_anew_when_the_camera_does) {
    Camera camera;
    for (int i = 0; i < 30; ++i) (void)camera.frame();
    camera.start_anew();  // its count began again
    for (int i = 0; i < 4; ++i) EXPECT_EQ(camera.frame(), std::nullopt);
    EXPECT_EQ(camera.frame(), 0);
    camera.jump_ahead(70'000'000);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(camera.frame(), std::nullopt);
    EXPECT_EQ(camera.frame(), 0);
}

}  // namespace
}  // namespace octoskin::openni2
