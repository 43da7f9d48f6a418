#include "host/core/ingest/range_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "common/range_status.hpp"
#include "common/wire/names.hpp"

namespace octoskin {
namespace {

constexpr wire::NodeId kNode = 3;
constexpr HostTime kNow{10'000'000'000};

HostRig rig() {
    HostRig rig;
    HostSensor sensor;
    sensor.timing_budget = std::chrono::milliseconds(20);
    sensor.zones = {HostZone{.offset_m = 0.01}, HostZone{.offset_m = -0.02}};
    HostSensor broken = sensor;
    broken.zones = {HostZone{.offset_m = std::numeric_limits<double>::quiet_NaN()}};
    rig.nodes.push_back(
        {.node_id = kNode, .name = "n", .node_hash = 0, .pinned_build_id = {}, .sensors = {sensor, broken}});
    return rig;
}

/// Valid: 1.000 m, sigma 10 mm, zone 0.
wire::RangeReading reading() {
    return {.sensor = 0,
            .zone = 0,
            .device_status = kDeviceStatusComplete,
            .sequence = 0,
            .range_mm = 1000,
            .sigma_quarter_mm = 40,
            .capture = {}};
}

wire::SensorHealth health(std::uint8_t sensor, std::uint16_t sent = 0, std::uint8_t capture_bound_64us = 1) {
    return {.sensor = sensor,
            .state = wire::SensorState::ranging,
            .fault = wire::SensorFault::none,
            .sent = sent,
            .capture_bound_64us = capture_bound_64us,
            .rejected = 0,
            .period_error_permille = 0};
}

/// Its node has told a capture bound for both sensors.
RangeGate informed_gate(bool uses_no_return = false) {
    RangeGate gate(rig(), uses_no_return);
    gate.on_health(kNode, health(0));
    gate.on_health(kNode, health(1));
    return gate;
}

Result<RangeMeasurement, ReadingReason> check(const wire::RangeReading& reading, bool uses_no_return = false,
                                              std::int64_t age_ms = 20) {
    RangeGate gate = informed_gate(uses_no_return);
    gate.on_arrival(kNode, reading, std::nullopt);
    return gate.check(kNode, reading, {kNow - Nanoseconds{age_ms * 1'000'000}, Nanoseconds{0}}, kNow);
}

void expect_rejected(ReadingReason reason, const wire::RangeReading& reading) {
    const auto outcome = check(reading);
    ASSERT_FALSE(outcome.has_value());
    EXPECT_EQ(names_of(ReadingReason{})[static_cast<std::size_t>(outcome.error())],
              std::string(names_of(ReadingReason{})[static_cast<std::size_t>(reason)]));
}

TEST(RangeGate, accepts_a_valid_range_and_adds_its_zones_offset) {
    const auto first = check(reading());
    ASSERT_TRUE(first.has_value());
    EXPECT_DOUBLE_EQ(first->range_m.value(), 1.010);
    EXPECT_DOUBLE_EQ(first->sigma_m, 0.010);
    EXPECT_EQ(first->source, (BeamSource{kNode, 0, 0}));
    EXPECT_EQ(first->captured.ns, 9'980'000'000);
    wire::RangeReading second = reading();
    second.zone = 1;
    EXPECT_DOUBLE_EQ(check(second)->range_m.value(), 0.980);
}

TEST(RangeGate, takes_only_status_9_as_a_range_and_only_status_4_as_nothing_there) {
    for (std::uint8_t code = 0; code < 32; ++code) {
        wire::RangeReading given = reading();
        given.device_status = code;
        const auto strict = check(given);
        const auto carving = check(given, true);
        if (code == 9) {
            EXPECT_TRUE(strict.has_value() && carving.has_value());
        } else if (code == 4) {
            EXPECT_EQ(strict.error(), ReadingReason::no_return);
            ASSERT_TRUE(carving.has_value());
            EXPECT_FALSE(carving->range_m.has_value());
        } else {
            EXPECT_EQ(strict.error(), ReadingReason::status_fault) << int{code};
            EXPECT_EQ(carving.error(), ReadingReason::status_fault) << int{code};
        }
    }
}

TEST(RangeGate, refuses_every_distance_outside_its_limits) {
    for (unsigned range_mm = 0; range_mm <= 0xFFFF; ++range_mm) {
        wire::RangeReading given = reading();
        given.range_mm = static_cast<std::uint16_t>(range_mm);
        const auto outcome = check(given);
        if (range_mm < 30) {
            ASSERT_EQ(outcome.error(), ReadingReason::below_range_min) << range_mm;
        } else if (range_mm > 3990) {
            ASSERT_EQ(outcome.error(), ReadingReason::above_range_max) << range_mm;
        } else {
            ASSERT_TRUE(outcome.has_value()) << range_mm;
        }
    }
}

// Exhaustive: each state and fault that SENSOR_HEALTH knows.
TEST(RangeGate, refuses_a_sensor_whose_node_says_that_it_is_not_as_configured_and_no_other) {
    for (const auto& state : wire::values_of(wire::SensorState{})) {
        for (const auto& fault : wire::values_of(wire::SensorFault{})) {
            RangeGate gate(rig(), false);
            wire::SensorHealth reported = health(0);
            reported.state = state.value;
            reported.fault = fault.value;
            gate.on_health(kNode, reported);
            gate.on_arrival(kNode, reading(), std::nullopt);
            const auto outcome =
                gate.check(kNode, reading(), {kNow - Nanoseconds{20'000'000}, Nanoseconds{0}}, kNow);
            const bool is_refused = state.value == wire::SensorState::degraded &&
                                    fault.value == wire::SensorFault::config_mismatch;
            EXPECT_EQ(outcome.has_value(), !is_refused) << state.name << ' ' << fault.name;
            if (is_refused) {
                EXPECT_EQ(outcome.error(), ReadingReason::sensor_misconfigured);
            }
        }
    }
}

TEST(RangeGate, refuses_a_sigma_at_the_end_of_the_classical_field) {
    wire::RangeReading given = reading();
    given.capture.span_us = wire::kClassicalTimeSpanUs;
    given.capture.value_us %= wire::kClassicalTimeSpanUs;
    given.sigma_quarter_mm = 126 * 4;
    EXPECT_TRUE(check(given).has_value());
    given.sigma_quarter_mm = 127 * 4;  // 127 mm or anything above it, while the limit is 200 mm
    expect_rejected(ReadingReason::sigma_above_max, given);
}

TEST(RangeGate, refuses_a_sigma_above_its_limit) {
    wire::RangeReading given = reading();
    given.sigma_quarter_mm = 800;  // 0.2 m
    EXPECT_TRUE(check(given).has_value());
    given.sigma_quarter_mm = 801;
    expect_rejected(ReadingReason::sigma_above_max, given);
}

TEST(RangeGate, refuses_zones_that_nobody_knows) {
    wire::RangeReading given = reading();
    given.zone = wire::kZoneUnknown;
    expect_rejected(ReadingReason::zone_unknown, given);
    given.zone = 2;
    expect_rejected(ReadingReason::zone_not_in_rig, given);
}

TEST(RangeGate, refuses_a_range_that_is_no_number) {
    wire::RangeReading given = reading();
    given.sensor = 1;
    expect_rejected(ReadingReason::not_finite, given);
}

TEST(RangeGate, refuses_what_arrives_before_half_the_budget_has_passed_or_later_than_that_and_100_ms) {
    EXPECT_EQ(check(reading(), false, 4).error(), ReadingReason::too_young) << "5 ms for an early \"now\"";
    EXPECT_TRUE(check(reading(), false, 5).has_value());
    EXPECT_TRUE(check(reading(), false, 110).has_value());
    EXPECT_EQ(check(reading(), false, 111).error(), ReadingReason::too_old);
}

/// One reading whose time the clock map knows within `map_us`.
Result<RangeMeasurement, ReadingReason> check_with(RangeGate& gate, std::int64_t map_us,
                                                   std::uint8_t number = 0) {
    gate.on_arrival(kNode, wire::RangeReading{}, std::nullopt);
    wire::RangeReading given = reading();
    given.sequence = number;
    return gate.check(kNode, given, {kNow - Nanoseconds{20'000'000}, Microseconds{map_us}}, kNow);
}

TEST(RangeGate, refuses_a_time_whose_two_bounds_together_exceed_the_limit) {
    for (unsigned reported = 0; reported <= 255; ++reported) {
        for (const std::int64_t map_us : {0, 100, 2'000, 4'936, 5'000, 5'001}) {
            RangeGate gate(rig(), false);
            gate.on_health(kNode, health(0, 0, static_cast<std::uint8_t>(reported)));
            const auto outcome = check_with(gate, map_us);
            ASSERT_EQ(outcome.has_value(), 64 * reported + map_us <= 5'000) << reported << " " << map_us;
            if (!outcome) {
                ASSERT_EQ(outcome.error(), ReadingReason::time_uncertain);
            }
        }
    }
}

TEST(RangeGate, takes_the_limit_on_uncertain_times_from_the_rig) {
    HostRig strict = rig();
    strict.range_limits.time_uncertainty_max = Microseconds{300};
    RangeGate gate(strict, false);
    gate.on_health(kNode, health(0, 0, 3));
    EXPECT_EQ(check_with(gate, 109).error(), ReadingReason::time_uncertain);
    EXPECT_TRUE(check_with(gate, 108, 1).has_value());
}

TEST(RangeGate, does_not_trust_a_time_while_the_node_has_not_told_how_good_it_is) {
    RangeGate gate(rig(), false);
    EXPECT_EQ(check_with(gate, 0).error(), ReadingReason::time_uncertain);
    gate.on_health(kNode, health(0));
    EXPECT_TRUE(check_with(gate, 0, 1).has_value());
    gate.forget_order(kNode);  // the host's clock, not the node's
    EXPECT_TRUE(check_with(gate, 0).has_value());
    gate.forget(kNode);
    EXPECT_EQ(check_with(gate, 0).error(), ReadingReason::time_uncertain);
    gate.on_health(kNode, health(0));
    EXPECT_TRUE(check_with(gate, 0, 1).has_value());
}

TEST(RangeGate, compares_the_numbers_of_readings_that_are_refused_for_something_else) {
    constexpr std::uint8_t kUseless = 255;
    const MappedTime captured{kNow - Nanoseconds{20'000'000}, Nanoseconds{0}};
    RangeGate gate = informed_gate();
    wire::RangeReading own = reading();
    for (const bool is_of_its_time : {true, false}) {
        gate.on_arrival(kNode, own, kNow);
        if (is_of_its_time) {
            gate.on_health(kNode, health(0, 0, kUseless));
            EXPECT_EQ(gate.check(kNode, own, captured, kNow).error(), ReadingReason::time_uncertain);
            gate.on_health(kNode, health(0));
        } else {
            EXPECT_EQ(gate.skip(kNode, own, kNow), std::nullopt);
        }
        wire::RangeReading forged = own;
        forged.range_mm = 300;
        gate.on_arrival(kNode, forged, kNow);
        EXPECT_EQ(gate.check(kNode, forged, captured, kNow).error(), ReadingReason::contradicts_reading);
        EXPECT_EQ(gate.skip(kNode, forged, kNow), ReadingReason::duplicate) << "it was here already";
        EXPECT_EQ(gate.skip(kNode, own, kNow), ReadingReason::duplicate);
        ++own.sequence;
    }
    EXPECT_EQ(gate.senders(kNode, 0).contradictions(), 2U);
    EXPECT_TRUE(gate.senders(kNode, 0).is_disputed(kNow));
}

TEST(RangeGate, compares_no_numbers_while_now_is_unknown) {
    RangeGate gate = informed_gate();
    wire::RangeReading given = reading();
    EXPECT_EQ(gate.skip(kNode, given, std::nullopt), std::nullopt);
    given.range_mm = 300;
    EXPECT_EQ(gate.skip(kNode, given, kNow), std::nullopt);
    EXPECT_EQ(gate.senders(kNode, 0).contradictions(), 0U);
}

TEST(RangeGate, counts_no_gap_across_readings_of_uncertain_time) {
    RangeGate gate = informed_gate();
    EXPECT_TRUE(check_with(gate, 0).has_value());
    wire::RangeReading given = reading();
    for (std::uint8_t k = 1; k <= 5; ++k) {
        given.sequence = k;
        const HostTime later = kNow + Nanoseconds{k * 33'000'000};
        const Nanoseconds bound{k < 5 ? 6'000'000 : 0};
        const auto outcome = gate.check(kNode, given, {later - Nanoseconds{20'000'000}, bound}, later);
        EXPECT_EQ(outcome.has_value(), k == 5);
    }
    EXPECT_EQ(gate.record(kNode, 0).sequence.gaps(), 0U);
}

TEST(RangeGate, counts_what_came_and_what_was_lost_by_the_nodes_own_count) {
    RangeGate gate(rig(), false);
    const auto arrive = [&](int count) {
        for (int i = 0; i < count; ++i) {
            gate.on_arrival(kNode, wire::RangeReading{}, std::nullopt);
        }
    };
    arrive(7);
    gate.on_health(kNode, health(0, 65'000));
    EXPECT_EQ(gate.record(kNode, 0).sent.lost(), 0U) << "what was sent before is not known";
    arrive(90);
    gate.on_health(kNode, health(0, 65'100));
    EXPECT_EQ(gate.record(kNode, 0).sent.lost(), 10U);
    arrive(900);
    gate.on_health(kNode, health(0, 464));  // 65'100 + 900, modulo 65'536
    EXPECT_EQ(gate.record(kNode, 0).sent.lost(), 10U);
    EXPECT_EQ(gate.record(kNode, 0).received, 997U);
    arrive(11);
    gate.on_health(kNode, health(0, 464));
    EXPECT_EQ(gate.record(kNode, 0).sent.lost(), 0U) << "readings overtook the message";
}

/// Of a reading of this number, captured so long after kNow, and 20 ms later here.
std::optional<ReadingReason> fate_of_next(RangeGate& gate, unsigned number, std::int64_t captured_ms) {
    wire::RangeReading next = reading();
    next.sequence = static_cast<std::uint8_t>(number % wire::kSequenceCount);
    const HostTime captured = kNow + Nanoseconds{captured_ms * 1'000'000};
    gate.on_arrival(kNode, next, captured);
    const auto outcome =
        gate.check(kNode, next, {captured, Nanoseconds{0}}, captured + Nanoseconds{20'000'000});
    return outcome ? std::nullopt : std::optional(outcome.error());
}

// Another sender's reading would come 235 ms before its true twin, and nothing waits so long.
TEST(RangeGate, has_half_a_period_between_readings_until_a_second_of_heartbeats_said_another_period) {
    HostRig slow = rig();
    slow.nodes[0].sensors[0].period = std::chrono::milliseconds(250);
    const auto heartbeats = [](RangeGate& gate, std::int64_t from_ms, std::int64_t to_ms, int each_other) {
        int count = 0;
        for (std::int64_t ms = from_ms; ms <= to_ms; ms += 50) {
            const bool is_forged = each_other == 0 || count++ % each_other == 0;
            gate.on_rate(kNode, is_forged, kNow + Nanoseconds{ms * 1'000'000});
        }
    };
    for (const int each_other : {0, 2, 3}) {  // all of them, or forged ones among the node's own
        RangeGate gate(slow, false);
        gate.on_health(kNode, health(0));
        EXPECT_EQ(fate_of_next(gate, 1, 0), std::nullopt);
        heartbeats(gate, 0, 950, each_other);
        EXPECT_EQ(fate_of_next(gate, 2, 124), ReadingReason::too_soon) << "by now a second is not over";
        EXPECT_EQ(fate_of_next(gate, 5, 950), std::nullopt);
        heartbeats(gate, 1'000, 1'050, each_other);
        EXPECT_EQ(fate_of_next(gate, 6, 1'040),
                  each_other == 0 ? std::nullopt : std::optional(ReadingReason::too_soon));
    }
}

TEST(RangeGate, counts_a_duplicate_as_received_once) {
    RangeGate gate = informed_gate();
    const MappedTime captured{kNow - Nanoseconds{20'000'000}, Nanoseconds{0}};
    for (int i = 0; i < 2; ++i) {
        gate.on_arrival(kNode, wire::RangeReading{}, std::nullopt);
        const auto outcome = gate.check(kNode, reading(), captured, kNow);
        EXPECT_EQ(outcome.has_value(), i == 0);
    }
    EXPECT_EQ(gate.record(kNode, 0).received, 1U);
}

TEST(RangeGate, begins_sequences_anew_for_a_node_that_restarted) {
    RangeGate gate = informed_gate();
    wire::RangeReading given = reading();
    given.sequence = 40;
    const Nanoseconds age{20'000'000};
    EXPECT_TRUE(gate.check(kNode, given, {kNow - age, Nanoseconds{0}}, kNow).has_value());
    gate.forget(kNode);
    gate.on_health(kNode, health(0));
    given.sequence = 0;
    const HostTime later = kNow + Nanoseconds{1'000'000'000};
    EXPECT_TRUE(gate.check(kNode, given, {later - age, Nanoseconds{0}}, later).has_value());
    EXPECT_EQ(gate.record(kNode, 0).sequence.gaps(), 0U);
}

}  // namespace
}  // namespace octoskin
