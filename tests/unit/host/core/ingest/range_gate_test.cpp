#include "host/core/ingest/range_gate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/range_status.hpp"

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

Result<RangeMeasurement, ReadingReason> check(const wire::RangeReading& reading, bool uses_no_return = false,
                                              std::int64_t age_ms = 20) {
    RangeGate gate(rig(), uses_no_return);
    gate.on_arrival(kNode, reading.sensor);
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

TEST(RangeGate, counts_what_came_and_what_was_lost_by_the_nodes_own_count) {
    RangeGate gate(rig(), false);
    const auto health = [](std::uint16_t sent) {
        return wire::SensorHealth{.sensor = 0,
                                  .state = wire::SensorState::ranging,
                                  .fault = wire::SensorFault::none,
                                  .sent = sent,
                                  .capture_bound_64us = 1,
                                  .rejected = 0,
                                  .period_error_permille = 0};
    };
    const auto arrive = [&](int count) {
        for (int i = 0; i < count; ++i) {
            gate.on_arrival(kNode, 0);
        }
    };
    arrive(7);
    gate.on_health(kNode, health(65'000));
    EXPECT_EQ(gate.record(kNode, 0).lost, 0U) << "what was sent before is not known";
    arrive(90);
    gate.on_health(kNode, health(65'100));
    EXPECT_EQ(gate.record(kNode, 0).lost, 10U);
    arrive(900);
    gate.on_health(kNode, health(464));  // 65'100 + 900, modulo 65'536
    EXPECT_EQ(gate.record(kNode, 0).lost, 10U);
    EXPECT_EQ(gate.record(kNode, 0).received, 997U);
    arrive(11);
    gate.on_health(kNode, health(464));
    EXPECT_EQ(gate.record(kNode, 0).lost, 0U) << "readings overtook the message";
}

TEST(RangeGate, counts_a_duplicate_as_received_once) {
    RangeGate gate(rig(), false);
    const MappedTime captured{kNow - Nanoseconds{20'000'000}, Nanoseconds{0}};
    for (int i = 0; i < 2; ++i) {
        gate.on_arrival(kNode, 0);
        const auto outcome = gate.check(kNode, reading(), captured, kNow);
        EXPECT_EQ(outcome.has_value(), i == 0);
    }
    EXPECT_EQ(gate.record(kNode, 0).received, 1U);
}

TEST(RangeGate, begins_sequences_anew_for_a_node_that_restarted) {
    RangeGate gate(rig(), false);
    wire::RangeReading given = reading();
    given.sequence = 40;
    const Nanoseconds age{20'000'000};
    EXPECT_TRUE(gate.check(kNode, given, {kNow - age, Nanoseconds{0}}, kNow).has_value());
    gate.forget(kNode);
    given.sequence = 0;
    const HostTime later = kNow + Nanoseconds{1'000'000'000};
    EXPECT_TRUE(gate.check(kNode, given, {later - age, Nanoseconds{0}}, later).has_value());
    EXPECT_EQ(gate.record(kNode, 0).sequence.gaps(), 0U);
}

}  // namespace
}  // namespace octoskin
