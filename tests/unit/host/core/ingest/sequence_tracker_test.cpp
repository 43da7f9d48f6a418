#include "host/core/ingest/sequence_tracker.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

constexpr Nanoseconds kSpacing{15'000'000};

/// Reading number `n` of a sensor at 30 Hz: its 6-bit sequence and its capture time.
std::uint8_t sequence_of(std::uint64_t n) {
    return static_cast<std::uint8_t>(n % 64);
}
HostTime time_of(std::uint64_t n) {
    return {static_cast<std::int64_t>(n) * 33'000'000};
}
bool is_fresh(SequenceTracker& tracker, std::uint64_t n) {
    return tracker.observe(sequence_of(n), time_of(n), kSpacing).has_value();
}

TEST(SequenceTracker, sees_no_gap_in_an_unbroken_sequence) {
    SequenceTracker tracker;
    for (std::uint64_t n = 0; n < 500; ++n) {
        EXPECT_TRUE(is_fresh(tracker, n));
    }
    EXPECT_EQ(tracker.gaps(), 0U);
}

TEST(SequenceTracker, counts_every_burst_below_64_exactly) {
    for (std::uint64_t start = 0; start < 64; ++start) {
        for (std::uint64_t lost = 0; lost < 64; ++lost) {
            SequenceTracker tracker;
            EXPECT_TRUE(is_fresh(tracker, start));
            EXPECT_TRUE(is_fresh(tracker, start + 1 + lost));
            EXPECT_EQ(tracker.gaps(), lost);
        }
    }
}

TEST(SequenceTracker, uses_every_late_reading_of_the_window_once_and_takes_it_off_the_gaps) {
    for (std::uint64_t late = 1; late <= 32; ++late) {
        SequenceTracker tracker;
        for (std::uint64_t n = 0; n <= 100; ++n) {
            if (n != 100 - late) {
                ASSERT_TRUE(is_fresh(tracker, n));
            }
        }
        EXPECT_EQ(tracker.gaps(), 1U);
        EXPECT_TRUE(is_fresh(tracker, 100 - late)) << late;
        EXPECT_EQ(tracker.gaps(), 0U);
        EXPECT_EQ(tracker.observe(sequence_of(100 - late), time_of(100 - late), kSpacing).error(),
                  SequenceFault::duplicate);
        EXPECT_TRUE(is_fresh(tracker, 101));
        EXPECT_EQ(tracker.gaps(), 0U);
    }
}

TEST(SequenceTracker, refuses_what_is_older_than_the_window) {
    SequenceTracker tracker;
    for (std::uint64_t n = 0; n <= 100; ++n) {
        if (n != 67) {
            ASSERT_TRUE(is_fresh(tracker, n));
        }
    }
    EXPECT_EQ(tracker.observe(sequence_of(67), time_of(67), kSpacing).error(), SequenceFault::out_of_window);
}

TEST(SequenceTracker, refuses_a_reading_that_came_before_at_every_distance) {
    SequenceTracker tracker;
    for (std::uint64_t n = 0; n <= 100; ++n) {
        ASSERT_TRUE(is_fresh(tracker, n));
    }
    for (std::uint64_t n = 37; n <= 100; ++n) {
        EXPECT_EQ(tracker.observe(sequence_of(n), time_of(n), kSpacing).error(), SequenceFault::duplicate)
            << n;
    }
    EXPECT_EQ(tracker.gaps(), 0U);
}

TEST(SequenceTracker, refuses_readings_whose_windows_would_overlap) {
    SequenceTracker tracker;
    ASSERT_TRUE(tracker.observe(0, {100'000'000}, kSpacing).has_value());
    EXPECT_EQ(tracker.observe(1, {114'999'999}, kSpacing).error(), SequenceFault::too_soon);
    EXPECT_TRUE(tracker.observe(1, {115'000'000}, kSpacing).has_value());
    ASSERT_TRUE(tracker.observe(4, {200'000'000}, kSpacing).has_value());
    EXPECT_EQ(tracker.observe(2, {170'000'001}, kSpacing).error(), SequenceFault::too_soon)
        << "two steps back";
    EXPECT_TRUE(tracker.observe(2, {170'000'000}, kSpacing).has_value());
}

TEST(SequenceTracker, refuses_a_number_farther_ahead_than_the_time_since_allows) {
    for (unsigned ahead = 1; ahead <= 64; ++ahead) {
        SequenceTracker tracker;
        ASSERT_TRUE(tracker.observe(10, {1'000'000'000}, kSpacing).has_value());
        const auto sequence = static_cast<std::uint8_t>((10 + ahead) % 64);
        const HostTime due = HostTime{1'000'000'000} + kSpacing * ahead;
        const auto early = tracker.observe(sequence, due - Nanoseconds{1}, kSpacing);
        ASSERT_FALSE(early.has_value()) << ahead;
        EXPECT_EQ(early.error(), ahead > 32 ? SequenceFault::behind : SequenceFault::too_soon) << ahead;
        const auto in_time = tracker.observe(sequence, due, kSpacing);
        ASSERT_TRUE(in_time.has_value()) << ahead;
        EXPECT_EQ(in_time->left_out, ahead - 1);
    }
}

TEST(SequenceTracker, gives_a_refused_reading_no_number) {
    SequenceTracker tracker;
    ASSERT_TRUE(tracker.observe(0, {100'000'000}, kSpacing).has_value());
    ASSERT_FALSE(tracker.observe(1, {108'000'000}, kSpacing).has_value());
    ASSERT_FALSE(tracker.observe(20, {110'000'000}, kSpacing).has_value());
    EXPECT_TRUE(tracker.observe(1, {133'000'000}, kSpacing).has_value());
    EXPECT_EQ(tracker.gaps(), 0U);
}

TEST(SequenceTracker, counts_no_gap_over_readings_that_came_without_a_known_time) {
    SequenceTracker tracker;
    EXPECT_TRUE(is_fresh(tracker, 0));
    tracker.skip();
    EXPECT_TRUE(is_fresh(tracker, 20));
    EXPECT_EQ(tracker.gaps(), 0U);
    EXPECT_TRUE(is_fresh(tracker, 25));
    EXPECT_EQ(tracker.gaps(), 4U);
    EXPECT_EQ(tracker.observe(sequence_of(0), time_of(0), kSpacing).error(), SequenceFault::duplicate);
}

TEST(SequenceTracker, refuses_an_old_time_with_the_newest_number) {
    SequenceTracker tracker;
    ASSERT_TRUE(tracker.observe(5, {500'000'000}, kSpacing).has_value());
    EXPECT_EQ(tracker.observe(5, {400'000'000}, kSpacing).error(), SequenceFault::out_of_window);
}

}  // namespace
}  // namespace octoskin
