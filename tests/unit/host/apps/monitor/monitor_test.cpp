#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "host/apps/monitor/screen.hpp"
#include "host/apps/monitor/scroll.hpp"
#include "host/apps/monitor/status_meanings.hpp"
#include "host/core/counters/counter_meanings.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/io/candump/log_line.hpp"

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
        "joints_socket": null, "cameras": [],
        "latency": {"readings": 7, "median_ms": 0.2, "p99_ms": 0.5, "max_ms": 3.0,
                    "age_median_ms": 31.25, "age_p99_ms": 44.0, "age_max_ms": 51.5},
        "map": {"known_voxels": 1234, "resolution_m": 0.04, "memory_mib": 3.2, "memory_max_mib": 800,
                "saved_age_s": 4.0, "no_room": 0},
        "inputs": {"readings": {"in": 130, "used": 100, "rejected": {"self_hit": 30}, "balanced": true},
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
    now["inputs"]["joint samples"]["used"] = 400;
    now["inputs"]["readings"]["rejected"]["self_hit"] = 31;
    const std::string screen = shown(status(), now);
    for (const char* words :
         {"rig 'arm'", "no problems", "450.0/s in", "node 1 'left' usable", "+12.3 ppm within 0.21 ms",
          "load 25.0 %", "0.532 m", "20.0/s", "elbow", "lost, no_answer", "not used: self_hit",
          "100.0/s used", "0.20 ms median", "map 1234 voxels", "saved 4.00 s ago", "no camera",
          "0.5/s  the beam ends on the robot's own body"})
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

TEST(Monitor, shows_no_latency_before_the_first_reading) {
    Json now = status();
    now["latency"] = {{"readings", 0}, {"median_ms", 0.0}, {"p99_ms", 0.0}, {"max_ms", 0.0}};
    EXPECT_TRUE(has(shown(now, now), "from frame to map: - median, - 99 %, - longest"));
    EXPECT_TRUE(has(shown(now, now), "from capture to map: - median, - 99 %, - longest"));
    EXPECT_TRUE(has(shown(status(), status()),
                    "from capture to map: 31.25 ms median, 44.00 ms 99 %, 51.50 ms longest"));
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
    now["problems"] = Json::parse(R"([{"code": "joints_missing", "text": "no joint states: none from node 3"},
                                      {"code": "time_unknown", "text": "another"}])");
    const std::string screen = shown(status(), now, {80, 5});
    EXPECT_TRUE(has(screen, "! no joint states: none from node 3\n")) << screen;
    EXPECT_TRUE(has(screen, "the map is empty: the first problem above is the reason")) << screen;
    now["problems"] = Json::array();
    EXPECT_TRUE(has(shown(status(), now), "the map is empty: no measurement"));
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
    EXPECT_TRUE(has(shown(status(), status(), {80, 5}), "lines 1-4 of"));
}

TEST(Monitor, shows_each_line_of_a_status_somewhere_as_it_is_scrolled) {
    const auto lines = screen_of(status(), status(), 2s);
    const ScreenSize size{1000, 6};
    std::set<std::string> seen;
    Scroll scroll;
    for (std::size_t i = 0; i <= lines.size(); ++i) {
        const std::size_t rows = rows_for(lines.size(), size);
        std::istringstream screen(to_terminal(lines, size, false, scroll.first(lines.size(), rows)));
        std::size_t count = 0;
        for (std::string line; std::getline(screen, line); ++count) seen.insert(line);
        EXPECT_EQ(count, size.rows);
        scroll.type("\x1b[B", lines.size(), rows);
    }
    for (const ScreenLine& line : lines) EXPECT_TRUE(seen.contains(line.text)) << line.text;
}

