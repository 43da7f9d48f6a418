// Every reason to reject a reading, provoked once beside a good stream: it is counted once, under its name,
// nothing else is, and the maps stay the same byte for byte.
#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>

#include "common/range_status.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

struct ReadingCase {
    ReadingReason reason;
    std::function<void(Scene&)> provoke;
    /// For both runs.
    std::function<void(Scene&)> prepare = [](Scene&) {};
};

void PrintTo(const ReadingCase& given, std::ostream* out) {
    *out << names_of(ReadingReason{})[static_cast<std::size_t>(given.reason)];
}

/// A reading of the silent sensor that differs from a good one only as `change` says.
std::function<void(Scene&)> spare(std::function<void(wire::RangeReading&)> change, double captured_s = 4.0,
                                  double delay_s = 0.015) {
    return [=](Scene& scene) {
        wire::RangeReading reading = good_reading(kSpare);
        change(reading);
        scene.bus.range(captured_s, kLeft, reading, delay_s);
    };
}

/// A good reading of another node.
void of_node(Scene& scene, wire::NodeId node, double captured_s) {
    scene.bus.range(captured_s, node, good_reading());
}

/// node_of(scene, node) with another heartbeat.
wire::Heartbeat heartbeat_of(const Scene& scene, wire::NodeId node) {
    return {.state = wire::NodeState::ranging,
            .reset_cause = wire::ResetCause::power_on,
            .is_rate_overridden = false,
            .is_time_suspect = false,
            .degraded_sensors = 0,
            .uid_crc = crc16(ScriptedBus::uid_of(node)),
            .node_hash_low = static_cast<std::uint16_t>(node_of(scene, node).node_hash & 0xFFFFU)};
}

wire::CanFrame heartbeat_of_another_version(const Scene& scene, wire::NodeId node) {
    const wire::CanFrame frame = wire::encode(heartbeat_of(scene, node), node);
    Payload payload = payload_of(frame);
    set_bits(payload, 0, 3, wire::kProtocolVersion + 1U);
    sign(frame.can_id, payload, 2);
    return frame_of(frame.can_id, false, payload);
}

/// The reports of kThird to the exchanges 0 .. count-1, the last one `error_us` off.
void let_third_hear(Scene& scene, int count, std::uint32_t error_us = 0) {
    for (int k = 0; k < count; ++k) {
        NodeTime heard = scene.bus.node_time(kThird, 0.1 + k);
        heard.us += k == count - 1 ? error_us : 0U;
        scene.bus.send(0.103 + k, wire::SyncReport{static_cast<std::uint8_t>(k), heard}, kThird);
    }
}

