// The problems of the daemon: their codes and figures, when each begins and when it is over.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/range_status.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "common/wire/names.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/status.hpp"
#include "host/core/rig/sensor_text.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::Optional;

constexpr std::uint8_t kWrappedTarget = 7;  ///< a device status: no range
constexpr const char* kNodeOne = "node 1 'node 1'";
constexpr const char* kGoodSensor = "node 1 'node 1' sensor 0 'good'";
constexpr const char* kSpareSensor = "node 1 'node 1' sensor 5 'good'";

TEST(ProblemMeanings, are_in_the_order_of_the_codes_with_unique_names) {
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < kProblemMeanings.size(); ++i) {
        const ProblemMeaning& each = kProblemMeanings.at(i);
        EXPECT_EQ(static_cast<std::size_t>(each.code), i) << each.name;
        EXPECT_EQ(name_of(each.code), each.name);
        EXPECT_FALSE(each.meaning.empty()) << each.name;
        EXPECT_TRUE(names.insert(each.name).second) << each.name << " is not unique";
    }
}

class ProblemsTest : public DaemonViewTest {
  protected:
    void set_health(Scene& scene, double at_s, wire::SensorState state, wire::SensorFault fault) {
        scene.bus.send(at_s, wire::SensorHealth{.sensor = kGood, .state = state, .fault = fault}, kLeft);
    }
    void say_error(std::uint32_t error_class, std::uint8_t controller = 0) {
        wire::CanFrame frame{.can_id = error_class, .is_error = true, .payload_len = 8};
        frame.data[1] = controller;
        say(frame);
    }
};

TEST_F(ProblemsTest, are_none_where_all_is_well) {
    EXPECT_THAT(all_reported(), IsEmpty());
}

// No frame has a stamp then, whatever else may be said of the time.
TEST_F(ProblemsTest, have_a_sensor_whose_readings_do_not_come_and_a_node_none_of_whose_do) {
    const auto of_sensor = [this] { return reported(ProblemCode::sensor_readings_lost, kGoodSensor); };
    const auto of_node = [this] { return reported(ProblemCode::node_readings_lost, kNodeOne); };
    ASSERT_EQ(sensor_text(scene_.rig.nodes[0], kGood), kGoodSensor);
    const auto play_silence = [&](bool does_another_come, bool is_sending) {
        play_changed(
            [&](Scene& scene) {  // the last reading comes at 3.8 s
                for (int k = 1; k <= 4; ++k) {
                    scene.bus.send(
                        3.5 + 0.5 * k,
                        wire::SensorHealth{.sensor = kGood,
                                           .state = wire::SensorState::ranging,
                                           .sent = static_cast<std::uint16_t>(is_sending ? 10 + 15 * k : 10),
                                           .capture_bound_64us = 3},
                        kLeft);
                }
                for (double t = 3.6; does_another_come && t < 5.6; t += 0.033)
                    scene.bus.range(t, kLeft, good_reading(kSpare));
            },
            5.6);
    };
    play_silence(true, true);
    EXPECT_THAT(of_sensor(), Optional(AllOf(key_is("lost"), what_has("(lost, "))));
    EXPECT_EQ(of_node(), std::nullopt);
    play_silence(false, true);
    EXPECT_EQ(of_sensor(), std::nullopt);
    EXPECT_THAT(of_node(), Optional(AllOf(key_is("lost"), remedy_has("RANGE frames"))));
    play_silence(false, false);
    EXPECT_EQ(of_sensor(), std::nullopt) << "it sends none";
    EXPECT_EQ(of_node(), std::nullopt) << "it sends none";
}

TEST_F(ProblemsTest, have_a_sensor_and_a_node_most_of_whose_readings_are_lost_with_how_many_of_how_many) {
    for (const bool does_another_come : {true, false}) {
        play_changed(
            [&](Scene& scene) {
                for (int k = 0; k <= 4; ++k) {
                    scene.bus.send(4.5 + k,
                                   wire::SensorHealth{.sensor = kGood,
                                                      .state = wire::SensorState::ranging,
                                                      .sent = static_cast<std::uint16_t>(10 + 30 * k),
                                                      .capture_bound_64us = 3},
                                   kLeft);
                    scene.bus.range(4.9 + k, kLeft, good_reading());
                }
                for (double t = 4.5; does_another_come && t < 8.6; t += 0.033)
                    scene.bus.range(t, kLeft, good_reading(kSpare));
            },
            8.6);
        const auto of_sensor = reported(ProblemCode::sensor_readings_lost, kGoodSensor);
        const auto of_node = reported(ProblemCode::node_readings_lost, kNodeOne);
        EXPECT_THAT(does_another_come ? of_sensor : of_node,
                    Optional(AllOf(key_is("lost"), what_has("87 of the 90"))));
        EXPECT_EQ(does_another_come ? of_node : of_sensor, std::nullopt);
    }
}

