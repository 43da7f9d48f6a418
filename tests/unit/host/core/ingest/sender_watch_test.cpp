// What shows that two senders speak under one sensor's name: evidence of both kinds, and how long it holds.
#include "host/core/ingest/sender_watch.hpp"

#include <gtest/gtest.h>

#include "host/core/ingest/cadence.hpp"
#include "host/core/ingest/clock_question.hpp"
#include "host/core/ingest/node_losses.hpp"
#include "host/core/ingest/reading_hold.hpp"
#include "host/core/ingest/said_numbers.hpp"

namespace octoskin {
namespace {

constexpr HostTime ms(std::int64_t value) {
    return {10'000'000'000 + value * 1'000'000};
}
constexpr Nanoseconds kPeriod{33'000'000};

TEST(SenderWatch, disputes_a_sensor_from_the_second_contradiction_in_a_second_to_a_second_after_the_last) {
    SenderWatch watch(kPeriod);
    watch.on_contradiction(ms(0));
    EXPECT_FALSE(watch.is_named(ms(0)));
    watch.on_contradiction(ms(1'000));
    EXPECT_FALSE(watch.is_named(ms(1'000))) << "a second apart";
    watch.on_contradiction(ms(1'999));
    EXPECT_TRUE(watch.is_disputed(ms(1'999)));
    EXPECT_TRUE(watch.is_named(ms(2'998)));
    EXPECT_FALSE(watch.is_named(ms(2'999)));
    watch.on_contradiction(ms(3'500));
    EXPECT_FALSE(watch.is_disputed(ms(3'500))) << "over a second since the one before";
    EXPECT_EQ(watch.contradictions(), 4U);
}

TEST(SenderWatch, ends_a_dispute_where_the_time_leaps) {
    SenderWatch watch(kPeriod);
    watch.on_contradiction(ms(0));
    watch.on_contradiction(ms(1));
    EXPECT_TRUE(watch.is_disputed(ms(2)));
    EXPECT_FALSE(watch.is_disputed(ms(-3'600'000)));
    EXPECT_FALSE(watch.is_disputed(ms(3'600'000)));
}

TEST(SenderWatch, takes_for_strays_only_what_the_numbers_left_out_cannot_explain) {
    SenderWatch watch(kPeriod);
    watch.on_refused();
    watch.on_taken(1U, ms(0));
    EXPECT_EQ(watch.strays(), 0U) << "the one refused may be the one that is missing";
    watch.on_refused();
    watch.on_refused();
    watch.on_taken(1U, ms(33));
    EXPECT_EQ(watch.strays(), 1U);
    watch.on_refused();
    watch.on_taken(std::nullopt, ms(66));
    EXPECT_EQ(watch.strays(), 1U) << "how many are missing cannot be told";
    watch.on_refused();
    watch.forget_refused();
    watch.on_taken(0U, ms(99));
    EXPECT_EQ(watch.strays(), 1U);
}

TEST(SenderWatch, names_one_stray_where_no_frame_of_its_node_was_damaged_for_a_minute) {
    SenderWatch watch(kPeriod);
    const auto stray = [&](std::int64_t at_ms) {
        watch.on_refused();
        watch.on_taken(0U, ms(at_ms));
    };
    stray(0);
    EXPECT_TRUE(watch.is_named(ms(0)));
    EXPECT_FALSE(watch.is_disputed(ms(0)));
    EXPECT_TRUE(watch.is_named(ms(2'499)));
    EXPECT_FALSE(watch.is_named(ms(2'500)));
    watch.on_damage(ms(10'000));
    stray(69'999);
    EXPECT_FALSE(watch.is_named(ms(69'999))) << "it may be one that the checksum let through";
    stray(80'000);
    EXPECT_TRUE(watch.is_named(ms(80'000)));
}

TEST(SenderWatch, names_two_strays_in_two_and_a_half_seconds_and_disputes_more_than_a_quarter) {
    SenderWatch watch(kPeriod);  // 30 a second: 7 strays are kept
    watch.on_damage(ms(0));
    const auto stray = [&](std::int64_t at_ms) {
        watch.on_refused();
        watch.on_taken(0U, ms(at_ms));
    };
    stray(0);
    stray(2'500);
    EXPECT_FALSE(watch.is_named(ms(2'500)));
    stray(4'999);
    EXPECT_TRUE(watch.is_named(ms(4'999)));
    EXPECT_TRUE(watch.is_named(ms(7'498)));
    EXPECT_FALSE(watch.is_named(ms(7'499)));
    for (int i = 0; i < 7; ++i) stray(9'000 + i);
    EXPECT_FALSE(watch.is_disputed(ms(9'006)));
    stray(9'007);
    EXPECT_TRUE(watch.is_disputed(ms(9'007)));
    EXPECT_FALSE(watch.is_disputed(ms(10'007)));
}

wire::RangeReading reading(std::uint8_t sequence, std::uint16_t range_mm) {
    return {.sensor = 0,
            .zone = 0,
            .device_status = 9,
            .sequence = sequence,
            .range_mm = range_mm,
            .sigma_quarter_mm = 8,
            .capture = {}};
}

TEST(SaidNumbers, tells_the_same_again_from_other_contents_within_a_turn_of_the_numbers) {
    using Fate = SaidNumbers::Fate;
    constexpr Nanoseconds kTurn{800'000'000};
    SaidNumbers said;
    EXPECT_EQ(said.compare(reading(7, 500), ms(0), kTurn), Fate::is_new);
    said.take(reading(7, 500), ms(0));
    EXPECT_EQ(said.compare(reading(7, 500), ms(799), kTurn), Fate::same);
    EXPECT_EQ(said.compare(reading(7, 501), ms(799), kTurn), Fate::other);
    EXPECT_EQ(said.compare(reading(7, 501), ms(799), kTurn), Fate::same) << "the bus repeated it";
    EXPECT_EQ(said.compare(reading(7, 502), ms(799), kTurn), Fate::other);
    EXPECT_EQ(said.compare(reading(8, 500), ms(799), kTurn), Fate::is_new);
    EXPECT_EQ(said.compare(reading(7, 501), ms(800), kTurn), Fate::is_new) << "a turn later";
    said.restart();
    EXPECT_EQ(said.compare(reading(7, 501), ms(1), kTurn), Fate::is_new);
}

TEST(Cadence, fits_what_follows_by_the_period_and_nothing_that_a_jump_moved_by_over_3_ms) {
    Cadence cadence(kPeriod);
    EXPECT_FALSE(cadence.fits(1, ms(33))) << "after none";
    cadence.on_accepted(0, ms(0));
    for (const int lost : {0, 1, 5, 20}) {
        const auto sequence = static_cast<std::uint8_t>(1 + lost);
        const std::int64_t due_ms = 33 * (1 + lost);
        EXPECT_TRUE(cadence.fits(sequence, ms(due_ms - 3)) && cadence.fits(sequence, ms(due_ms + 3)));
        EXPECT_FALSE(cadence.fits(sequence, ms(due_ms - 4)) || cadence.fits(sequence, ms(due_ms + 4)));
    }
    EXPECT_TRUE(cadence.fits(62, ms(-66))) << "a late one";
    EXPECT_FALSE(cadence.fits(0, ms(0)));
}

TEST(Cadence, keeps_to_what_an_exchange_confirmed_and_measures_the_period_by_it) {
    Cadence cadence(kPeriod);
    cadence.on_accepted(0, ms(0));
    cadence.on_accepted(1, ms(20));  // ranges quicker than the rig has it, or its clock jumped
    EXPECT_TRUE(cadence.fits(2, ms(66)));
    EXPECT_FALSE(cadence.fits(2, ms(40)));
    cadence.confirm();
    EXPECT_FALSE(cadence.fits(2, ms(66)));
    EXPECT_TRUE(cadence.fits(2, ms(40)));
    cadence.restart();
    EXPECT_FALSE(cadence.fits(2, ms(40)));
}

TEST(ClockQuestion, asks_for_an_exchange_after_two_sensors_or_two_in_a_row_of_one) {
    ClockQuestion question;
    EXPECT_FALSE(question.is_open());
    question.on_impossible(3);
    EXPECT_TRUE(question.is_open());
    EXPECT_FALSE(question.wants_exchange());
    question.on_possible(2);
    question.on_possible(3);
    question.on_impossible(3);
    EXPECT_FALSE(question.wants_exchange()) << "one between them fitted";
    ClockQuestion other = question;
    question.on_impossible(3);
    EXPECT_TRUE(question.wants_exchange());
    other.on_impossible(4);
    EXPECT_TRUE(other.wants_exchange());
    other.answer();
    EXPECT_FALSE(other.is_open() || other.wants_exchange());
}

RangeMeasurement measurement(std::uint8_t sensor, std::int64_t captured_ms) {
    return {.source = {1, sensor, 0}, .captured = ms(captured_ms), .range_m = 0.5};
}

TEST(ReadingHold, gives_back_what_waited_long_enough_and_drops_a_number_or_a_sensor) {
    ReadingHold hold;
    EXPECT_TRUE(hold.put(measurement(0, 33), 1, ms(140)));
    EXPECT_TRUE(hold.put(measurement(0, 0), 0, ms(110)));
    EXPECT_FALSE(hold.put(measurement(0, 1), 0, ms(110))) << "its number waits already";
    EXPECT_TRUE(hold.put(measurement(1, 0), 0, ms(110)));
    EXPECT_EQ(hold.size(), 3U);
    EXPECT_TRUE(hold.take_due(ms(109)).empty());
    EXPECT_EQ(hold.drop(1, 1, 5), 0U);
    EXPECT_EQ(hold.drop(1, 1, 0), 1U);
    const auto due = hold.take_due(ms(140));
    ASSERT_EQ(due.size(), 2U);
    EXPECT_EQ(due[0].captured, ms(0));
    EXPECT_EQ(due[1].captured, ms(33));
    EXPECT_TRUE(hold.put(measurement(0, 66), 2, ms(170)));
    EXPECT_TRUE(hold.put(measurement(0, 99), 3, ms(200)));
    EXPECT_TRUE(hold.put(measurement(2, 99), 3, ms(200)));
    EXPECT_EQ(hold.drop(1, 0), 2U);
    EXPECT_EQ(hold.take_due(ms(-3'600'000)).size(), 1U) << "the time leapt";
}

TEST(NodeLosses, are_worth_a_word_from_over_a_twentieth_of_the_last_second_on) {
    NodeLosses losses;
    for (int i = 0; i < 40; ++i) losses.on_reading(ms(i));
    losses.on_refused(ms(1), ReadingReason::too_young);
    EXPECT_FALSE(losses.worth_a_word(ms(50)));
    losses.on_refused(ms(2), ReadingReason::too_soon);
    EXPECT_FALSE(losses.worth_a_word(ms(50))) << "a twentieth";
    losses.on_refused(ms(2), ReadingReason::status_fault);
    losses.on_refused(ms(2), ReadingReason::clock_not_ready);
    EXPECT_FALSE(losses.worth_a_word(ms(50))) << "these are the sensor's, or usual";
    losses.on_refused(ms(3), ReadingReason::too_soon);
    const auto loss = losses.worth_a_word(ms(50));
    ASSERT_TRUE(loss);
    EXPECT_DOUBLE_EQ(loss->share, 3.0 / 40.0);
    EXPECT_EQ(loss->most, ReadingReason::too_soon);
    EXPECT_TRUE(losses.worth_a_word(ms(999)));
    EXPECT_FALSE(losses.worth_a_word(ms(1'000)));
}

TEST(NodeLosses, of_one_reading_are_none_however_few_come) {
    NodeLosses losses;
    for (int i = 0; i < 4; ++i) losses.on_reading(ms(250 * i));
    losses.on_refused(ms(750), ReadingReason::too_soon);
    EXPECT_FALSE(losses.worth_a_word(ms(760)));
    losses.on_refused(ms(760), ReadingReason::too_soon);
    EXPECT_TRUE(losses.worth_a_word(ms(760)));
}

}  // namespace
}  // namespace octoskin
