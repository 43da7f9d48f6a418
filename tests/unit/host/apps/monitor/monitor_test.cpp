#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/apps/monitor/counter_meanings.hpp"
#include "host/apps/monitor/screen.hpp"
#include "host/core/ingest/reasons.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::ordered_json;

Json status() {
    return Json::parse(R"({"octoskin": "octoskin 1", "uptime_s": 12.3, "rig": "arm", "problems": [],
        "can": {"interface": "can0", "state": "up", "received": 1000, "sent": 4, "busy_s": 7.5, "listen_only": false,
                "bus_off": 0, "dropped_by_kernel": 0},
        "clock": {"known": true, "steps_back": 0},
        "nodes": [{"id": 1, "name": "left", "verdict": "usable", "reason": null, "age_s": 0.05,
                   "clock_ppm": 12.34, "clock_error_ms": 0.213, "sensors": [
            {"index": 0, "name": "wrist", "state": "ranging", "fault": "none", "received": 100,
             "age_s": 0.02, "range_m": 0.532, "device_status": 9, "rejected": null},
            {"index": 1, "name": "elbow", "state": "lost", "fault": "no_answer", "received": 7,
             "age_s": null, "rejected": "self_hit"}]}],
        "joints_socket": null, "camera": null,
        "latency": {"median_ms": 0.2, "p99_ms": 0.5, "max_ms": 3.0},
        "map": {"known_voxels": 1234, "resolution_m": 0.04, "memory_mib": 3.2, "memory_max_mib": 800,
                "saved_age_s": 4.0, "no_room": 0},
        "account": {"readings": {"in": 130, "used": 100, "rejected": {"self_hit": 30}, "balanced": true},
                    "joint samples": {"in": 200, "used": 200, "rejected": {}, "balanced": true}}})");
}

std::string shown(const Json& before, const Json& now, ScreenSize size = {1000, 1000}) {
    return to_terminal(screen_of(before, now, 2s), size, false);
}
bool has(const std::string& screen, const std::string& words) {
    return screen.find(words) != std::string::npos;
}

TEST(Monitor, shows_what_is_there_and_rates_of_what_grew) {
    Json now = status();
    now["can"]["received"] = 1900;
    now["can"]["busy_s"] = 8.0;
    now["nodes"][0]["sensors"][0]["received"] = 140;
    now["account"]["joint samples"]["used"] = 400;
    now["account"]["readings"]["rejected"]["self_hit"] = 31;
    const std::string screen = shown(status(), now);
    for (const char* words :
         {"rig 'arm'", "no problems", "450.0/s in", "node 1 'left' usable", "+12.3 ppm within 0.21 ms",
          "load 25.0 %", "0.532 m", "20.0/s", "elbow", "lost, no_answer", "not used: self_hit",
          "100.0/s used", "0.20 ms median", "map 1234 voxels", "saved 4.00 s ago", "no camera",
          "0.5/s  the beam reaches the robot's own body"})
        EXPECT_TRUE(has(screen, words)) << words << "\n" << screen;
    for (const char* words : {"bus_off", "no_room", "steps_back"})
        EXPECT_FALSE(has(screen, words)) << "a counter of zero is not shown: " << words;
}

TEST(Monitor, shows_a_sensor_that_contradicts_the_camera_as_bad) {
    Json now = status();
    now["nodes"][0]["sensors"][0]["camera"] = {{"contradicts", true}, {"agreed", 0}, {"in_free_space", 6}};
    const auto lines = screen_of(status(), now, 2s);
    const auto line = std::ranges::find_if(
        lines, [](const ScreenLine& shown) { return has(shown.text, "CONTRADICTS the camera"); });
    ASSERT_NE(line, lines.end());
    EXPECT_TRUE(has(line->text, "wrist"));
    EXPECT_EQ(line->emphasis, Emphasis::bad);
    EXPECT_FALSE(has(shown(status(), status()), "CONTRADICTS"));
}

TEST(Monitor, shows_that_something_came_too_close_and_that_it_did_so_just_now) {
    Json before = status();
    Json& sensor = before["nodes"][0]["sensors"][0];
    sensor["reflexes"] = 0;
    EXPECT_FALSE(has(shown(before, before), "REFLEX"));
    sensor["reflex_below_m"] = 0.15;
    sensor["reflex_m"] = 0.081;
    Json now = before;
    now["nodes"][0]["sensors"][0]["reflexes"] = 3;
    const auto reflex_line = [](const Json& earlier, const Json& later) {
        const auto lines = screen_of(earlier, later, 2s);
        const auto line =
            std::ranges::find_if(lines, [](const ScreenLine& one) { return has(one.text, "REFLEX"); });
        return line == lines.end() ? ScreenLine{} : *line;
    };
    EXPECT_EQ(
        reflex_line(before, now).text,
        "     REFLEX 3 times: something came closer than its reflex_below_m, 0.15 m; the newest at 0.081 m");
    EXPECT_EQ(reflex_line(before, now).emphasis, Emphasis::bad);
    EXPECT_EQ(reflex_line(now, now).emphasis, Emphasis::none);
    EXPECT_EQ(reflex_line(Json(), now).emphasis, Emphasis::none) << "the first picture: nobody knows when";
}