// What else the node sends does come: heartbeats, NODE_INFO, SYNC_REPORT.
TEST_F(ProblemsTest, have_a_node_and_a_sensor_of_which_neither_readings_nor_health_come) {
    const auto of_sensor = [this] { return reported(ProblemCode::sensor_unheard, kSpareSensor); };
    const auto of_node = [this] { return reported(ProblemCode::node_unheard, kNodeOne); };
    const auto play_without = [&](const std::function<bool(std::uint8_t sensor)>& is_left_out,
                                  double until_s) {
        play(daemon_scene(), kAllWell);  // SENSOR_HEALTH came last at 4.02 s
        auto frames = scene_.bus.frames();
        std::erase_if(frames, [&](const StampedFrame& entry) {
            const auto message = wire::decode(entry.frame);
            const auto* const health = message ? std::get_if<wire::SensorHealth>(&message->message) : nullptr;
            return entry.stamp < wall_at(kAllWell) || (health != nullptr && is_left_out(health->sensor));
        });
        play_on(frames, until_s);
    };
    const auto state = [&](std::uint8_t sensor) {
        return status_json(view_)["nodes"][0]["sensors"][sensor]["state"];
    };
    const auto all = [](std::uint8_t) { return true; };
    play_without(all, 7.0);
    EXPECT_EQ(of_node(), std::nullopt);
    EXPECT_EQ(state(kSpare), "ranging");
    play_without(all, 7.1);
    EXPECT_THAT(of_node(), Optional(remedy_has("(can.busy_s)")));
    EXPECT_EQ(of_sensor(), std::nullopt);
    EXPECT_EQ(state(kSpare), nullptr);
    play_without([](std::uint8_t sensor) { return sensor == kSpare; }, 7.1);
    EXPECT_THAT(of_sensor(), Optional(what_has("SENSOR_HEALTH")));
    EXPECT_EQ(of_node(), std::nullopt);
    EXPECT_EQ(state(kSpare), nullptr);
    EXPECT_EQ(state(kGood), "ranging");
}

TEST_F(ProblemsTest, begin_with_a_clock_of_this_machine_that_shows_nonsense) {
    view_.is_wall_clock_right = false;
    other_end_.reset();
    inputs_->catch_up();
    const std::vector<Problem> all = all_reported();
    ASSERT_GE(all.size(), 2U);
    EXPECT_EQ(all[0].code, ProblemCode::wall_clock_wrong);
    EXPECT_THAT(all[0], remedy_has("timedatectl"));
    EXPECT_EQ(all[1].code, ProblemCode::can_link);
    EXPECT_EQ(all[1].subject, "CAN");
}

TEST_F(ProblemsTest, come_the_most_fundamental_first) {
    play_changed([](Scene& scene) { scene.bus = ScriptedBus{}, scene.depth.clear(); });
    other_end_.reset();
    inputs_->catch_up();
    view_.cameras[0].is_open = false;
    view_.cameras[0].why = "no such device";
    view_.saves.error = "the disk is full";
    EXPECT_THAT(
        all_reported(),
        ElementsAre(is_problem(ProblemCode::can_link, "CAN absent", "can7: closed: No such device"),
                    is_problem(ProblemCode::time_unknown, "", "SYNC"),
                    is_unusable_node("node 1 'node 1': absent"),
                    AllOf(is_problem(ProblemCode::joints_missing, "", "node 10"), what_has("--joints")),
                    is_problem(ProblemCode::camera_closed, "camera", "no such device"),
                    is_problem(ProblemCode::map_not_saved, "", "the disk is full")));
}

