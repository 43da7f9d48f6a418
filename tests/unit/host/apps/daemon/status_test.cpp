// The figures that the daemon tells of itself, each in its unit: of a scene that is known by heart.
#include "host/apps/daemon/status.hpp"
#include "tests/support/evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/monitor/status_meanings.hpp"
#include "host/apps/version/version.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin::test {
namespace {

using Json = nlohmann::ordered_json;
using testing::IsEmpty;

constexpr double kTiny = 1e-9;
constexpr std::uint8_t kWrappedTarget = 7;  ///< a device status: no range

class StatusTest : public DaemonViewTest {
  protected:
    [[nodiscard]] Json status() const { return status_json(view_); }
    [[nodiscard]] Json sensor(std::size_t index) const { return status()["nodes"][0]["sensors"][index]; }
};

TEST_F(StatusTest, has_who_it_is_how_long_it_runs_and_what_is_wrong) {
    view_.started = host_at(1.05);
    const Json well = status();
    EXPECT_EQ(well["octoskin"], program_version());
    EXPECT_EQ(well["uptime_s"], 3.5);
    EXPECT_EQ(well["rig"], "one joint");
    EXPECT_EQ(well["problems"], Json::array());
    view_.saves.error = "no room";
    view_.reload_error = "no rig";
    const Json problems = status()["problems"];
    ASSERT_EQ(problems.size(), 2U);
    EXPECT_EQ(problems[0]["code"], "map_not_saved");
    EXPECT_EQ(problems[1]["code"], "reload_refused");
    const std::vector<Problem> all = all_reported();
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(problems[i]["text"], all[i].text());
        EXPECT_EQ(problems[i].size(), 2U) << "empty fields are left out: " << problems[i];
    }
    EXPECT_NE(all[0].what.find("no room"), std::string::npos);
    EXPECT_NE(all[1].what.find("no rig"), std::string::npos);
}

TEST_F(StatusTest, names_links_without_a_body_and_is_content_with_those_that_the_rig_lists) {
    EXPECT_EQ(status()["links_without_body"], Json::array());
    scene_.rig.links_without_body = {{"elbow", true}, {"wrist", false}};
    EXPECT_EQ(status()["links_without_body"], Json({"elbow", "wrist"}));
    EXPECT_EQ(status()["links_unknown"], Json({"wrist"}));
    const auto problem = reported(ProblemCode::links_without_body, "robot: wrist");
    ASSERT_TRUE(problem);
    EXPECT_EQ(status()["problems"], Json::array({Json{{"code", "links_without_body"},
                                                      {"text", problem->text()},
                                                      {"on", "robot: wrist"},
                                                      {"key", "robot.links_without_body"},
                                                      {"remedy", problem->remedy}}}));
    EXPECT_NE(problem->remedy.find("robot.links_without_body"), std::string::npos);
    view_.reloaded = view_.now;
    EXPECT_EQ(status()["problems"].size(), 1U) << "nothing to be learnt anew";
    scene_.rig.links_without_body = {{"elbow", true}};
    EXPECT_EQ(status()["problems"], Json::array());
    EXPECT_EQ(status()["links_with_borrowed_body"], Json::object());
    scene_.rig.links_with_borrowed_body = {{"bolt", "upper"}, {"mount", "wrist"}};
    EXPECT_EQ(status()["links_with_borrowed_body"], Json({{"bolt", "upper"}, {"mount", "wrist"}}));
    EXPECT_EQ(status()["problems"], Json::array()) << "as usual as a bolt";
}

TEST_F(StatusTest, has_what_came_over_the_bus_and_how_long_that_kept_it_busy) {
    // Eight bytes in classical format: 135 bits, at 1 Mbit/s.
    for (int i = 0; i < 2; ++i) say({.can_id = 5, .payload_len = 8});
    view_.is_listen_only = true;
    EXPECT_EQ(status()["can"],
              Json::parse(R"({"interface": "can7", "state": "up", "why": "", "listen_only": true,
        "received": 2, "sent": 0, "not_sent": 0, "foreign_follow_ups": 0, "busy_s": 0.00027, "error_frames": 0, "dropped_by_kernel": 0,
        "malformed": 0, "bus_off": 0, "went_down": 0, "reopened": 0})"));
    other_end_.reset();
    inputs_->catch_up();
    view_.is_listen_only = false;
    const Json gone = status()["can"];
    EXPECT_EQ(gone["state"], "absent");
    EXPECT_EQ(gone["why"], inputs_->can().why());
    EXPECT_EQ(gone["listen_only"], false);
}

