// What a node says that it sent, against what came: how much is lost, and that a sensor is silent.
#include "host/core/ingest/sent_count.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <optional>

#include "host/core/ingest/node_silence.hpp"
#include "host/core/ingest/range_gate.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

constexpr wire::NodeId kNode = 5;
constexpr std::optional<HostTime> kUnknown;
constexpr Microseconds kPeriod = 20ms;

TEST(SentCount, has_nothing_lost_for_a_message_that_comes_late_or_twice) {
    for (const std::uint16_t begun : {std::uint16_t{100}, std::uint16_t{65'500}}) {
        SentCount count;
        std::uint64_t received = 7;
        const auto sent_after = [&](unsigned seconds) {
            return static_cast<std::uint16_t>(begun + 50 * seconds);
        };
        count.on_health(sent_after(0), received, kUnknown);
        for (unsigned i = 1; i <= 5; ++i) {
            received += 49;
            count.on_health(sent_after(i), received, kUnknown);
            EXPECT_EQ(count.lost(), i);
            for (unsigned before = 0; before <= i; ++before) {
                count.on_health(sent_after(before), received, kUnknown);
                EXPECT_EQ(count.lost(), i) << before;
            }
        }
        count.on_health(sent_after(805), received, kUnknown);
        EXPECT_EQ(count.lost(), 5U + 40'000U) << "after a silence of 800 s";
    }
}

TEST(SentCount, keeps_what_was_lost_when_the_node_begins_anew) {
    SentCount count;
    count.on_health(0, 0, kUnknown);
    count.on_health(10, 4, kUnknown);
    EXPECT_EQ(count.lost(), 6U);
    count.restart();
    count.on_health(3, 4, kUnknown);
    EXPECT_EQ(count.lost(), 6U);
    count.on_health(5, 5, kUnknown);
    EXPECT_EQ(count.lost(), 7U);
}

TEST(SentCount, tells_what_was_lost_over_the_newest_steps_of_a_second_and_four_readings) {
    SentCount count;
    const auto at = [](double seconds) { return HostTime{std::llround(1e9 * seconds)}; };
    for (std::uint16_t k = 0; k <= 3; ++k) {
        EXPECT_FALSE(count.newest_loss(at(k))) << k;
        count.on_health(static_cast<std::uint16_t>(50 * k), 10U * k, at(k));
        count.on_health(static_cast<std::uint16_t>(50 * k + 5), 10U * k, at(k + 0.1));  // asked for
    }
    const auto loss = count.newest_loss(at(3.5));
    ASSERT_TRUE(loss);
    EXPECT_EQ(loss->sent, 150U);
    EXPECT_EQ(loss->lost, 120U);
    EXPECT_EQ(loss->within, 3s);
    EXPECT_TRUE(loss->is_over(0.79));
    EXPECT_FALSE(loss->is_over(0.8));
    EXPECT_EQ(count.newest_loss(at(3.5), 1)->sent, 50U);
    EXPECT_FALSE(count.newest_loss(at(6.2))) << "no message for over 3 s";
    count.forget_steps();
    EXPECT_FALSE(count.newest_loss(at(3.5)));
    for (std::uint16_t k = 0; k <= 12; ++k) {  // a slow one
        count.on_health(static_cast<std::uint16_t>(160 + k), 30U + k, at(4.0 + k));
        EXPECT_EQ(count.newest_loss(at(4.0 + k)).has_value(), k == 12) << k;
    }
}

/// A sensor of 50 Hz whose node sends a health message each second, by milliseconds. What a test changes of
/// it, it changes at a time.
class SilentSensorTest : public testing::Test {
  protected:
    using State = wire::SensorState;

    /// From `from_ms` until `to_ms`; returns when it was silent first, if it was.
    std::optional<int> run(int from_ms, int to_ms) {
        std::optional<int> silent;
        for (int ms = from_ms; ms < to_ms; ++ms) {
            if (ms % 1000 == health_phase_ms_) send_health(ms);
            if (ms % period_ms_ == 0 && state_ == State::ranging) send_reading(ms);
            const SensorSilence what = silence_of(gate_.record(kNode, 0), kPeriod, at(ms));
            if (!silent && what == SensorSilence::no_readings) silent = ms;
        }
        return silent;
    }
    void send_reading(int ms) {
        ++sent_;
        if (readings_come_) gate_.on_arrival(kNode, {}, at(ms));
    }
    void send_health(int ms) {
        wire::SensorHealth health;
        health.state = state_;
        health.sent = sent_;
        if (health_comes_) gate_.on_health(kNode, health, at(ms));
    }
    static HostTime at(int ms) { return HostTime{} + Nanoseconds{std::chrono::milliseconds(ms)}; }
    static HostRig rig() {
        HostSensor sensor;
        sensor.period = kPeriod;
        HostNode node;
        node.node_id = kNode;
        node.sensors = {sensor};
        HostRig rig;
        rig.nodes = {node};
        return rig;
    }

    RangeGate gate_{rig(), false};
    int period_ms_ = 20;
    int health_phase_ms_ = 0;
    std::uint16_t sent_ = 65'500;
    State state_ = State::ranging;
    bool readings_come_ = true;
    bool health_comes_ = true;
};

TEST_F(SilentSensorTest, is_found_within_two_seconds_and_no_longer_when_a_reading_comes) {
    for (const int phase : {0, 1, 10, 19, 500, 990, 999}) {
        health_phase_ms_ = phase;
        gate_ = RangeGate(rig(), false);
        readings_come_ = true;
        EXPECT_EQ(run(0, 5'000), std::nullopt) << phase;
        readings_come_ = false;
        const auto silent = run(5'000, 9'000);
        EXPECT_TRUE(silent && *silent > 5'900 && *silent < 7'300) << phase << " " << silent.value_or(0);
        readings_come_ = true;
        send_reading(9'000);
        EXPECT_EQ(run(9'000, 12'000), std::nullopt) << phase;
    }
}

TEST_F(SilentSensorTest, is_found_though_no_reading_of_it_ever_came) {
    readings_come_ = false;
    const auto silent = run(0, 5'000);
    EXPECT_TRUE(silent && *silent <= 2'000) << silent.value_or(0);
}

TEST_F(SilentSensorTest, is_none_whose_readings_are_lost_for_a_while_or_one_of_two) {
    EXPECT_EQ(run(0, 3'000), std::nullopt);
    readings_come_ = false;
    EXPECT_EQ(run(3'000, 3'600), std::nullopt);
    for (int ms = 3'600; ms < 20'000; ms += 20) {
        readings_come_ = ms % 40 == 0;
        EXPECT_EQ(run(ms, ms + 20), std::nullopt);
    }
}

TEST_F(SilentSensorTest, is_none_that_is_stopped_or_has_not_begun_or_begins_again) {
    state_ = State::starting;
    EXPECT_EQ(run(0, 3'000), std::nullopt);
    state_ = State::ranging;
    EXPECT_EQ(run(3'000, 5'000), std::nullopt);
    state_ = State::stopped;
    EXPECT_EQ(run(5'010, 15'000), std::nullopt);
    state_ = State::ranging;
    EXPECT_EQ(run(15'000, 20'000), std::nullopt);
}

TEST_F(SilentSensorTest, is_none_of_a_node_that_starts_again) {
    EXPECT_EQ(run(0, 5'000), std::nullopt);
    state_ = State::absent;
    EXPECT_EQ(run(5'000, 8'300), std::nullopt);
    sent_ = 0;
    gate_.forget(kNode);
    state_ = State::ranging;
    EXPECT_EQ(run(8'300, 12'000), std::nullopt);
}

// What comes first when the bus is back is the health message.
TEST_F(SilentSensorTest, is_none_on_a_bus_that_was_away) {
    EXPECT_EQ(run(0, 4'990), std::nullopt);
    readings_come_ = health_comes_ = false;
    EXPECT_EQ(run(4'990, 9'990), std::nullopt);
    health_comes_ = true;
    send_health(9'990);
    EXPECT_EQ(run(9'990, 10'000), std::nullopt);
    readings_come_ = true;
    EXPECT_EQ(run(10'000, 14'000), std::nullopt);
}

TEST_F(SilentSensorTest, is_none_that_ranges_slower_than_it_should) {
    period_ms_ = 1'000;
    health_phase_ms_ = 1;
    EXPECT_EQ(run(0, 10'000), std::nullopt);
    period_ms_ = 3'000;
    EXPECT_EQ(run(10'000, 40'000), std::nullopt);
}

}  // namespace
}  // namespace octoskin