TEST_F(ProblemsTest, have_the_adapters_word_until_traffic_proves_it_wrong) {
    say_error(CAN_ERR_BUSOFF);
    const Problem bus_off{.code = ProblemCode::can_link,
                          .on = "CAN bus_off",
                          .what = inputs_->can().why(),
                          .detail = inputs_->can().why(),
                          .subject = "CAN"};
    EXPECT_THAT(all_reported(), ElementsAre(bus_off));
    EXPECT_THAT(bus_off, what_has("`ip link set NAME type can restart-ms 100`"));
    say({.can_id = 5});
    EXPECT_THAT(all_reported(), IsEmpty());
    say_error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE);
    EXPECT_THAT(all_reported(),
                ElementsAre(is_problem(ProblemCode::can_link, "CAN error_passive", inputs_->can().why())));
    EXPECT_THAT(inputs_->can().why(), HasSubstr("error-passive"));
    say({.can_id = 5});
    EXPECT_THAT(all_reported(), IsEmpty());
}

TEST_F(ProblemsTest, have_another_host_for_three_seconds_after_its_sync_unless_this_one_only_listens) {
    view_.now = say_sync(1) + 3 * kSecond - kNs;
    EXPECT_THAT(reported(ProblemCode::another_host), Optional(remedy_has("--listen-only")));
    view_.is_listen_only = true;
    EXPECT_EQ(reported(ProblemCode::another_host), std::nullopt);
    view_.is_listen_only = false;
    view_.now = *inputs_->foreign_sync() + 3 * kSecond;
    EXPECT_EQ(reported(ProblemCode::another_host), std::nullopt);
}

TEST_F(ProblemsTest, have_a_bus_whose_time_went_back_for_a_minute) {
    view_.used.time_back = view_.now - 60 * kSecond + kNs;
    EXPECT_THAT(reported(ProblemCode::time_back),
                Optional(AllOf(key_is("times_back"), what_has("(times_back, 0)"))));
    view_.used.time_back = view_.now - 60 * kSecond;
    EXPECT_EQ(reported(ProblemCode::time_back), std::nullopt);
}

TEST_F(ProblemsTest, have_a_bus_whose_time_leapt_ahead_for_a_minute) {
    view_.used.time_ahead = view_.now - 60 * kSecond + kNs;
    EXPECT_THAT(reported(ProblemCode::time_ahead),
                Optional(AllOf(key_is("times_ahead"), what_has("(times_ahead, 0)"))));
    view_.used.time_ahead = view_.now - 60 * kSecond;
    EXPECT_EQ(reported(ProblemCode::time_ahead), std::nullopt);
}

TEST_F(ProblemsTest, have_a_time_that_nobody_tells_until_somebody_does) {
    play(daemon_scene(), 0.09);
    EXPECT_THAT(reported(ProblemCode::time_unknown),
                Optional(AllOf(key_is("can.not_sent"), what_has("(can.not_sent, 0)"))));
    view_.is_listen_only = true;
    EXPECT_THAT(reported(ProblemCode::time_unknown),
                Optional(AllOf(key_is(""), what_has("FOLLOW_UP"), remedy_has("--listen-only"))));
    play(daemon_scene(), 0.2);
    EXPECT_EQ(reported(ProblemCode::time_unknown), std::nullopt);
}

TEST_F(ProblemsTest, have_no_time_from_our_own_sync_alone) {
    Scene scene = daemon_scene();
    scene.rig.nodes[0].node_id = 44;  // of those that speak none is the rig's
    scene.rig.joint_sources.at(0).node_id = 45;
    play(scene, 0.2);
    ASSERT_TRUE(pipeline_->now());
    EXPECT_THAT(reported(ProblemCode::time_unknown),
                Optional(AllOf(key_is(""), what_has("no node is active"), Not(what_has("SYNC")))));
    view_.is_listen_only = true;
    EXPECT_EQ(reported(ProblemCode::time_unknown), std::nullopt);
}

