#include "firmware/core/acceptance.hpp"

#include <gtest/gtest.h>

#include "common/wire/messages.hpp"

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr NodeTime kStart{1'000'000};
constexpr Microseconds kBudget{20'000};
constexpr Microseconds kPeriod{33'000};

vl53l1x::Measurement result(std::uint8_t stream_count, std::uint8_t device_status = 9) {
    vl53l1x::Measurement measurement;
    measurement.device_status = device_status;
    measurement.stream_count = stream_count;
    measurement.range_mm = 1'500;
    measurement.sigma_quarter_mm = 20;
    measurement.peak_signal = 640;
    measurement.ambient = 12;
    return measurement;
}

/// When the `range`-th range (0 = first) of an undisturbed sensor is ready.
NodeTime ready(int range) {
    return kStart + kPeriod * (range + 1);
}

class AcceptanceTest : public testing::Test {
  protected:
    Acceptance started(StreamGate gate) {
        Acceptance acceptance{gate, kBudget, kPolicy};
        acceptance.restart(kStart, kPeriod, 120);
        return acceptance;
    }
    /// Polled 200 and 100 us before and seen 100 us after its ready time.
    Admission offer(Acceptance& acceptance, int range, const vl53l1x::Measurement& measurement) {
        acceptance.on_not_ready(ready(range) - Microseconds{200});
        acceptance.on_not_ready(ready(range) - Microseconds{100});
        return offer_unpolled(acceptance, range, measurement, Microseconds{100});
    }
    Admission offer_unpolled(Acceptance& acceptance, int range, const vl53l1x::Measurement& measurement,
                             Microseconds late) {
        const NodeTime seen = ready(range) + late;
        return acceptance.judge(
            {.measurement = measurement, .ready_seen = seen, .read_end = seen + Microseconds{1'100}}, zones_);
    }
    /// The reading's capture is as close as it tells to that of a range whose data truly was ready at
    /// `truth`.
    static void expect_within_bound(const Acceptance& acceptance, NodeTime truth) {
        const Microseconds error = elapsed(truth - kBudget / 2, acceptance.reading().capture);
        EXPECT_LE(std::abs(error.count()), acceptance.reading().capture_bound.count());
    }
    ZoneCycle zones_{1, Microseconds{1'000}};
};

TEST_F(AcceptanceTest, makes_a_reading_of_a_result_with_its_capture_in_the_middle_of_the_budget) {
    Acceptance acceptance = started(StreamGate::advanced);
    ASSERT_EQ(offer(acceptance, 0, result(7)), Admission::accepted);
    const Reading& reading = acceptance.reading();
    // Of a first result nothing is known but the polls: -100 to +100 us.
    EXPECT_EQ(reading.capture, ready(0) - Microseconds{10'000});
    EXPECT_EQ(reading.capture_bound, Microseconds{100});
    EXPECT_EQ(reading.range_mm, 1'500);
    EXPECT_EQ(reading.sigma_quarter_mm, 20);
    EXPECT_EQ(reading.peak_signal, 640);
    EXPECT_EQ(reading.ambient, 12);
    EXPECT_EQ(reading.zone, 0);
}

TEST_F(AcceptanceTest, believes_the_last_poll_only_if_another_said_the_same_half_a_millisecond_before) {
    for (const std::int64_t before_us : {500, 501}) {
        Acceptance acceptance = started(StreamGate::advanced);
        acceptance.on_not_ready(ready(0) - Microseconds{100 + before_us});
        acceptance.on_not_ready(ready(0) - Microseconds{100});
        ASSERT_EQ(offer_unpolled(acceptance, 0, result(0), Microseconds{100}), Admission::accepted);
        const std::int64_t bracket_us = before_us <= 500 ? 200 : 200 + before_us;
        EXPECT_EQ(acceptance.reading().capture_bound, Microseconds{(bracket_us + 1) / 2});
    }
}

TEST_F(AcceptanceTest, sends_only_code_9_of_stream_count_0_as_code_19) {
    for (int status = 0; status < 32; ++status) {
        for (const int stream : {0, 1, 128}) {
            Acceptance acceptance = started(StreamGate::advanced);
            const auto code = static_cast<std::uint8_t>(status);
            ASSERT_EQ(offer(acceptance, 0, result(static_cast<std::uint8_t>(stream), code)),
                      Admission::accepted);
            const int expected = status == 9 && stream == 0 ? 19 : status;
            EXPECT_EQ(acceptance.reading().device_status, expected);
        }
    }
}

TEST_F(AcceptanceTest, proves_a_sensor_only_by_a_second_result) {
    Acceptance acceptance = started(StreamGate::advanced);
    ASSERT_EQ(offer(acceptance, 0, result(0)), Admission::accepted);
    EXPECT_FALSE(acceptance.is_proven());
    ASSERT_EQ(offer(acceptance, 1, result(1)), Admission::accepted);
    EXPECT_TRUE(acceptance.is_proven());
}

TEST_F(AcceptanceTest, refuses_a_repeated_stream_count_unless_the_gate_is_off) {
    for (const StreamGate gate : {StreamGate::advanced, StreamGate::differs, StreamGate::off}) {
        Acceptance acceptance = started(gate);
        ASSERT_EQ(offer(acceptance, 0, result(5)), Admission::accepted);
        EXPECT_EQ(offer(acceptance, 1, result(5)),
                  gate == StreamGate::off ? Admission::accepted : Admission::refused);
    }
}

TEST_F(AcceptanceTest, refuses_a_stream_count_that_went_back_only_if_it_must_advance) {
    for (const StreamGate gate : {StreamGate::advanced, StreamGate::differs, StreamGate::off}) {
        Acceptance acceptance = started(gate);
        ASSERT_EQ(offer(acceptance, 0, result(50)), Admission::accepted);
        EXPECT_EQ(offer(acceptance, 1, result(49)),
                  gate == StreamGate::advanced ? Admission::refused : Admission::accepted);
    }
}

TEST_F(AcceptanceTest, dates_a_result_by_its_stream_count_when_earlier_ones_were_overwritten) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    // The bus was taken for three periods; ranges 21 and 22 were overwritten by 23.
    ASSERT_EQ(offer_unpolled(acceptance, 23, result(23), Microseconds{7'000}), Admission::accepted);
    expect_within_bound(acceptance, ready(23));
    EXPECT_LE(acceptance.reading().capture_bound, Microseconds{250});
}

TEST_F(AcceptanceTest, believes_a_lone_poll_once_it_knows_to_a_millisecond_when_to_expect_the_data) {
    // After a first range it knows the next ready time to 12 % of a period.
    for (const int last : {0, 20}) {
        Acceptance acceptance = started(StreamGate::advanced);
        for (int range = 0; range <= last; ++range) {
            ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))),
                      Admission::accepted);
        }
        const int next = last + 1;
        acceptance.on_not_ready(ready(next) - Microseconds{100});
        ASSERT_EQ(
            offer_unpolled(acceptance, next, result(static_cast<std::uint8_t>(next)), Microseconds{100}),
            Admission::accepted);
        const std::int64_t bound_us = acceptance.reading().capture_bound.count();
        EXPECT_EQ(bound_us <= 100, last == 20) << bound_us;
        EXPECT_EQ(bound_us >= 1'000, last == 0) << bound_us;
    }
}

TEST_F(AcceptanceTest, knows_that_data_it_saw_ready_was_ready_by_then_even_if_no_poll_went_before) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    ASSERT_EQ(offer_unpolled(acceptance, 21, result(21), Microseconds{0}), Admission::accepted);
    const Reading& reading = acceptance.reading();
    EXPECT_LE(elapsed(ready(21) - kBudget / 2, reading.capture + reading.capture_bound), Microseconds{1});
}

TEST_F(AcceptanceTest, believes_no_pin_without_a_poll_that_found_nothing_while_it_hardly_knows_the_rhythm) {
    Acceptance acceptance = started(StreamGate::advanced);
    ASSERT_EQ(offer(acceptance, 0, result(0)), Admission::accepted);
    // It says ready 3 ms early; while others have the bus, the data truly comes.
    (void)acceptance.judge({.measurement = result(1),
                            .ready_seen = ready(1) - Microseconds{3'000},
                            .read_end = ready(1) + Microseconds{1'100}},
                           zones_);
    expect_within_bound(acceptance, ready(1));
}

TEST_F(AcceptanceTest, forgets_the_rhythm_that_a_pin_told_which_says_ready_of_an_old_result) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    // The sensor slips by 0.9 ms, and its pin says ready all the time.
    constexpr Microseconds kSlip{900};
    (void)acceptance.judge({.measurement = result(21),
                            .ready_seen = ready(21) + Microseconds{50},
                            .read_end = ready(21) + kSlip + Microseconds{1'100}},
                           zones_);
    EXPECT_EQ(offer_unpolled(acceptance, 22, result(21), Microseconds{50}), Admission::refused);
    (void)offer_unpolled(acceptance, 22, result(22), kSlip + Microseconds{100});
    expect_within_bound(acceptance, ready(22) + kSlip);
}

TEST_F(AcceptanceTest, forgets_the_rhythm_if_the_count_contradicts_the_results_seen_and_one_poll) {
    for (const int stream : {22, 23}) {
        Acceptance acceptance = started(StreamGate::advanced);
        for (int range = 0; range <= 20; ++range) {
            ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))),
                      Admission::accepted);
        }
        acceptance.on_unreadable();  // 21
        acceptance.on_not_ready(ready(22) - Microseconds{100});
        const Admission verdict =
            offer_unpolled(acceptance, 22, result(static_cast<std::uint8_t>(stream)), Microseconds{100});
        EXPECT_EQ(verdict, stream == 22 ? Admission::accepted : Admission::undated) << stream;
    }
}

TEST_F(AcceptanceTest, does_not_date_a_result_without_a_count_once_another_may_have_been_overwritten) {
    Acceptance acceptance = started(StreamGate::off);
    for (int range = 0; range <= 20; ++range)
        ASSERT_EQ(offer(acceptance, range, result(0)), Admission::accepted);
    EXPECT_EQ(offer_unpolled(acceptance, 22, result(0), Microseconds{7'000}), Admission::undated);
    EXPECT_EQ(offer(acceptance, 23, result(0)), Admission::accepted);
    expect_within_bound(acceptance, ready(23));
}

// Kept waiting before the read: without a count it may be the next range's result, or the one after.
TEST_F(AcceptanceTest, knows_without_a_count_what_it_read_late_or_says_that_it_does_not) {
    for (const StreamGate gate : {StreamGate::differs, StreamGate::off}) {
        for (std::int64_t late_us = 0; late_us < 200'000; late_us += 500) {
            SCOPED_TRACE(testing::Message() << static_cast<int>(gate) << ' ' << late_us << " us late");
            Acceptance acceptance = started(gate);
            for (int range = 0; range <= 20; ++range) {
                const auto stream = static_cast<std::uint8_t>(range);
                ASSERT_EQ(offer(acceptance, range, result(stream)), Admission::accepted);
            }
            acceptance.on_not_ready(ready(21) - Microseconds{100});
            const auto overwritten = static_cast<int>(late_us / kPeriod.count());
            const NodeTime polled = ready(21) + Microseconds{100};
            const ResultSeen seen{.measurement = result(static_cast<std::uint8_t>(21 + overwritten)),
                                  .ready_seen = polled,
                                  .read_end = ready(21) + Microseconds{late_us + 100}};
            if (acceptance.judge(seen, zones_) == Admission::accepted)
                expect_within_bound(acceptance, ready(21 + overwritten));
        }
    }
}

TEST_F(AcceptanceTest, keeps_the_time_of_the_poll_when_the_result_was_overwritten_before_it_was_read) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    acceptance.on_not_ready(ready(21) - Microseconds{100});
    // Seen ready in time, but the read took so long that the next range came in.
    const ResultSeen seen{.measurement = result(22),
                          .ready_seen = ready(21) + Microseconds{100},
                          .read_end = ready(22) + Microseconds{900}};
    ASSERT_EQ(acceptance.judge(seen, zones_), Admission::accepted);
    expect_within_bound(acceptance, ready(22));
    EXPECT_LE(acceptance.reading().capture_bound, Microseconds{500});
}

TEST_F(AcceptanceTest, refuses_the_first_result_of_a_run_unless_its_data_was_seen_to_become_ready) {
    // It may be left over from the run before, if the interrupt could not be cleared.
    for (const StreamGate gate : {StreamGate::advanced, StreamGate::differs, StreamGate::off}) {
        Acceptance acceptance = started(gate);
        EXPECT_EQ(offer_unpolled(acceptance, 0, result(0), Microseconds{100}), Admission::refused);
        EXPECT_EQ(offer(acceptance, 1, result(1)), Admission::accepted);
    }
}

TEST_F(AcceptanceTest,
       does_not_take_the_poll_of_an_interrupt_that_was_long_not_seen_low_for_the_time_of_the_data) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    for (int range = 21; range < 24; ++range) {
        ASSERT_EQ(
            offer_unpolled(acceptance, range, result(static_cast<std::uint8_t>(range)), Microseconds{100}),
            Admission::accepted);
    }
    // Stuck at "ready", it said so 50 us too early; the data came before it was read.
    const ResultSeen seen{.measurement = result(24),
                          .ready_seen = ready(24) - Microseconds{50},
                          .read_end = ready(24) + Microseconds{1'050}};
    ASSERT_EQ(acceptance.judge(seen, zones_), Admission::accepted);
    expect_within_bound(acceptance, ready(24));
}

TEST_F(AcceptanceTest, drops_a_reading_whose_time_is_not_known_to_ten_milliseconds) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    // The last result could not be read, and this one was not seen to become ready: it may be either.
    acceptance.on_unreadable();
    EXPECT_EQ(offer_unpolled(acceptance, 22, result(21), Microseconds{100}), Admission::undated);
    // The rhythm is found again at once.
    ASSERT_EQ(offer(acceptance, 23, result(22)), Admission::accepted);
    expect_within_bound(acceptance, ready(23));
}

TEST_F(AcceptanceTest, drops_a_reading_of_unknown_zone) {
    Acceptance acceptance = started(StreamGate::advanced);
    ZoneCycle zones{2, Microseconds{1'000}};
    acceptance.on_not_ready(ready(0) - Microseconds{200});
    acceptance.on_not_ready(ready(0) - Microseconds{100});
    zones.written({ready(0) - kBudget, ready(0) - kBudget + Microseconds{200}});
    const ResultSeen seen{.measurement = result(0),
                          .ready_seen = ready(0) + Microseconds{100},
                          .read_end = ready(0) + Microseconds{1'200}};
    EXPECT_EQ(acceptance.judge(seen, zones), Admission::undated);
}

TEST_F(AcceptanceTest, calls_a_sensor_silent_after_three_periods_without_a_new_result) {
    Acceptance acceptance = started(StreamGate::advanced);
    EXPECT_FALSE(acceptance.is_silent(kStart + Microseconds{99'000}));
    EXPECT_TRUE(acceptance.is_silent(kStart + Microseconds{99'001}));
    ASSERT_EQ(offer(acceptance, 0, result(3)), Admission::accepted);
    ASSERT_EQ(offer(acceptance, 1, result(3)), Admission::refused);
    ASSERT_EQ(offer(acceptance, 2, result(3)), Admission::refused);
    const NodeTime last_read = ready(0) + Microseconds{1'200};
    EXPECT_FALSE(acceptance.is_silent(last_read + Microseconds{98'900}));
    EXPECT_TRUE(acceptance.is_silent(last_read + Microseconds{99'200}));
}

TEST_F(AcceptanceTest, expects_the_next_result_a_period_after_one_it_could_not_use) {
    Acceptance acceptance = started(StreamGate::advanced);
    for (int range = 0; range <= 20; ++range) {
        ASSERT_EQ(offer(acceptance, range, result(static_cast<std::uint8_t>(range))), Admission::accepted);
    }
    acceptance.on_unreadable();
    ASSERT_TRUE(acceptance.next_ready().has_value());
    EXPECT_TRUE(acceptance.next_ready()->contains(ready(22)));
    EXPECT_FALSE(acceptance.next_ready()->contains(ready(21)));
    EXPECT_TRUE(acceptance.has_refused());
    ASSERT_EQ(offer(acceptance, 22, result(22)), Admission::accepted);
    EXPECT_FALSE(acceptance.has_refused());
    EXPECT_TRUE(acceptance.next_ready()->contains(ready(23)));
    EXPECT_FALSE(acceptance.next_ready()->contains(ready(24)));
}

}  // namespace
}  // namespace octoskin::node