TEST_F(StatusTest, has_the_state_of_the_clock) {
    EXPECT_EQ(
        status()["clock"],
        Json::parse(R"({"known": true, "steps_back": 0, "steps_ahead": 0, "stamps_ignored": 0, "relocks": 0,
                  "times_back": 0, "times_ahead": 0, "follow_up_outliers": 0})"));
    for (std::uint8_t sequence = 1; sequence <= 4; ++sequence) {
        const std::uint64_t wrong_us = sequence == 4 ? 500'000 : 0;
        const auto us = static_cast<std::uint64_t>(say_sync(sequence).ns / 1'000);
        say(wire::encode(wire::FollowUp{sequence, us + wrong_us}, wire::kHostId));
    }
    EXPECT_EQ(status()["clock"]["follow_up_outliers"], 1);
    play(daemon_scene(), 0.09);
    EXPECT_EQ(status()["clock"]["known"], false);
}

TEST_F(StatusTest, has_each_node_with_its_clock_in_ppm_and_ms) {
    const Json node = status()["nodes"][0];
    EXPECT_EQ(status()["nodes"].size(), 1U);
    EXPECT_EQ(node["id"], 1);
    EXPECT_EQ(node["name"], "node 1");
    EXPECT_EQ(node["verdict"], "usable");
    EXPECT_EQ(node["reason"], nullptr);
    EXPECT_EQ(node["state"], "ranging");
    EXPECT_NEAR(node["age_s"], 0.05, kTiny) << "its newest heartbeat came at 4.5 s";
    EXPECT_EQ(node["degraded_sensors"], 0);
    EXPECT_EQ(node["clock_known"], true);
    EXPECT_NEAR(node["clock_ppm"], -80.0, 1.0) << "host seconds per second of its clock, which is fast";
    const auto bound = pipeline_->intake().clock(kLeft).error_bound(*view_.bus_now);
    ASSERT_TRUE(bound);
    EXPECT_NEAR(node["clock_error_ms"], static_cast<double>(bound->count()) / 1'000'000, kTiny);
    EXPECT_GT(node["clock_error_ms"], 0.01);
    EXPECT_LT(node["clock_error_ms"], 2.0);
    EXPECT_EQ(node["sensors"].size(), 6U);
}

TEST_F(StatusTest, has_nothing_of_a_node_that_nobody_has_heard) {
    Scene scene = daemon_scene();
    scene.rig.nodes[0].node_id = 44;
    scene.rig.nodes[0].name = "far";
    play(scene, kAllWell);
    Json node = status()["nodes"][0];
    node.erase("sensors");
    EXPECT_EQ(node,
              Json::parse(R"({"id": 44, "name": "far", "verdict": "absent", "reason": null, "state": null,
        "age_s": null, "degraded_sensors": null, "clock_known": false, "clock_ppm": null, "clock_error_ms": null,
        "refused_share": null, "refused_most": null, "clock_contradictions": 0, "restarts": 0, "registers": []})"));
    EXPECT_EQ(
        sensor(0),
        Json::parse(R"({"index": 0, "name": "good", "state": null, "fault": null, "received": 0, "lost": 0,
        "age_s": null, "rejected": null, "contradictions": 0, "strays": 0, "second_sender": false,
        "disputed": false, "reflexes": 0, "reflex_below_m": 0.0, "reflex_m": null,
        "camera": {"of": "", "verdict": "cannot_tell", "contradicts": false, "fault": null, "doubt": "too_few_comparisons",
                   "not_excluded": ["ranges_too_long", "ranges_too_short", "often_short", "turned", "exchanged"],
                   "refused": false, "compared": 0, "fitted": 0,
                   "agreed": 0, "in_free_space": 0, "behind_surface": 0}})"));
}

TEST_F(StatusTest, has_registers_that_read_otherwise_alike_and_of_a_sensor_as_long_as_it_is_not_well) {
    EXPECT_EQ(status()["nodes"][0]["registers"], Json::array());
    const auto say_fault = [this](double at_s, wire::FaultKind kind, const wire::RegisterReport& report) {
        ScriptedBus bus;
        bus.send(at_s, wire::InfoFault{.kind = kind, .where = report.where()}, kLeft);
        play_on(bus.frames(), at_s + 0.001);
    };
    const auto say_health = [this](double at_s, wire::SensorState state, wire::SensorFault fault) {
        ScriptedBus bus;
        bus.send(at_s, wire::SensorHealth{.sensor = kGood, .state = state, .fault = fault}, kLeft);
        play_on(bus.frames(), at_s + 0.001);
    };
    say_fault(4.56, wire::FaultKind::register_alike, {3, 0x7C, 0x00, 0x01});
    say_fault(4.57, wire::FaultKind::register_fixed, {kGood, 0x47, 0x0B, 0x0C});
    const Json alike = Json::parse(
        R"({"register": 124, "written": 0, "read": 1, "alike": true, "sensor": null, "sensors": 3})");
    EXPECT_EQ(status()["nodes"][0]["registers"], Json::array({alike}));
    say_health(4.58, wire::SensorState::degraded, wire::SensorFault::config_mismatch);
    Json own = Json::parse(
        R"({"register": 71, "written": 11, "read": 12, "alike": false, "sensor": 0, "sensors": 1})");
    own["sensor"] = kGood;
    EXPECT_EQ(status()["nodes"][0]["registers"], Json::array({alike, own}));
    say_health(4.59, wire::SensorState::ranging, wire::SensorFault::none);
    EXPECT_EQ(status()["nodes"][0]["registers"], Json::array({alike}));
}

TEST_F(StatusTest, has_why_a_node_is_refused_and_what_it_says_of_its_sensors) {
    Scene scene = daemon_scene();
    scene.rig.nodes[0].node_hash = 0x12345678;
    scene.bus.send(4.52,
                   wire::Heartbeat{.state = wire::NodeState::stopped,
                                   .degraded_sensors = 3,
                                   .uid_crc = crc16(ScriptedBus::uid_of(kLeft)),
                                   .node_hash_low = 0xEE01},
                   kLeft);
    play(scene, kAllWell);
    const Json node = status()["nodes"][0];
    EXPECT_EQ(node["verdict"], "info_mismatch");
    EXPECT_EQ(node["reason"], "low half of node_hash 0000ee01, the rig has 00005678");
    EXPECT_EQ(node["state"], "stopped");
    EXPECT_EQ(node["degraded_sensors"], 3);
}

TEST_F(StatusTest, has_two_senders_under_one_sensor_s_name_and_what_that_costs_its_node) {
    Scene scene = daemon_scene();
    for (int k = 0; k < 4; ++k) {
        wire::RangeReading reading = scene.bus.range(4.3 + 0.035 * k, kLeft, good_reading(kSpare));
        reading.range_mm = 200;
        scene.bus.send(4.3 + 0.035 * k + 0.016, wire::Range{reading}, kLeft);
    }
    play(scene, kAllWell);
    EXPECT_EQ(sensor(kSpare)["contradictions"], 4);
    EXPECT_EQ(sensor(kSpare)["strays"], 0);
    EXPECT_EQ(sensor(kSpare)["second_sender"], true);
    EXPECT_EQ(sensor(kSpare)["disputed"], true);
    EXPECT_EQ(sensor(kGood)["second_sender"], false);
    const Json node = status()["nodes"][0];
    // Of the last second's seven good ones and these eight four contradict and two are disputed; the second
    // one's twin waited, and is out, too.
    EXPECT_DOUBLE_EQ(node["refused_share"], 7.0 / 15.0);
    EXPECT_EQ(node["refused_most"], "contradicts_reading");
}

TEST_F(StatusTest, has_each_sensors_newest_range_in_metres) {
    const Json good = sensor(kGood);
    EXPECT_EQ(good["index"], 0);
    EXPECT_EQ(good["name"], "good");
    EXPECT_EQ(good["state"], "ranging");
    EXPECT_EQ(good["fault"], "none");
    EXPECT_EQ(good["received"], 10);
    EXPECT_EQ(good["lost"], 0);
    EXPECT_NEAR(good["age_s"], 4.55 - 3.817, 1e-6) << "since it came, not since it was taken";
    EXPECT_DOUBLE_EQ(good["range_m"], 1.42);
    EXPECT_DOUBLE_EQ(good["sigma_m"], 0.01);
    EXPECT_EQ(good["device_status"], 9);
    EXPECT_EQ(good["zone"], 0);
    EXPECT_EQ(good["rejected"], nullptr);
    EXPECT_EQ(sensor(kSpare).contains("range_m"), false) << "it said nothing";
}

TEST_F(StatusTest, has_why_a_sensors_newest_reading_was_rejected_and_what_was_lost_before_it) {
    Scene scene = daemon_scene();
    wire::RangeReading reading = good_reading();
    reading.device_status = kWrappedTarget;
    scene.bus.range(4.4, kLeft, reading);
    // 13 were sent since its first SENSOR_HEALTH, and 11 came.
    scene.bus.send(4.52,
                   wire::SensorHealth{.sensor = kGood,
                                      .state = wire::SensorState::degraded,
                                      .fault = wire::SensorFault::reads_disagree,
                                      .sent = 13},
                   kLeft);
    play(scene, kAllWell);
    const Json good = sensor(kGood);
    EXPECT_EQ(good["rejected"], "status_fault");
    EXPECT_EQ(good["device_status"], 7);
    EXPECT_EQ(good["received"], 11);
    EXPECT_EQ(good["lost"], 2);
    EXPECT_EQ(good["state"], "degraded");
    EXPECT_EQ(good["fault"], "reads_disagree");
}

TEST_F(StatusTest, has_how_often_something_came_too_close_to_a_sensor_and_how_close) {
    Scene scene = daemon_scene();
    scene.rig.nodes[0].sensors[kGood].reflex_below_m = 0.15;
    wire::Reflex reflex;
    reflex.sensor = kGood;
    reflex.capture = wire::classical_residue({0});
    for (const std::uint16_t range_mm : std::array<std::uint16_t, 2>{90, 81}) {
        reflex.range_mm = range_mm;
        scene.bus.send(4.4, reflex, kLeft);
    }
    play(scene, kAllWell);
    const Json good = sensor(kGood);
    EXPECT_EQ(good["reflexes"], 2);
    EXPECT_DOUBLE_EQ(good["reflex_below_m"], 0.15);
    EXPECT_DOUBLE_EQ(good["reflex_m"], 0.081);
    EXPECT_EQ(sensor(kSpare)["reflexes"], 0);
}

TEST_F(StatusTest, has_what_the_camera_says_of_a_sensor_or_null_without_one) {
    let_camera_contradict();
    const SensorEvidence& evidence = pipeline_->builder().cross_checks()->of(0).evidence(kLeft, kGood);
    const Json camera = sensor(kGood)["camera"];
    EXPECT_EQ(camera["contradicts"], true);
    EXPECT_EQ(camera["verdict"], "contradicts");
    EXPECT_EQ(camera["doubt"], nullptr);
    EXPECT_EQ(camera["in_free_space"], evidence.in_free_space);
    EXPECT_GT(evidence.in_free_space, 50U);
    EXPECT_EQ(camera["agreed"], evidence.agreed);
    EXPECT_EQ(camera["behind_surface"], evidence.behind_surface);
    EXPECT_EQ(sensor(kSpare)["camera"]["in_free_space"], 0);
    Scene scene = daemon_scene();
    scene.rig.cameras.clear();
    play(scene, kAllWell);
    EXPECT_EQ(sensor(kGood)["camera"], nullptr);
}

TEST_F(StatusTest, has_the_cameras_record_or_null) {
    view_.cameras[0].frames = 60;
    view_.cameras[0].displaced = 3;
    view_.cameras[0].untimed = 2;
    view_.cameras[0].repeated = 7;
    view_.cameras[0].opened = 4;
    view_.cameras[0].why = "was gone";
    Json camera = status()["cameras"][0];
    EXPECT_NEAR(camera["age_s"], 0.05, kTiny);
    camera.erase("age_s");
    EXPECT_EQ(
        camera,
        Json::parse(
            R"({"name": "", "link": "", "device": "", "open": true, "why": "was gone", "frames": 60, "displaced": 3, "untimed": 2,
        "repeated": 7, "opened": 4, "is_off": false, "turned_deg": null, "shifted_m": null, "depth_scale": null,
        "explains_sensors": 0})"));
    view_.cameras[0].newest.reset();
    EXPECT_EQ(status()["cameras"][0]["age_s"], nullptr);
    view_.cameras.clear();
    EXPECT_EQ(status()["cameras"], Json::array());
}

TEST_F(StatusTest, has_what_came_through_the_joint_socket_or_null_without_one) {
    EXPECT_EQ(status()["joints_socket"], nullptr);
    const auto with_socket = inputs_with_joint_socket();
    send_joints("0.5");
    send_joints("0.5");  // sooner than the rig's 100 Hz has it
    send_joints("half a turn");
    send_joints("1 2 3");
    with_socket->catch_up();
    view_.inputs = with_socket.get();
    view_.now = monotonic_now();
    Json reported = status()["joints_socket"];
    ASSERT_EQ(reported["senders"].size(), 1U);
    EXPECT_EQ(reported["senders"][0]["pid"], ::getpid());
    EXPECT_EQ(reported["senders"][0]["uid"], ::getuid());
    EXPECT_EQ(reported["senders"][0]["address"], "");
    EXPECT_EQ(reported["senders"][0]["samples"], 2);
    EXPECT_LT(reported["senders"][0]["age_s"].get<double>(), 1.0);
    reported.erase("senders");
    EXPECT_EQ(reported,
              Json::parse(R"({"samples": 2, "displaced": 0, "surplus": 0, "thinned": 1, "second_sender": 0,
                  "rate_hz": 0.0, "above_rate": false, "joint_node_ignored": 0, "not_a_number": 1,
                  "wrong_count": 1, "time_off": 0, "too_large": 0, "too_long": 0})"));
}

TEST_F(StatusTest, has_the_map_with_its_memory_and_saves) {
    view_.saves = {.saved = 5, .failed = 1, .skipped = 2, .newest = host_at(4.3), .error = {}};
    Json map = status()["map"];
    EXPECT_EQ(map["known_voxels"], pipeline_->map().known_voxels());
    EXPECT_GT(map["known_voxels"], 100);
    EXPECT_EQ(map["resolution_m"], 0.04);
    EXPECT_DOUBLE_EQ(map["memory_mib"], static_cast<double>(pipeline_->map().memory_bytes()) / 1'048'576);
    EXPECT_EQ(map["memory_max_mib"], 800);
    EXPECT_EQ(map["no_room"], 0);
    EXPECT_EQ(map["no_memory"], 0);
    EXPECT_EQ(map["undated"], 0);
    EXPECT_EQ(map["saved"], 5);
    EXPECT_EQ(map["saves_failed"], 1);
    EXPECT_EQ(map["saves_skipped"], 2);
    EXPECT_NEAR(map["saved_age_s"], 0.25, kTiny);
    view_.saves.newest.reset();
    EXPECT_EQ(status()["map"]["saved_age_s"], nullptr);
    EXPECT_EQ(status()["map"]["folder_silent_s"], nullptr);
    view_.maps_silent_since = host_at(1.55);
    EXPECT_NEAR(status()["map"]["folder_silent_s"], 3.0, kTiny);
    EXPECT_NE(reported(ProblemCode::maps_folder_silent), std::nullopt);
}

TEST_F(StatusTest, has_how_much_of_the_map_has_no_time) {
    FusedMap map(MapConfig{.memory_max_mib = 1});
    map.advance_time(HostTime{0});
    std::vector<VoxelUpdate> updates;  // each in a brick and in nodes of its own
    for (std::uint16_t x = 0; x < 100; ++x)
        for (std::uint16_t y = 0; y < 20; ++y)
            updates.push_back(
                {{static_cast<std::uint16_t>(64 * x), static_cast<std::uint16_t>(64 * y), 0}, -0.4F});
    feed(map, updates);
    const std::uint64_t undated = map.counters().undated;
    ASSERT_GT(undated, 0U);
    pipeline_->begin_with(std::move(map));
    EXPECT_EQ(status()["map"]["undated"], undated);
}

TEST_F(StatusTest, counts_no_voxel_that_has_expired_while_nothing_is_measured) {
    FusedMap map(MapConfig{.age = {.stale_after_s = 2, .unknown_after_s = 8}});
    for (std::uint16_t second = 0; second < 4; ++second) {
        map.advance_time(host_at(second));
        feed(map, std::vector<VoxelUpdate>{{{second, 0, 0}, 1.0F}});
    }
    pipeline_->begin_with(std::move(map));
    for (const double now_s : {0.0, 3.5, 7.9, 8.0, 9.5, 10.0, 11.0, 40'000.0}) {
        view_.bus_reckoned = host_at(now_s);
        FusedMap of_query = pipeline_->map().copy();
        of_query.advance_time(view_.bus_reckoned);
        EXPECT_EQ(status()["map"]["known_voxels"], of_query.known_voxels()) << now_s;
    }
    EXPECT_EQ(status()["map"]["known_voxels"], 0);
    EXPECT_EQ(pipeline_->map().known_voxels(), 4U);
}

TEST_F(StatusTest, knows_when_the_buss_time_leapt_ahead) {
    play(daemon_scene(), 6.0);
    EXPECT_FALSE(view_.used.time_ahead);
    // Another host: what it says is an hour ahead of how the frames go on being stamped.
    Scene anew = good_scene();
    std::vector<StampedFrame> frames = anew.bus.frames();
    for (StampedFrame& entry : frames) {
        entry.stamp.ns += 6'000'000'000;
        const auto decoded = wire::decode(entry.frame);
        const auto* said = decoded ? std::get_if<wire::FollowUp>(&decoded->message) : nullptr;
        if (said == nullptr) continue;
        entry.frame = wire::encode(wire::FollowUp{said->sequence, said->host_time_us + 3'600'000'000U},
                                   decoded->node_id);
    }
    play_on(frames, 10.0);
    ASSERT_TRUE(view_.used.time_ahead);
    EXPECT_EQ(status()["clock"]["times_ahead"], 1);
    EXPECT_EQ(status()["clock"]["times_back"], 0);
    EXPECT_NE(reported(ProblemCode::time_ahead), std::nullopt);
}

TEST_F(StatusTest, names_nothing_that_is_learnt_anew_for_three_seconds_after_a_reload) {
    Scene silent = daemon_scene();
    silent.bus = ScriptedBus{};
    play(silent, kAllWell);
    view_.saves.error = "the disk is full";
    view_.reloaded = view_.now - Nanoseconds{2'999'999'999};
    const Json problems = status()["problems"];
    ASSERT_EQ(problems.size(), 1U);
    EXPECT_EQ(problems[0]["code"], "map_not_saved");
    EXPECT_NE(problems[0]["text"].get<std::string>().find("the disk is full"), std::string::npos);
    view_.reloaded = view_.now - Nanoseconds{3'000'000'000};
    EXPECT_NE(reported(ProblemCode::time_unknown), std::nullopt);
    EXPECT_NE(reported(ProblemCode::joints_missing), std::nullopt);
    EXPECT_THAT(reported(ProblemCode::node_unusable),
                testing::Optional(is_unusable_node("node 1 'node 1': absent")));
}

TEST_F(StatusTest, has_the_recording_or_null_and_the_reloads) {
    EXPECT_EQ(status()["recording"], nullptr);
    view_.reloads = {.count = 2, .unchanged = 3, .dropped = 7};
    EXPECT_EQ(status()["reloads"],
              Json::parse(R"({"count": 2, "unchanged": 3, "dropped": 7, "reading_s": null})"));
    view_.reloads.reading_since = host_at(0.55);
    EXPECT_NEAR(status()["reloads"]["reading_s"], 4.0, kTiny);
    EXPECT_NE(reported(ProblemCode::reload_silent), std::nullopt);
    view_.reloads.reading_since.reset();
    Recorder recorder(folder_ / "recording", {}, settings_, *pipeline_, host_at(4.3));
    view_.recorder = &recorder;
    const Json recording = status()["recording"];
    EXPECT_EQ(recording["state"], "recording");
    EXPECT_NEAR(recording["seconds"], 0.25, kTiny);
    EXPECT_EQ(recording["folder"], (folder_ / "recording").string());
}

TEST_F(StatusTest, has_a_balanced_account_of_every_unit_with_the_reasons_that_occurred) {
    Scene scene = daemon_scene();
    wire::RangeReading reading = good_reading();
    reading.device_status = kWrappedTarget;
    scene.bus.range(4.4, kLeft, reading);
    play(scene, kAllWell);
    const Json inputs = status()["inputs"];
    EXPECT_EQ(
        inputs["readings"],
        Json::parse(
            R"({"in": 11, "used": 10, "pending": 0, "rejected": {"status_fault": 1}, "balanced": true})"));
    EXPECT_EQ(inputs["depth frames"],
              Json::parse(R"({"in": 6, "used": 6, "pending": 0, "rejected": {}, "balanced": true})"));
    EXPECT_EQ(inputs["joint samples"]["balanced"], true);
    EXPECT_EQ(inputs["CAN frames"]["balanced"], true);
    EXPECT_EQ(inputs.size(), 4U);
}

/// The value of each key by "group name", as status_meanings() has them: a list has its items under its own
/// group, and each unit of the account has the same keys.
using Values = std::multimap<std::string, Json>;
void add_values(const Json& value, const std::string& group, Values& values) {
    if (value.is_array()) {
        for (const Json& item : value) add_values(item, group, values);
        return;
    }
    if (!value.is_object()) return;
    for (const auto& [name, part] : value.items()) {
        values.emplace(group + " " + name, part);
        const std::string path = group.empty() ? name : group + "." + name;
        const bool has_any_names = path == "inputs.rejected" || path == "links_with_borrowed_body";
        if (path == "inputs") {
            for (const Json& unit : part) add_values(unit, path, values);
        } else if (!has_any_names) {
            add_values(part, path, values);
        }
    }
}

bool is_of(const Json& value, ValueType type) {
    if (value.is_null()) return type.may_be_null;
    switch (type.kind) {
        case ValueKind::number:
            return value.is_number_float();
        case ValueKind::integer:
            return value.is_number_integer();
        case ValueKind::count:
            return value.is_number_integer() && value >= 0;
        case ValueKind::flag:
            return value.is_boolean();
        case ValueKind::word:
            return value.is_string() && !value.get<std::string>().empty() &&
                   value.get<std::string>().find(' ') == std::string::npos;
        case ValueKind::text:
            return value.is_string();
        case ValueKind::list:
            return value.is_array();
        case ValueKind::table:
            return value.is_object();
    }
    return false;
}

/// "group name: value" of each value that is not of its declared type.
std::vector<std::string> values_of_another_type(const Json& status) {
    Values values;
    add_values(status, "", values);
    std::vector<std::string> others;
    for (const Meaning& meaning : status_meanings()) {
        const std::string key = std::string(meaning.group) + " " + std::string(meaning.name);
        const auto [first, last] = values.equal_range(key);
        for (auto value = first; value != last; ++value)
            if (!is_of(value->second, meaning.type)) others.push_back(key + ": " + value->second.dump());
    }
    return others;
}

TEST_F(StatusTest, has_every_key_with_a_meaning_and_no_other) {
    const auto with_socket = inputs_with_joint_socket();
    send_joints("0.5");
    with_socket->catch_up();
    view_.now = monotonic_now();
    view_.inputs = with_socket.get();
    const Recorder recorder(folder_ / "recording", {}, settings_, *pipeline_, host_at(4.3));
    view_.recorder = &recorder;
    // A list has its keys only where it has anything in it. This problem has each part.
    scene_.rig.links_without_body = {{"wrist", false}};
    ScriptedBus bus;
    bus.send(4.6,
             wire::InfoFault{.kind = wire::FaultKind::register_alike,
                             .where = wire::RegisterReport{3, 0x47, 0x0B, 0x0C}.where()},
             kLeft);
    play_on(bus.frames(), 4.65);
    Values values;
    add_values(status(), "", values);
    std::set<std::string> reported;
    for (const auto& [key, value] : values) reported.insert(key);
    std::set<std::string> known;
    for (const Meaning& meaning : status_meanings()) {
        EXPECT_FALSE(meaning.text.empty()) << meaning.name;
        known.insert(std::string(meaning.group) + " " + std::string(meaning.name));
    }
    EXPECT_EQ(reported, known);
    EXPECT_THAT(values_of_another_type(status()), IsEmpty());
}

TEST_F(StatusTest, has_each_value_of_its_type_and_null_only_where_that_is_declared) {
    EXPECT_THAT(values_of_another_type(status()), IsEmpty());
    let_camera_contradict();
    EXPECT_THAT(values_of_another_type(status()), IsEmpty()) << "with the verdict of the camera";
    view_.cameras.clear();
    view_.reloads.reading_since = view_.now;
    view_.maps_silent_since = view_.now;
    scene_.rig.links_with_borrowed_body = {{"bolt", "upper"}};
    EXPECT_THAT(values_of_another_type(status()), IsEmpty()) << "without a camera";
    Scene far = daemon_scene();
    far.rig.nodes[0].node_id = 44;
    far.rig.cameras.clear();
    play(far, kAllWell);
    EXPECT_THAT(values_of_another_type(status()), IsEmpty()) << "of a node that nobody has heard";
    Scene silent = daemon_scene();
    silent.bus = ScriptedBus{};
    play(silent, kAllWell);
    EXPECT_THAT(values_of_another_type(status()), IsEmpty()) << "without the bus time";
}

TEST_F(StatusTest, has_no_latency_where_no_reading_came_over_the_bus) {
    EXPECT_EQ(status()["latency"],
              Json::parse(R"({"readings": 0, "median_ms": 0.0, "p99_ms": 0.0, "max_ms": 0.0,
                              "age_median_ms": 0.0, "age_p99_ms": 0.0, "age_max_ms": 0.0})"));
}

TEST_F(StatusTest, knows_when_each_kind_of_measurement_was_used_last) {
    play(daemon_scene(), 0.4);
    EXPECT_FALSE(view_.used.joint_sample || view_.used.reading || view_.used.cameras[0].frame ||
                 view_.used.time_back);
    play(daemon_scene(), 6.0);
    EXPECT_NEAR(1e-9 * static_cast<double>(view_.used.joint_sample->ns), 5.99, 0.012);
    // The joint state behind each is certain once the next one is here, and 12.5 ms have passed.
    EXPECT_NEAR(1e-9 * static_cast<double>(view_.used.reading->ns), 3.830, 0.012);
    EXPECT_NEAR(1e-9 * static_cast<double>(view_.used.cameras[0].frame->ns), 4.520, 0.012);
    EXPECT_FALSE(view_.used.time_back);
    // The host begins anew: what it says and how the frames are stamped no longer fit.
    Scene anew = good_scene();
    std::vector<StampedFrame> frames = anew.bus.frames();
    for (StampedFrame& entry : frames) entry.stamp.ns += 6'000'000'000;
    play_on(frames, 10.0);
    ASSERT_TRUE(view_.used.time_back);
    EXPECT_EQ(status()["clock"]["times_back"], 1);
    EXPECT_NE(reported(ProblemCode::time_back), std::nullopt);
}

}  // namespace
}  // namespace octoskin::test