const std::vector<ReadingCase>& cases() {
    using R = ReadingReason;
    static const std::vector<ReadingCase> all = {
        {R::node_absent, [](Scene& s) { of_node(s, kRight, 4.0); }},
        {R::node_lost,
         [](Scene& s) {
             s.bus.heartbeat(3.0, node_of(s, kRight));
             s.bus.info(3.0, node_of(s, kRight), 77);
             of_node(s, kRight, 3.34);  // arrives 355 ms after the heartbeat
         }},
        {R::node_version,
         [](Scene& s) {
             s.bus.send(3.5, heartbeat_of_another_version(s, kRight));
             of_node(s, kRight, 4.0);
         }},
        {R::node_quarantined,
         [](Scene& s) {
             keep_alive(s, kRight, 3.0);
             wire::Heartbeat other_board = heartbeat_of(s, kRight);
             other_board.uid_crc ^= 1U;
             s.bus.send(3.95, other_board, kRight);
             of_node(s, kRight, 4.0);
         }},
        {R::node_babbling,
         [](Scene& s) {
             keep_alive(s, kRight, 3.0);  // 108 frames in a second are the most
             for (int i = 0; i < 100; ++i) s.bus.heartbeat(3.95, node_of(s, kRight));
             of_node(s, kRight, 4.0);
         }},
        {R::node_time_suspect,
         [](Scene& s) {
             wire::Heartbeat suspect = heartbeat_of(s, kRight);
             suspect.is_time_suspect = true;
             s.bus.send(3.95, suspect, kRight);
             of_node(s, kRight, 4.0);
         }},
        {R::node_info_incomplete,
         [](Scene& s) {
             s.bus.heartbeat(3.95, node_of(s, kRight));
             of_node(s, kRight, 4.0);
         }},
        {R::node_info_mismatch,
         [](Scene& s) {
             HostNode other = node_of(s, kRight);
             other.node_hash ^= 0x10000U;
             s.bus.heartbeat(3.95, node_of(s, kRight));
             s.bus.info(3.95, other, 77);
             of_node(s, kRight, 4.0);
         }},
        {R::node_build_refused,
         [](Scene& s) {
             s.bus.heartbeat(3.95, node_of(s, kRight));
             s.bus.info(3.95, node_of(s, kRight), 78);
             of_node(s, kRight, 4.0);
         }},
        {R::unknown_sensor, spare([](auto& reading) { reading.sensor = 6; })},
        {R::no_host_time,
         [](Scene& s) {
             s.bus.range(0.05, kLeft, good_reading(kSpare), 0.02);  // before the first SYNC
         }},
        {R::clock_not_ready,
         [](Scene& s) {
             keep_alive(s, kThird);
             of_node(s, kThird, 4.0);
         }},
        {R::clock_in_doubt,
         [](Scene& s) {
             keep_alive(s, kThird);
             let_third_hear(s, 4, 20'000);
             of_node(s, kThird, 4.0);
         }},
        {R::clock_silent,
         [](Scene& s) {
             keep_alive(s, kThird);
             let_third_hear(s, 3);
             of_node(s, kThird, 7.5);  // 5.4 s after the last exchange
         }},
        {R::time_uncertain,
         [](Scene& s) {
             s.bus.health(3.9, kLeft, kSpare, 79);  // 5.056 ms
             s.bus.range(4.0, kLeft, good_reading(kSpare));
         }},
        {R::duplicate,
         [](Scene& s) {
             for (const StampedFrame& entry : s.bus.frames()) {
                 if (entry.stamp == wall_at(3.505 + 0.015)) {
                     s.bus.send(3.53, entry.frame);
                     return;
                 }
             }
         }},
        {R::contradicts_reading,
         [](Scene& s) {  // the first once more, 10 cm further
             wire::RangeReading reading = good_reading();
             reading.range_mm = 620;
             reading.capture = wire::classical_residue(s.bus.node_time(kLeft, 3.505));
             s.bus.send(3.53, wire::Range{reading}, kLeft);
         }},
        {R::out_of_window,
         [](Scene& s) {  // captured before the last good reading, numbered eleven after it
             wire::RangeReading reading = good_reading();
             reading.sequence = 20;
             reading.capture = wire::classical_residue(s.bus.node_time(kLeft, 3.785));
             s.bus.send(3.83, wire::Range{reading}, kLeft);
         }},
        {R::too_soon,
         [](Scene& s) {  // 14 ms after the reading captured at 3.802
             wire::RangeReading reading = good_reading();
             reading.sequence = 10;
             reading.capture = wire::classical_residue(s.bus.node_time(kLeft, 3.816));
             s.bus.send(3.83, wire::Range{reading}, kLeft);
         }},
        {R::too_young, spare([](auto&) {}, 4.0, 0.004)},
        {R::too_old, spare([](auto&) {}, 4.0, 0.112)},
        {R::sensor_misconfigured,
         [](Scene& s) {
             const wire::SensorHealth health{.sensor = kSpare,
                                             .state = wire::SensorState::degraded,
                                             .fault = wire::SensorFault::config_mismatch,
                                             .sent = 0,
                                             .capture_bound_64us = 3,
                                             .rejected = 0,
                                             .period_error_permille = 0};
             s.bus.send(3.95, health, kLeft);
             s.bus.range(4.0, kLeft, good_reading(kSpare));
         }},
        {R::no_return, spare([](auto& reading) { reading.device_status = kDeviceStatusNoTarget; })},
        {R::status_fault,
         spare([](auto& reading) { reading.device_status = kDeviceStatusCompleteNoWrapCheck; })},
        {R::zone_unknown, spare([](auto& reading) { reading.zone = wire::kZoneUnknown; })},
        {R::zone_not_in_rig, spare([](auto& reading) { reading.zone = 1; })},
        {R::not_finite, spare([](auto& reading) { reading.sensor = kNoOffset; })},
        {R::below_range_min, spare([](auto& reading) { reading.range_mm = 39; })},
        {R::above_range_max, spare([](auto& reading) { reading.range_mm = 4001; })},
        {R::sigma_above_max, spare([](auto& reading) { reading.sigma_quarter_mm = 404; }),
         [](Scene& s) { s.rig.range_limits.sigma_max_m = 0.1; }},
        {R::outside_marks, spare([](auto&) {}, 3.1),
         [](Scene& s) {
             s.config.begin = MapBegin::start_mark;
             s.bus.send(3.2, wire::Mark{wire::MarkKind::start, 3'200'000}, wire::kHostId);
         }},
        {R::late, spare([](auto&) {}, 3.8510, 0.1095),
         [](Scene& s) {
             // A lag below the age limit, and a good reading just before: it is in the map when the other
             // comes.
             s.config.lag = std::chrono::milliseconds(101);
             s.bus.range(3.8515, kLeft, good_reading());
         }},
        {R::joints_missing, spare([](auto&) {}, 7.15)},
        {R::self_hit, spare([](auto& reading) { reading.sensor = kInward; })},
        {R::beam_not_valid, spare([](auto& reading) { reading.sensor = kLostPose; })},
        {R::outside_map, spare([](auto& reading) { reading.sensor = kFar; })},
        {R::cone_too_large, spare([](auto& reading) { reading.device_status = kDeviceStatusNoTarget; }),
         [](Scene& s) {  // 30 m of a cone, as no program begins with
             s.mapping.range_update = RangeUpdate::cone;
             s.mapping.no_return_clear_m = 30.0;
             s.mapping.removes_robot_from_ranges = false;
             s.rig.nodes[0].sensors[kSpare].zones[0].optics = {.half_angle_rad = 0.3, .sigma_rad = 0.2};
         }},
    };
    return all;
}

class ReadingReasons : public testing::TestWithParam<ReadingCase> {};

TEST_P(ReadingReasons, are_counted_once_and_leave_the_maps_alone) {
    const ReadingCase& given = GetParam();
    Scene good = good_scene();
    given.prepare(good);
    Scene bad = good;
    given.provoke(bad);
    const RunResult expected = run(good);
    const RunResult result = run(bad);
    const auto& readings = result.inputs.readings;
    EXPECT_EQ(readings.in(), expected.inputs.readings.in() + 1) << result.inputs_text;
    EXPECT_EQ(readings.rejected(given.reason), expected.inputs.readings.rejected(given.reason) + 1)
        << result.inputs_text;
    EXPECT_EQ(readings.rejected(), expected.inputs.readings.rejected() + 1) << result.inputs_text;
    EXPECT_EQ(readings.used(), expected.inputs.readings.used());
    EXPECT_GT(readings.used(), 0U);
    EXPECT_TRUE(result.has_equal_maps(expected));
}

std::string name_of_case(const testing::TestParamInfo<ReadingCase>& given) {
    return names_of(ReadingReason{})[static_cast<std::size_t>(given.param.reason)];
}
INSTANTIATE_TEST_SUITE_P(Each, ReadingReasons, testing::ValuesIn(cases()), name_of_case);

TEST(ReadingReasonsAll, have_a_case_each) {
    std::set<ReadingReason> seen = {ReadingReason::queue_overflow,       // below
                                    ReadingReason::sensor_disputed,      // below
                                    ReadingReason::contradicts_camera};  // cross_check_wiring_test
    for (const ReadingCase& given : cases()) {
        EXPECT_TRUE(seen.insert(given.reason).second);
    }
    EXPECT_EQ(seen.size(), names_of(ReadingReason{}).size());
}

TEST(ReadingReasonsAll, keep_a_sensor_out_that_two_senders_have_until_a_second_after_the_last_sign) {
    Scene good = good_scene();
    Scene bad = good;
    std::uint8_t sequence = 0;
    // Twice as quick as the rig says they would be the one before: each 33 ms.
    for (double t = 5.0; t < 7.0; t += 0.033) {
        wire::RangeReading reading = good_reading(kSpare);
        reading.sequence = sequence++ % 64;
        reading.capture = wire::classical_residue(bad.bus.node_time(kLeft, t));
        bad.bus.send(t + 0.015, wire::Range{reading}, kLeft);
        if (t > 5.2) continue;  // of seven the number comes with other contents, too
        reading.range_mm += 100;
        bad.bus.send(t + 0.016, wire::Range{reading}, kLeft);
    }
    const auto& before = run(good).inputs.readings;
    const RunResult result = run(bad);
    const auto& readings = result.inputs.readings;
    EXPECT_EQ(readings.in() - before.in(), 61U + 7U) << result.inputs_text;
    // Seven, and the second one's twin, which waited.
    EXPECT_EQ(readings.rejected(ReadingReason::contradicts_reading), 7U + 1U) << result.inputs_text;
    // Between 5.049 s and 6.214 s.
    EXPECT_EQ(readings.rejected(ReadingReason::sensor_disputed), 35U) << result.inputs_text;
    EXPECT_EQ(readings.used() - before.used(), 61U - 1U - 35U) << result.inputs_text;
}

TEST(ReadingReasonsAll, drop_the_oldest_where_too_many_wait) {
    Scene good = good_scene();
    Scene crowded = good;
    crowded.config.waiting_max.readings = 3;
    const RunResult expected = run(good);
    const RunResult result = run(crowded);
    // Every 33 ms one, each waits 250 ms: seven at a time, and the last three get through.
    EXPECT_EQ(result.inputs.readings.used(), 3U);
    EXPECT_EQ(result.inputs.readings.rejected(ReadingReason::queue_overflow), 7U);
    EXPECT_EQ(result.depth_ot, expected.depth_ot);
}

}  // namespace
}  // namespace octoskin::test
