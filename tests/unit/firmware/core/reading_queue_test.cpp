#include "firmware/core/reading_queue.hpp"

#include <gtest/gtest.h>

#include <variant>
#include <vector>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr NodeTime kNow{1'000'000};

NodeTime after_ms(std::int64_t ms) {
    return kNow + Microseconds{ms * 1'000};
}

Reading reading_of(std::int16_t range_mm, NodeTime capture = kNow) {
    Reading reading;
    reading.device_status = 9;
    reading.range_mm = range_mm;
    reading.sigma_quarter_mm = 37;
    reading.peak_signal = 500;
    reading.ambient = 6;
    reading.capture = capture;
    return reading;
}

ReadingQueue fd_queue() {
    return {true, 0, kPolicy};
}
ReadingQueue classical_queue(std::uint8_t aux_every = 0) {
    return {false, aux_every, kPolicy};
}

wire::RangeFd front_fd(const ReadingQueue& queue) {
    return std::get<wire::RangeFd>(queue.front());
}
wire::RangeReading front_classical(const ReadingQueue& queue) {
    return std::get<wire::Range>(queue.front()).reading;
}

TEST(ReadingQueue, has_nothing_to_send_when_empty) {
    EXPECT_FALSE(fd_queue().is_ready(kNow));
    EXPECT_FALSE(fd_queue().ready_time().has_value());
}

TEST(ReadingQueue, sends_a_classical_reading_at_once) {
    ReadingQueue queue = classical_queue();
    queue.push(5, reading_of(1'234, {0x40003F}), kNow);
    ASSERT_TRUE(queue.is_ready(kNow));
    const wire::RangeReading sent = front_classical(queue);
    EXPECT_EQ(sent.sensor, 5);
    EXPECT_EQ(sent.device_status, 9);
    EXPECT_EQ(sent.range_mm, 1'234);
    EXPECT_EQ(sent.sigma_quarter_mm, 37);
    EXPECT_EQ(sent.capture, (wire::TimeResidue{.value_us = 0x0, .span_us = 1U << 18U}));
}

TEST(ReadingQueue, lets_a_lone_fd_reading_wait_three_milliseconds_for_company) {
    ReadingQueue queue = fd_queue();
    queue.push(5, reading_of(1'234), kNow);
    EXPECT_FALSE(queue.is_ready(kNow + Microseconds{2'999}));
    EXPECT_TRUE(queue.is_ready(after_ms(3)));
    EXPECT_EQ(queue.ready_time(), after_ms(3));
    EXPECT_EQ(front_fd(queue).count, 1);
}

TEST(ReadingQueue, sends_a_full_fd_frame_at_once_oldest_first) {
    ReadingQueue queue = fd_queue();
    for (std::uint8_t sensor = 0; sensor < 5; ++sensor) queue.push(sensor, reading_of(100), kNow);
    ASSERT_TRUE(queue.is_ready(kNow));
    const wire::RangeFd frame = front_fd(queue);
    ASSERT_EQ(frame.count, 4);
    for (std::uint8_t i = 0; i < 4; ++i) EXPECT_EQ(frame.entries[i].reading.sensor, i);
    EXPECT_EQ(frame.entries[0].signal, (wire::SignalReading{.peak_signal = 500, .ambient = 6}));
    queue.pop();
    EXPECT_EQ(front_fd(queue).count, 1);
    EXPECT_EQ(front_fd(queue).entries[0].reading.sensor, 4);
}

TEST(ReadingQueue, keeps_only_the_newest_reading_of_a_sensor_and_counts_the_others) {
    ReadingQueue queue = classical_queue();
    queue.push(1, reading_of(100), kNow);
    queue.push(2, reading_of(200), kNow);
    queue.push(1, reading_of(101), after_ms(1));
    EXPECT_EQ(queue.losses().displaced, 1U);
    EXPECT_EQ(front_classical(queue).range_mm, 200);
    queue.pop();
    EXPECT_EQ(front_classical(queue).range_mm, 101);
    queue.pop();
    EXPECT_FALSE(queue.ready_time().has_value());
}

TEST(ReadingQueue, holds_a_reading_of_every_sensor_and_counts_what_a_dead_bus_costs) {
    ReadingQueue queue = fd_queue();
    for (int round = 0; round < 3; ++round) {
        for (std::uint8_t sensor = 0; sensor < kNodeSensorsMax; ++sensor) {
            queue.push(sensor, reading_of(100), after_ms(round));
        }
    }
    EXPECT_EQ(queue.losses().displaced, 68U);
    int sent = 0;
    while (queue.ready_time()) {
        sent += front_fd(queue).count;
        queue.pop();
    }
    EXPECT_EQ(sent, 34);
}

TEST(ReadingQueue, drops_and_counts_a_reading_that_waited_more_than_fifty_milliseconds) {
    ReadingQueue queue = classical_queue();
    queue.push(1, reading_of(100), kNow);
    queue.push(2, reading_of(200), after_ms(1));
    queue.drop_late(after_ms(50));
    EXPECT_EQ(front_classical(queue).range_mm, 100);
    queue.drop_late(kNow + Microseconds{50'001});
    EXPECT_EQ(front_classical(queue).range_mm, 200);
    EXPECT_EQ(queue.losses().late, 1U);
    queue.drop_late(after_ms(52));
    EXPECT_EQ(queue.losses().late, 2U);
    EXPECT_FALSE(queue.is_ready(after_ms(52)));
}

TEST(ReadingQueue, numbers_what_is_sent_so_that_own_drops_leave_no_gap) {
    ReadingQueue queue = classical_queue();
    std::vector<int> sequences;
    for (int i = 0; i < 70; ++i) {
        queue.push(3, reading_of(100), kNow);
        queue.push(3, reading_of(101), kNow);  // displaces the first
        sequences.push_back(front_classical(queue).sequence);
        queue.pop();
    }
    for (int i = 0; i < 70; ++i) EXPECT_EQ(sequences[static_cast<std::size_t>(i)], i % 64);
    EXPECT_EQ(queue.sent(3), 70);
    EXPECT_EQ(queue.sent(4), 0);
}

TEST(ReadingQueue, adds_signal_figures_to_every_fourth_classical_reading) {
    ReadingQueue queue = classical_queue(4);
    std::vector<int> sequences_with_aux;
    for (int i = 0; i < 9; ++i) {
        queue.push(7, reading_of(100), kNow);
        queue.pop();
        if (!queue.aux()) continue;
        EXPECT_EQ(queue.aux()->sensor, 7);
        EXPECT_EQ(queue.aux()->signal, (wire::SignalReading{.peak_signal = 500, .ambient = 6}));
        sequences_with_aux.push_back(queue.aux()->sequence);
        queue.pop_aux();
    }
    EXPECT_EQ(sequences_with_aux, (std::vector<int>{0, 4, 8}));
}

TEST(ReadingQueue, ages_readings_correctly_across_the_wrap_of_the_clock) {
    ReadingQueue queue = fd_queue();
    const NodeTime before_wrap{0xFFFFFFFFU - 1'000U};
    queue.push(1, reading_of(100, before_wrap), before_wrap);
    EXPECT_FALSE(queue.is_ready(before_wrap + Microseconds{2'000}));
    EXPECT_TRUE(queue.is_ready(before_wrap + Microseconds{3'000}));
    queue.drop_late(before_wrap + Microseconds{50'000});
    EXPECT_EQ(queue.losses().late, 0U);
    EXPECT_EQ(front_fd(queue).entries[0].reading.capture.value_us, 0x00FFFC17U);
}

}  // namespace
}  // namespace octoskin::node