// It is not that a SYNC is missing, or a node.
TEST_F(ProblemsTest, have_a_time_in_doubt_with_what_made_it_so) {
    const auto doubt = [this] { return reported(ProblemCode::time_in_doubt).value_or(Problem{}).detail; };
    ScriptedBus after_silence;
    for (int i = 0; i < 6; ++i) after_silence.heartbeat(5.0 + 0.1 * i, node_of(scene_, kLeft));
    play_on(after_silence.frames(), 5.55);
    EXPECT_THAT(reported(ProblemCode::time_in_doubt),
                Optional(AllOf(detail_is("stamps"), what_has("over 0.14 s"))));
    EXPECT_EQ(reported(ProblemCode::time_unknown), std::nullopt);

    const auto exchange = [](ScriptedBus& bus, std::uint8_t sequence, double at_s, double reported_s) {
        bus.send(at_s, wire::Sync{sequence}, wire::kHostId);
        const auto host_us = static_cast<std::uint64_t>(std::llround(reported_s * 1e6));
        bus.send(at_s + 0.001, wire::FollowUp{sequence, host_us}, wire::kHostId);
    };
    ScriptedBus reported_again;
    exchange(reported_again, 20, 5.6, 5.6);
    play_on(reported_again.frames(), 5.65);
    EXPECT_NE(doubt(), "stamps");
    ScriptedBus reported_otherwise;
    exchange(reported_otherwise, 21, 5.7, 5.73);
    play_on(reported_otherwise.frames(), 5.75);
    EXPECT_THAT(reported(ProblemCode::time_in_doubt),
                Optional(AllOf(detail_is("exchanges"), what_has("over 20 ms"))));
    EXPECT_EQ(reported(ProblemCode::time_unknown), std::nullopt);
    view_.is_listen_only = true;
    EXPECT_EQ(doubt(), "exchanges") << "whoever sends SYNC";
}

TEST_F(ProblemsTest, have_each_node_that_is_not_usable_and_nothing_of_its_sensors) {
    play_changed([&](Scene& scene) {
        scene.rig = one_joint_rig();
        set_health(scene, 4.5, wire::SensorState::lost, wire::SensorFault::no_answer);
    });
    EXPECT_THAT(all_reported(),
                ElementsAre(AllOf(is_problem(ProblemCode::sensor_not_ranging, kGoodSensor, "lost, no_answer"),
                                  detail_is("lost, no_answer")),
                            is_unusable_node("node 2 'node 2': absent"),
                            is_unusable_node("node 3 'node 3': absent")));
    play(scene_, 9.4);  // its newest heartbeat came at 9.0 s
    EXPECT_THAT(all_reported(), testing::Contains(is_unusable_node("node 1 'node 1': lost")));
    EXPECT_EQ(reported(ProblemCode::sensor_not_ranging, kGoodSensor), std::nullopt);
}

TEST_F(ProblemsTest, have_a_sensor_that_does_not_range_but_for_its_start_until_it_ranges) {
    using enum wire::SensorState;
    for (const auto state : {absent, starting, ranging, stopped, degraded, lost}) {
        play_changed([&](Scene& scene) { set_health(scene, 4.5, state, wire::SensorFault::bus_error); });
        const std::vector<Problem> all = all_reported();
        if (state == ranging || state == starting) {
            EXPECT_THAT(all, IsEmpty());
            continue;
        }
        const std::string expected = std::string(wire::name(state)) + ", bus_error";
        ASSERT_EQ(all.size(), 1U) << expected;
        EXPECT_EQ(all[0].code, ProblemCode::sensor_not_ranging);
        EXPECT_EQ(all[0].text(), std::string(kGoodSensor) + ": " + expected);
    }
    play_changed([&](Scene& scene) {
        set_health(scene, 4.4, lost, wire::SensorFault::bus_error);
        set_health(scene, 4.5, ranging, wire::SensorFault::bus_error);
    });
    EXPECT_THAT(all_reported(), IsEmpty());
}

TEST_F(ProblemsTest, have_the_register_that_a_sensor_is_withheld_for_and_the_key_that_leaves_it_out) {
    const auto say_fault = [](Scene& scene, double at_s, wire::FaultKind kind) {
        const wire::RegisterReport report{kGood, 0x47, 0x0B, 0x0C};
        scene.bus.send(at_s, wire::InfoFault{.kind = kind, .where = report.where()}, kLeft);
    };
    const std::string state = "degraded, config_mismatch";
    play_changed([&](Scene& scene) {
        set_health(scene, 4.4, wire::SensorState::degraded, wire::SensorFault::config_mismatch);
        say_fault(scene, 4.5, wire::FaultKind::register_fixed);
    });
    EXPECT_THAT(reported(ProblemCode::sensor_not_ranging, kGoodSensor),
                Optional(AllOf(detail_is(state), what_has("0x47"), what_has("0x0B"), what_has("0x0C"),
                               what_has("verification: {leave_out: [0x47]}"))));
    play_changed([&](Scene& scene) {
        set_health(scene, 4.4, wire::SensorState::degraded, wire::SensorFault::config_mismatch);
    });
    EXPECT_THAT(all_reported(), ElementsAre(testing::Property("text", &Problem::text,
                                                              std::string(kGoodSensor) + ": " + state)))
        << "its node has not named it yet";
    play_changed([&](Scene& scene) { say_fault(scene, 4.5, wire::FaultKind::register_alike); });
    EXPECT_THAT(all_reported(), IsEmpty()) << "how this type of part is is no problem";
}

