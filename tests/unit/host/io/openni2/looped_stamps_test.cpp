#include "host/io/openni2/looped_stamps.hpp"

#include <gtest/gtest.h>

#include "host/io/openni2/capture_clock.hpp"

namespace octoskin::openni2 {
namespace {

constexpr std::int64_t kPeriodUs = 100'000;
constexpr int kFrames = 20;  ///< of the film

/// Plays it: each round's frames come a period apart, `late_us` late in that round, and a round begins
/// `pause_us` after the newest frame of the one before.
class Film {
  public:
    struct Shown {
        std::optional<std::int64_t> captured_us;
        std::int64_t arrived_us = 0;
    };
    explicit Film(std::int64_t pause_us) : pause_us_(pause_us) {}
    Shown frame(std::int64_t late_us = 0) {
        if (next_ == kFrames) {
            begun_us_ += (kFrames - 1) * kPeriodUs + pause_us_;
            next_ = 0;
        }
        const std::int64_t stamp_us = kPeriodUs * next_++;
        const std::int64_t arrived_us = begun_us_ + stamp_us + late_us;
        return {clock_.captured_us(stamps_.running_us(stamp_us, arrived_us), arrived_us), arrived_us};
    }

  private:
    std::int64_t pause_us_;
    std::int64_t begun_us_ = 700'000'000;
    int next_ = 0;
    LoopedStamps stamps_;
    CaptureClock clock_;
};

TEST(LoopedStamps, leave_a_film_that_is_played_once_as_it_is) {
    LoopedStamps stamps;
    for (const std::int64_t stamp_us : {40'000, 140'000, 240'000, 1'240'000})
        EXPECT_EQ(stamps.running_us(stamp_us, 5'000'000 + stamp_us), stamp_us);
}

TEST(LoopedStamps, no_frame_is_without_a_time_because_the_film_began_anew) {
    for (const std::int64_t pause_us :
         {std::int64_t{1'000}, kPeriodUs, 3 * kPeriodUs, std::int64_t{2'000'000}}) {
        Film film(pause_us);
        for (int i = 0; i < 4; ++i) EXPECT_FALSE(film.frame().captured_us) << "none is believed before five";
        std::int64_t before_us = 0;
        for (int i = 4; i < 10 * kFrames; ++i) {
            const auto [captured_us, arrived_us] = film.frame();
            ASSERT_TRUE(captured_us) << pause_us << " " << i;
            EXPECT_GT(*captured_us, before_us) << pause_us << " " << i;
            EXPECT_NEAR(static_cast<double>(*captured_us), static_cast<double>(arrived_us), 25.0);
            before_us = *captured_us;
        }
    }
}

TEST(LoopedStamps, a_round_that_came_late_leaves_nothing_to_the_next) {
    Film film(kPeriodUs);
    for (int i = 0; i < kFrames; ++i) (void)film.frame();
    for (int i = 0; i < 5 * kFrames; ++i) (void)film.frame(300'000);
    std::optional<std::int64_t> late_us;
    for (int i = 0; i < kFrames; ++i) {
        const auto [captured_us, arrived_us] = film.frame();
        if (captured_us) late_us = arrived_us - *captured_us;
    }
    ASSERT_TRUE(late_us);
    EXPECT_LE(*late_us, 1'000);
}

TEST(LoopedStamps, a_first_frame_that_came_late_leaves_nothing_to_the_next_rounds) {
    Film film(kPeriodUs);
    (void)film.frame(700'000);
    for (int i = 1; i < kFrames; ++i) (void)film.frame();
    for (int i = 0; i < 5 * kFrames; ++i) {
        const auto [captured_us, arrived_us] = film.frame();
        ASSERT_TRUE(captured_us) << i;
        EXPECT_LE(arrived_us - *captured_us, 1'000) << i;
    }
}

}  // namespace
}  // namespace octoskin::openni2