TEST(Monitor, breaks_long_lines_between_words_and_loses_none) {
    const std::string text =
        "  12 counter   of some words and a long one: " + std::string(40, 'x') + " \u00e4\u00f6\u00fc end";
    for (std::size_t columns = 18; columns < 100; ++columns) {
        std::string words;
        const auto lines = wrapped({{text, Emphasis::bad}, {"", {}}, {"short", Emphasis::title}}, columns);
        ASSERT_GE(lines.size(), 3U);
        for (std::size_t i = 0; i + 2 < lines.size(); ++i) {
            const auto letters = std::ranges::count_if(
                lines[i].text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
            EXPECT_LE(static_cast<std::size_t>(letters), columns);
            EXPECT_EQ(lines[i].emphasis, Emphasis::bad);
            words += lines[i].text;
        }
        std::string expected = text;
        for (std::string* all : {&words, &expected}) std::erase(*all, ' ');
        EXPECT_EQ(words, expected) << columns;
        EXPECT_EQ(lines.back().text, "short");
    }
    EXPECT_EQ(wrapped({{text, {}}}, 10).size(), 1U) << "too narrow for words: it is cut";
}

TEST(Monitor, scrolls_by_its_keys_and_never_beyond_the_lines) {
    Scroll scroll;
    const auto first_after = [&scroll](std::string_view keys) {
        scroll.type(keys, 70, 20);
        return scroll.first(70, 20);
    };
    EXPECT_EQ(first_after("jj\x1b[B\x1bOB\r"), 5U);
    EXPECT_EQ(first_after("k\x1b[A"), 3U);
    EXPECT_EQ(first_after(" "), 22U) << "a line of the page before stays in sight";
    EXPECT_EQ(first_after("\x1b[5~"), 3U);
    EXPECT_EQ(first_after("bkkk"), 0U);
    EXPECT_EQ(first_after("\x1b[6~\x1b[6~\x1b[6~\x1b[6~"), 50U);
    EXPECT_EQ(first_after("k"), 49U) << "what was typed beyond the end is not remembered";
    EXPECT_EQ(first_after("g"), 0U);
    EXPECT_EQ(first_after("\x1b[F"), 50U);
    EXPECT_EQ(scroll.first(30, 20), 10U) << "fewer lines than before";
    EXPECT_EQ(scroll.first(5, 20), 0U);
    EXPECT_EQ(first_after("\x1b[1;5Dxyz\x1b"), 50U) << "other keys are nothing";
    EXPECT_FALSE(scroll.is_ended());
    EXPECT_EQ(first_after("q"), 50U);
    EXPECT_TRUE(scroll.is_ended());
    Scroll(scroll).type("jk bgG", 0, 0);
}

TEST(Monitor, cuts_no_character_in_two_and_lets_no_name_steer_the_terminal) {
    Json now = status();
    now["rig"] = "\x1b[2Jevil";
    now["problems"] = Json::parse("[{\"text\": \"\u00e4\u00f6\u00fc\"}]");
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

TEST(Monitor, shows_each_counter_that_is_not_zero_with_its_rate_and_meaning) {
    Json before = status();
    before["can"]["not_sent"] = 2;
    Json now = before;
    now["can"]["not_sent"] = 5;
    now["clock"]["relocks"] = 1;
    now["joints_socket"] = {{"samples", 9}, {"time_off", 4}};
    now["cameras"] = {{{"open", true}, {"frames", 60}, {"age_s", 0.1}, {"untimed", 6}}};
    now["map"]["no_room"] = 7;
    now["reloads"] = {{"count", 1}, {"dropped", 8}};
    now["nodes"][0]["sensors"][0]["lost"] = 3;
    const std::string screen = shown(before, now);
    const auto expect_line = [&screen](const std::string& begin, const char* group, const char* name) {
        const std::string line = begin + std::string(find_meaning(status_meanings(), group, name)) + '\n';
        EXPECT_FALSE(find_meaning(status_meanings(), group, name).empty()) << name;
        EXPECT_TRUE(has(screen, line)) << line << screen;
    };
    expect_line("\n          5 not_sent                 1.5/s  ", "can", "not_sent");
    expect_line("\n          1 relocks                  0.5/s  ", "clock", "relocks");
    expect_line("          4 time_off                 2.0/s  ", "joints_socket", "time_off");
    expect_line("          6 untimed                  3.0/s  ", "cameras", "untimed");
    expect_line("          7 no_room                  3.5/s  ", "map", "no_room");
    expect_line("          8 dropped                  4.0/s  ", "reloads", "dropped");
    EXPECT_TRUE(has(screen, "wrist            0.532 m    0.0/s   0.02 s ago  status 9, lost on the bus: 3\n"))
        << screen;
    EXPECT_FALSE(has(screen, "wrong_count"));
}

TEST(Monitor, shows_each_of_several_joint_sources_and_one_that_is_silent_as_bad) {
    Json now = status();
    now["joint_states"]["sources"] = Json::parse(R"([{"node_id": 60, "via": "can", "age_s": 0.01}])");
    EXPECT_FALSE(has(shown(now, now), "node 60")) << "one needs no line";
    now["joint_states"]["sources"] = Json::parse(
        R"([{"node_id": 60, "via": "can", "age_s": 0.01}, {"node_id": 61, "via": "socket", "age_s": null}])");
    const auto emphasis_of = [&](const std::string& text) {
        const auto lines = screen_of(now, now, 2s);
        const auto line = std::ranges::find(lines, text, &ScreenLine::text);
        return line == lines.end() ? std::nullopt : std::optional(line->emphasis);
    };
    EXPECT_EQ(emphasis_of("     node 60 by can, newest 0.01 s ago"), Emphasis::none) << shown(now, now);
    EXPECT_EQ(emphasis_of("     node 61 by socket, newest never"), Emphasis::bad);
}

TEST(Monitor, shows_the_recording_and_what_it_lost_as_bad) {
    Json now = status();
    EXPECT_FALSE(has(shown(now, now), "recording"));
    now["recording"] = {{"state", "recording"}, {"folder", "/tmp/bench"}, {"error", ""},
                        {"seconds", 12.2},      {"lost_can", 0},          {"is_complete", true}};
    const auto title = [&now] {
        const auto lines = screen_of(now, now, 2s);
        const auto line = std::ranges::find_if(
            lines, [](const ScreenLine& one) { return one.text.starts_with("recording "); });
        return line == lines.end() ? ScreenLine{} : *line;
    };
    EXPECT_EQ(title().text, "recording /tmp/bench: recording, 12 s");
    EXPECT_EQ(title().emphasis, Emphasis::title);
    now["recording"]["is_complete"] = false;
    now["recording"]["lost_depth"] = 2;
    EXPECT_EQ(title().emphasis, Emphasis::bad);
    EXPECT_TRUE(has(shown(now, now), "          2 lost_depth "));
    now["recording"]["state"] = "failed";
    now["recording"]["error"] = "no room";
    EXPECT_EQ(title().text, "recording /tmp/bench: failed, 12 s: no room");
}

template <class Reason>
std::set<std::string> names(const std::string& unit) {
    std::set<std::string> all;
    for (const char* name : names_of(Reason{})) all.insert(unit + " " + name);
    return all;
}
TEST(Meanings, are_there_for_every_counter_of_the_account_and_for_no_other) {
    std::set<std::string> there;
    for (const CounterMeaning& meaning : counter_meanings()) {
        EXPECT_FALSE(meaning.text.empty()) << meaning.name;
        there.insert(std::string(meaning.unit) + " " + std::string(meaning.name));
    }
    // Those of a replay alone, as octoskin::playback counts them.
    std::set<std::string> expected{
        "log lines other_interface", "depth images without_pose", "depth images unreadable",
        "depth images bad_line",     "camera poses no_pose",      "camera poses bad_line",
        "camera poses repeated",     "depth pixels no_value",     "depth pixels robot",
        "depth pixels bad_value",    "depth pixels outside_map"};
    expected.merge(names<candump::LineFault>("log lines"));
    expected.merge(names<FrameReason>("CAN frames"));
    expected.merge(names<ReadingReason>("readings"));
    expected.merge(names<JointReason>("joint samples"));
    expected.merge(names<DepthReason>("depth frames"));
    EXPECT_EQ(there, expected);
    EXPECT_EQ(find_counter("readings", "no_such_counter"), nullptr);
    EXPECT_EQ(find_counter("readings", "out_of_limits"), nullptr) << "one of another unit";
    EXPECT_TRUE(find_meaning(status_meanings(), "clock", "not_sent").empty()) << "one of another group";
}

}  // namespace
}  // namespace octoskin