TEST_F(ProblemsTest, have_a_sensor_whose_readings_are_nearly_all_rejected_until_two_are_used) {
    const auto with_readings = [&](int bad, int good) {
        play_changed(
            [&](Scene& scene) {
                wire::RangeReading reading = good_reading(kSpare);
                for (int k = 0; k < bad + good; ++k) {
                    reading.device_status = k < bad ? kWrappedTarget : kDeviceStatusComplete;
                    scene.bus.range(4.0 + 0.035 * k, kLeft, reading);
                }
            },
            4.05 + 0.035 * (bad + good));
        return reported(ProblemCode::sensor_rejected, kSpareSensor);
    };
    EXPECT_EQ(with_readings(31, 0), std::nullopt);
    const auto streak = with_readings(32, 0);
    EXPECT_THAT(streak, Optional(AllOf(key_is("status_fault"), what_has("32 readings"),
                                       what_has("docs/hardware/fault-table.md"))));
    EXPECT_EQ(with_readings(32, 1), streak);
    EXPECT_EQ(with_readings(32, 2), std::nullopt);
}

TEST_F(ProblemsTest, have_two_senders_under_one_sensor_s_name_until_a_second_after_the_last_sign) {
    const auto with_forged = [&](int forged, double until_s) {
        play_changed(
            [&](Scene& scene) {
                for (int k = 0; k < 20; ++k) {
                    wire::RangeReading reading =
                        scene.bus.range(4.0 + 0.035 * k, kLeft, good_reading(kSpare));
                    reading.range_mm = 200;
                    if (k < forged) scene.bus.send(4.016 + 0.035 * k, wire::Range{reading}, kLeft);
                }
            },
            until_s);
        return reported(ProblemCode::sensor_two_senders, kSpareSensor);
    };
    EXPECT_EQ(with_forged(1, 4.2), std::nullopt) << "one may be a damaged frame";
    EXPECT_THAT(with_forged(2, 4.2),
                Optional(AllOf(key_is("contradictions"), what_has("(contradictions 2, strays 0)"),
                               what_has("stay out of the map"), remedy_has("node id"))));
    EXPECT_NE(with_forged(2, 5.04), std::nullopt);
    EXPECT_EQ(with_forged(2, 5.06), std::nullopt);
}

TEST_F(ProblemsTest, have_two_answers_to_one_sync_for_two_and_a_half_seconds_of_any_node_that_keeps_time) {
    const auto with_answer = [&](wire::NodeId node, double until_s) {
        play_changed(
            [&](Scene& scene) {
                const std::uint8_t newest = 4;  // of the exchange at 4.1 s
                scene.bus.send(4.1015, wire::SyncReport{newest, scene.bus.node_time(node, 4.16)}, node);
            },
            until_s);
        return reported(ProblemCode::node_two_answers, node == kLeft ? kNodeOne : "node 10 'joints'");
    };
    EXPECT_EQ(with_answer(kLeft, 4.1016), std::nullopt) << "one alone";
    EXPECT_THAT(with_answer(kLeft, 4.2),
                Optional(AllOf(key_is("sync_contradicted"), what_has("(sync_contradicted, 1)"),
                               remedy_has("node id"))));
    EXPECT_EQ(status_json(view_)["nodes"][0]["clock_contradictions"], 1);
    EXPECT_NE(with_answer(kJoints, 4.2), std::nullopt);
    EXPECT_NE(with_answer(kLeft, 4.5), std::nullopt);
    set_now(6.61);
    EXPECT_EQ(reported(ProblemCode::node_two_answers), std::nullopt);
}

TEST_F(ProblemsTest, have_a_node_that_started_anew_for_three_seconds) {
    const auto with_start = [&](wire::NodeId node, double until_s) {
        play_changed(
            [&](Scene& scene) {
                wire::Heartbeat starting{};
                starting.state = wire::NodeState::starting;
                starting.uid_crc = crc16(ScriptedBus::uid_of(node));
                starting.node_hash_low = static_cast<std::uint16_t>(scene.rig.nodes[0].node_hash);
                scene.bus.send(4.25, starting, node);
            },
            until_s);
        return reported(ProblemCode::node_restarts, kNodeOne);
    };
    EXPECT_EQ(with_start(kLeft, 4.24), std::nullopt);
    EXPECT_THAT(with_start(kLeft, 4.26), Optional(AllOf(key_is("restarts"), what_has("(restarts, 1)"),
                                                        remedy_has("supply"), remedy_has("sender"))));
    EXPECT_EQ(status_json(view_)["nodes"][0]["restarts"], 1);
    set_now(7.26);
    EXPECT_EQ(reported(ProblemCode::node_restarts), std::nullopt);
}