TEST(Monitor, shows_no_range_of_a_sensor_that_saw_nothing) {
    Json now = status();
    Json& sensor = now["nodes"][0]["sensors"][0];
    sensor["device_status"] = 4;
    sensor["rejected"] = "no_return";
    const std::string screen = shown(status(), now);
    EXPECT_TRUE(has(screen, "no target")) << screen;
    EXPECT_FALSE(has(screen, "0.532")) << screen;
}

TEST(Monitor, says_that_a_nodes_time_is_not_known) {
    Json now = status();
    now["nodes"][0]["clock_error_ms"] = nullptr;
    EXPECT_TRUE(has(shown(now, now), "clock +12.3 ppm, its time NOT known"));
    now["nodes"][0]["clock_ppm"] = nullptr;
    EXPECT_TRUE(has(shown(now, now), "clock not known, heard"));
    now["can"]["busy_s"] = 0.1;  // the daemon began anew
    EXPECT_TRUE(has(shown(status(), now), "load -"));
}

TEST(Monitor, says_why_nothing_is_in_the_map_and_problems_first) {
    Json now = status();
    now["map"]["known_voxels"] = 0;
    now["problems"] = {"no joint states: none from node 3", "another"};
    const std::string screen = shown(status(), now, {80, 5});
    EXPECT_TRUE(has(screen, "! no joint states")) << screen;
    EXPECT_TRUE(has(screen, "nothing is in the map: the first problem above is why")) << screen;
    now["problems"] = Json::array();
    EXPECT_TRUE(has(shown(status(), now), "nothing is in the map yet"));
}

TEST(Monitor, takes_counters_that_began_anew_and_a_first_picture) {
    Json now = status();
    now["can"]["received"] = 3;
    EXPECT_TRUE(has(shown(status(), now), "0.0/s in"));
    const auto first = to_terminal(screen_of(Json(), status(), 0s), {100, 100}, false);
    EXPECT_TRUE(has(first, "up: load -, - in"));
}

TEST(Monitor, fits_every_terminal) {
    for (std::size_t rows = 1; rows < 40; ++rows) {
        for (std::size_t columns = 1; columns < 120; columns += 7) {
            const std::string screen = shown(status(), status(), {columns, rows});
            EXPECT_LE(static_cast<std::size_t>(std::ranges::count(screen, '\n')), rows);
            std::size_t begin = 0;
            for (std::size_t end = 0; (end = screen.find('\n', begin)) != std::string::npos; begin = end + 1)
                EXPECT_LE(end - begin, columns);
        }
    }
    EXPECT_TRUE(has(shown(status(), status(), {80, 5}), "more lines"));
}

TEST(Monitor, cuts_no_character_in_two_and_lets_no_name_steer_the_terminal) {
    Json now = status();
    now["rig"] = "\x1b[2Jevil";
    now["problems"] = {"\u00e4\u00f6\u00fc"};
    EXPECT_FALSE(has(shown(now, now), "\x1b"));
    EXPECT_TRUE(has(shown(now, now, {4, 50}), "! \u00e4\u00f6\n"));
}

TEST(Monitor, shows_any_object_without_failing) {
    const Json whole = status();
    for (const auto& [key, value] : whole.items()) {
        for (const Json& other : {Json(), Json(5), Json("text"), Json::array({1, 2}), Json::object()}) {
            Json damaged = whole;
            damaged[key] = other;
            EXPECT_FALSE(shown(damaged, damaged).empty()) << key;
            EXPECT_FALSE(shown(whole, damaged).empty()) << key;
            EXPECT_FALSE(shown(damaged, whole).empty()) << key;
        }
    }
}

template <class Reason>
void expect_meanings(const char* unit) {
    for (const char* name : names_of(Reason{})) EXPECT_FALSE(meaning_of(unit, name).empty()) << name;
}
TEST(CounterMeanings, are_there_for_every_counter) {
    expect_meanings<FrameReason>("CAN frames");
    expect_meanings<ReadingReason>("readings");
    expect_meanings<JointReason>("joint samples");
    expect_meanings<DepthReason>("depth frames");
    EXPECT_TRUE(meaning_of("readings", "no_such_counter").empty());
}

}  // namespace
}  // namespace octoskin