TEST_F(ProblemsTest, have_a_node_that_loses_over_a_twentieth_of_a_second_s_readings_and_why) {
    const auto with_forged = [&](int each) {
        play_changed(
            [&](Scene& scene) {
                for (int k = 0; k < 28; ++k) {
                    wire::RangeReading reading =
                        scene.bus.range(4.0 + 0.035 * k, kLeft, good_reading(kSpare));
                    reading.sequence = static_cast<std::uint8_t>((reading.sequence + 1) % 64);
                    const NodeTime now = scene.bus.node_time(kLeft, 4.016 + 0.035 * k);
                    reading.capture = wire::classical_residue(now);  // no window of 20 ms has ended then
                    if (k % each == 0) scene.bus.send(4.016 + 0.035 * k, wire::Range{reading}, kLeft);
                }
            },
            4.99);
        return reported(ProblemCode::node_loses_readings, kNodeOne);
    };
    EXPECT_EQ(with_forged(28), std::nullopt) << "one of 29";
    EXPECT_THAT(with_forged(7), Optional(AllOf(key_is("too_young"), what_has("12 %")))) << "four of 32";
}

TEST_F(ProblemsTest, have_a_sensor_that_contradicts_the_camera_from_when_that_is_decided) {
    int reported_after = 0;
    let_camera_contradict([&] {
        const bool is_decided =
            pipeline_->builder().cross_checks()->of(0).evidence(kLeft, kGood).contradicts();
        EXPECT_EQ(reported(ProblemCode::sensor_contradicts_camera, kGoodSensor).has_value(), is_decided);
        reported_after += is_decided ? 0 : 1;
    });
    EXPECT_THAT(reported_after, AllOf(testing::Gt(1), testing::Lt(80)));
    const SensorEvidence evidence = pipeline_->builder().cross_checks()->of(0).evidence(kLeft, kGood);
    EXPECT_THAT(all_reported(),
                ElementsAre(AllOf(is_problem(ProblemCode::sensor_contradicts_camera, kGoodSensor,
                                             std::to_string(evidence.in_free_space) +
                                                 " of its ranges end where the camera"),
                                  what_has(", 0 behind a surface"))));
    // Without the robot taken out of its images the camera says nothing of any sensor.
    Scene scene = daemon_scene();
    scene.mapping.removes_robot_from_depth = false;
    play(scene, kAllWell);
    ASSERT_EQ(pipeline_->builder().cross_checks(), nullptr);
    EXPECT_THAT(all_reported(), IsEmpty());
}

TEST_F(ProblemsTest, have_of_a_lost_nodes_sensors_none_and_none_that_is_over) {
    let_camera_contradict();
    const auto lies = reported(ProblemCode::sensor_contradicts_camera, kGoodSensor);
    ASSERT_TRUE(lies);
    set_now(9.4);
    EXPECT_EQ(reported(ProblemCode::sensor_contradicts_camera), std::nullopt);
    const auto lost = reported(ProblemCode::node_unusable);
    EXPECT_THAT(lost, Optional(is_unusable_node("node 1 'node 1': lost")));
    ASSERT_TRUE(lost);
    EXPECT_EQ(lost->subject, lies->hidden_by) << "else it would be over in the log";
}

// Most of what a sensor with a wrong offset ranges is within what camera and range may be off together.
TEST_F(ProblemsTest, tell_of_a_sensor_that_contradicts_the_camera_nothing_that_acquits_it) {
    SensorEvidence evidence{
        .agreed = 400, .fault = RangeFault::ranges_too_long, .compared = 412, .fitted = 380};
    EXPECT_EQ(describe(evidence),
              "contradicts the camera: its ranges are some centimetres too long: set its offset "
              "(docs/hardware/calibration.md)");
    evidence.in_free_space = 7;
    evidence.behind_surface = 2;
    for (const RangeFault fault :
         {RangeFault::ranges_too_short, RangeFault::often_short, RangeFault::turned, RangeFault::exchanged}) {
        evidence.fault = fault;
        EXPECT_THAT(describe(evidence),
                    HasSubstr(" (7 of its ranges end where the camera sees free space, 2 behind "
                              "a surface)"));
        for (const char* acquits : {"400", "412", "380", "agree"})
            EXPECT_THAT(describe(evidence), Not(HasSubstr(acquits)));
    }
}

TEST_F(ProblemsTest, have_readings_that_are_of_no_use_or_stopped) {
    const auto unused = [this] { return reported(ProblemCode::readings_unused); };
    const auto stopped = [this] { return reported(ProblemCode::readings_stopped); };
    EXPECT_EQ(unused(), std::nullopt);
    view_.now = *view_.used.reading + Nanoseconds{800'000'000};
    EXPECT_EQ(stopped(), std::nullopt);
    view_.now = view_.now + kNs;
    EXPECT_THAT(stopped(), Optional(what_has("counters of readings")));
    play(daemon_scene(), 3.5);
    EXPECT_EQ(unused(), std::nullopt) << "none has come";
    EXPECT_EQ(stopped(), std::nullopt) << "none has come";
    view_.used = {};
    play_changed([](Scene& scene) { scene.rig.range_limits.max_m = 0.1; });
    EXPECT_THAT(unused(), Optional(AllOf(what_has("10 of 10"), what_has("above_range_max (10)"),
                                         what_has("range_limits.max_m"))));
}

TEST_F(ProblemsTest, have_a_map_without_room) {
    play_changed([](Scene& scene) {
        scene.mapping.map.memory_max_mib = 1;
        scene.mapping.map.resolution_m = 0.01;
    });
    const auto& counters = pipeline_->map().counters();
    ASSERT_GT(counters.no_room, 0U);
    EXPECT_THAT(reported(ProblemCode::map_full),
                Optional(AllOf(key_is("map.memory_max_mib"), what_has("(1 MiB)"),
                               what_has(std::to_string(counters.no_room) + " updates"), what_has("(no_room)"),
                               remedy_has("map.memory_max_mib"))));
}

TEST_F(ProblemsTest, have_a_save_and_a_reload_that_failed_until_the_next_goes_well) {
    view_.saves.error = "maps/fused.ot: no space";
    view_.reload_error = "rig.yaml:3: what is that";
    EXPECT_THAT(all_reported(),
                ElementsAre(is_problem(ProblemCode::map_not_saved, "", "maps/fused.ot: no space"),
                            AllOf(is_problem(ProblemCode::reload_refused, "", "rig.yaml:3: what is that"),
                                  detail_is("rig.yaml:3: what is that"))));
    view_.recording_refusal = "no memory";
    EXPECT_THAT(reported(ProblemCode::recording_refused), Optional(what_has("no memory")));
    view_.recording_refusal.clear();
    view_.saves.error.clear();
    view_.reload_error.clear();
    EXPECT_THAT(all_reported(), IsEmpty());
}

TEST_F(ProblemsTest, have_a_recording_that_failed) {
    folder_.write("taken", "no folder");
    Recorder recorder(folder_ / "taken", {}, settings_, *pipeline_, view_.now);
    view_.recorder = &recorder;
    recorder.stop(view_.now);
    ASSERT_TRUE(recorder.wait(10 * kSecond));
    EXPECT_THAT(all_reported(), ElementsAre(is_problem(ProblemCode::recording_failed, "", recorder.error())));
    EXPECT_THAT(recorder.error(), HasSubstr((folder_ / "taken").string()));
}

TEST_F(ProblemsTest, have_a_recording_that_is_not_complete) {
    play_changed([](Scene& scene) { scene.rig.cameras.front().depth_max_m = 40.0; });
    Recorder recorder(folder_ / "recording", {}, settings_, *pipeline_, view_.now);
    view_.recorder = &recorder;
    EXPECT_THAT(all_reported(), IsEmpty());
    recorder.on_depth(flat_frame(4.5, 39'000), {});  // more than a recording can hold
    EXPECT_THAT(all_reported(), ElementsAre(AllOf(is_problem(ProblemCode::recording_incomplete, "", "replay"),
                                                  key_is("recording.lost_commits"), remedy_has("lost_depth"),
                                                  remedy_has("32.767 m"))));
}

}  // namespace
}  // namespace octoskin::test
