#include "host/apps/monitor/screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "host/apps/command_line/json_at.hpp"
#include "host/apps/monitor/status_meanings.hpp"
#include "host/core/counters/counter_meanings.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

using Json = nlohmann::ordered_json;
using Seconds = std::chrono::duration<double>;

/// The element at `index`; null if there is none.
const Json& item(const Json& array, std::size_t index) {
    static const Json kNothing;
    return array.is_array() && index < array.size() ? array[index] : kNothing;
}
std::size_t length(const Json& array) {
    return array.is_array() ? array.size() : 0;
}
std::string text(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.is_null() ? "-" : value.dump();
}
double number(const Json& value) {
    return value.is_number() ? value.get<double>() : 0.0;
}
std::string count(const Json& value) {
    return fmt::format("{:.0f}", number(value));
}
std::string rate(const Json& before, const Json& now, Seconds passed) {
    const double grown = std::max(0.0, number(now) - number(before));  // it started again: a reload
    return passed.count() > 0.0 ? fmt::format("{:.1f}/s", grown / passed.count()) : std::string("-");
}
std::string age(const Json& seconds) {
    return seconds.is_number() ? fmt::format("{:.2f} s ago", seconds.get<double>()) : "never";
}

class Screen {
  public:
    Screen(const Json& before, const Json& now, Seconds passed)
        : before_(before), now_(now), passed_(passed) {}

    std::vector<ScreenLine> lines() && {
        add_head();
        add_problems();
        add_bus();
        add_joints();
        add_cameras();
        add_recording();
        add_map();
        for (std::size_t i = 0; i < length(at(now_, "nodes")); ++i) add_node(i);
        add_counters();
        return std::move(lines_);
    }

  private:
    void add(const std::string& line, Emphasis emphasis = Emphasis::none) {
        lines_.push_back({printable(line), emphasis});
    }
    void add_head() {
        add(fmt::format("{}   rig '{}', {:.0f} s", text(at(now_, "octoskin")), text(at(now_, "rig")),
                        number(at(now_, "uptime_s"))),
            Emphasis::title);
    }
    void add_problems() {
        const Json& problems = at(now_, "problems");
        if (problems.empty()) add("no problems", Emphasis::good);
        for (const Json& problem : problems) add("! " + text(at(problem, "text")), Emphasis::bad);
        if (number(at(at(now_, "map"), "known_voxels")) > 0.0) return;
        add(problems.empty() ? "the map is empty: no measurement has been used so far"
                             : "the map is empty: the first problem above is the reason",
            Emphasis::bad);
    }
    void add_bus() {
        const Json& can = at(now_, "can");
        const Json& can_before = at(before_, "can");
        const Json& clock = at(now_, "clock");
        const double busy_s = number(at(can, "busy_s")) - number(at(can_before, "busy_s"));
        const std::string load = passed_.count() > 0.0 && busy_s >= 0.0
                                     ? fmt::format("{:.1f} %", 100.0 * busy_s / passed_.count())
                                     : std::string("-");
        add(fmt::format("CAN {} {}: load {}, {} in, {} out{}; time {}", text(at(can, "interface")),
                        text(at(can, "state")), load,
                        rate(at(can_before, "received"), at(can, "received"), passed_),
                        rate(at(can_before, "sent"), at(can, "sent"), passed_),
                        at(can, "listen_only") == true ? ", listening only" : "",
                        at(clock, "known") == true ? "known" : "NOT known"),
            Emphasis::title);
        add_nonzero("can", {"not_sent", "error_frames", "dropped_by_kernel", "malformed", "bus_off",
                            "went_down", "reopened"});
        add_nonzero("clock", {"times_back", "times_ahead", "follow_up_outliers", "steps_back", "steps_ahead",
                              "stamps_ignored", "relocks"});
        const Json& latency = at(now_, "latency");
        const bool has_readings = number(at(latency, "readings")) > 0.0;
        const auto figure = [&](const char* key) {
            return has_readings ? fmt::format("{:.2f} ms", number(at(latency, key))) : std::string("-");
        };
        add(fmt::format("  from frame to map: {} median, {} 99 %, {} longest", figure("median_ms"),
                        figure("p99_ms"), figure("max_ms")));
        add(fmt::format("  from capture to map: {} median, {} 99 %, {} longest", figure("age_median_ms"),
                        figure("age_p99_ms"), figure("age_max_ms")));
    }
    void add_node(std::size_t index) {
        const Json& node = item(at(now_, "nodes"), index);
        const bool is_usable = text(at(node, "verdict")) == "usable";
        const std::string clock = at(node, "clock_ppm").is_number()
                                      ? fmt::format("clock {:+.1f} ppm", number(at(node, "clock_ppm")))
                                      : "clock not known";
        const std::string error = at(node, "clock_error_ms").is_number()
                                      ? fmt::format(" within {:.2f} ms", number(at(node, "clock_error_ms")))
                                      : std::string(clock == "clock not known" ? "" : ", its time NOT known");
        add(fmt::format("node {} '{}' {}{}, {}{}, heard {}", text(at(node, "id")), text(at(node, "name")),
                        text(at(node, "verdict")),
                        at(node, "reason").is_null() ? "" : ": " + text(at(node, "reason")), clock, error,
                        age(at(node, "age_s"))),
            is_usable ? Emphasis::title : Emphasis::bad);
        const Json& node_before = item(at(before_, "nodes"), index);
        for (std::size_t i = 0; i < length(at(node, "sensors")); ++i) add_sensor(node, node_before, i);
    }
    void add_sensor(const Json& node, const Json& node_before, std::size_t index) {
        const Json& sensor = item(at(node, "sensors"), index);
        const Json& before = item(at(node_before, "sensors"), index);
        // The range of a sensor without a target is noise.
        const bool saw_nothing = text(at(sensor, "rejected")) == "no_return";
        const std::string range = saw_nothing ? "no target"
                                  : at(sensor, "range_m").is_number()
                                      ? fmt::format("{:7.3f} m", number(at(sensor, "range_m")))
                                      : std::string("        -");
        const bool is_ranging = text(at(sensor, "state")) == "ranging";
        const Json& camera = at(sensor, "camera");
        const bool contradicts = at(camera, "contradicts") == true;
        const std::string contradiction =
            !contradicts ? ""
                         : ", CONTRADICTS the " + camera_text(text(at(camera, "of"))) +
                               (at(camera, "fault").is_string() ? ": " + text(at(camera, "fault")) : "") +
                               (at(camera, "refused") == true ? ", refused" : "");
        const bool has_fault = !at(sensor, "fault").is_null() && text(at(sensor, "fault")) != "none";
        const bool has_lost = number(at(sensor, "lost")) != 0.0;
        add(fmt::format("  {:>2} {:<14} {} {:>8} {:>12}  status {}{}{}{}{}{}", text(at(sensor, "index")),
                        text(at(sensor, "name")), range,
                        rate(at(before, "received"), at(sensor, "received"), passed_),
                        age(at(sensor, "age_s")), text(at(sensor, "device_status")),
                        is_ranging ? "" : ", " + text(at(sensor, "state")),
                        has_fault ? ", " + text(at(sensor, "fault")) : "",
                        at(sensor, "rejected").is_null() ? "" : ", not used: " + text(at(sensor, "rejected")),
                        has_lost ? ", lost on the bus: " + count(at(sensor, "lost")) : "", contradiction),
            is_ranging && !contradicts ? Emphasis::none : Emphasis::bad);
        add_reflex(sensor, before);
    }
    void add_reflex(const Json& sensor, const Json& before) {
        if (number(at(sensor, "reflexes")) == 0.0) return;
        const bool is_new = number(at(sensor, "reflexes")) > number(at(before, "reflexes"));
        add(fmt::format("     REFLEX {} times: something came closer than its reflex_below_m, {} m; the "
                        "newest at {:.3f} m",
                        count(at(sensor, "reflexes")), text(at(sensor, "reflex_below_m")),
                        number(at(sensor, "reflex_m"))),
            is_new && !before.is_null() ? Emphasis::bad : Emphasis::none);
    }
    void add_joints() {
        const auto used = [](const Json& status) -> const Json& {
            return at(at(at(status, "inputs"), "joint samples"), "used");
        };
        add("joint samples " + rate(used(before_), used(now_), passed_) + " used", Emphasis::title);
        add_nonzero("joints_socket",
                    {"samples", "displaced", "thinned", "second_sender", "joint_node_ignored", "not_a_number",
                     "wrong_count", "time_off", "too_large", "too_long"});
        const Json& sources = at(at(now_, "joint_states"), "sources");
        for (std::size_t i = 0; i < sources.size() && sources.size() > 1; ++i) add_joint_source(sources[i]);
        const Json& socket = at(now_, "joints_socket");
        if (at(socket, "above_rate") == true)
            add(fmt::format(
                "     {:.0f} Hz through the socket, more than the rig's rate: the surplus is left out",
                number(at(socket, "rate_hz"))));
    }
    void add_joint_source(const Json& source) {
        constexpr double kSilentS = 1.0;
        const Json& newest = at(source, "age_s");
        const bool is_silent = newest.is_null() || number(newest) > kSilentS;
        add(fmt::format("     node {} by {}, newest {}", text(at(source, "node_id")), text(at(source, "via")),
                        age(newest)),
            is_silent ? Emphasis::bad : Emphasis::none);
    }
    void add_cameras() {
        const Json& cameras = at(now_, "cameras");
        if (cameras.empty()) return add("no camera");
        for (std::size_t i = 0; i < cameras.size(); ++i) add_camera(i);
    }
    void add_camera(std::size_t index) {
        const Json& camera = item(at(now_, "cameras"), index);
        const Json& before = item(at(before_, "cameras"), index);
        const std::string name = camera_text(text(at(camera, "name")));
        const bool is_open = at(camera, "open") == true;
        add(is_open ? fmt::format("{} {}, newest {}", name,
                                  rate(at(before, "frames"), at(camera, "frames"), passed_),
                                  age(at(camera, "age_s")))
                    : name + " closed: " + text(at(camera, "why")),
            is_open ? Emphasis::title : Emphasis::bad);
        add_nonzero("cameras", before, camera, {"displaced", "untimed", "repeated", "opened"});
    }
    void add_recording() {
        const Json& recording = at(now_, "recording");
        if (recording.is_null()) return;
        const std::string error = text(at(recording, "error"));
        const bool is_whole = error.empty() && at(recording, "is_complete") != false;
        add(fmt::format("recording {}: {}, {:.0f} s{}", text(at(recording, "folder")),
                        text(at(recording, "state")), number(at(recording, "seconds")),
                        error.empty() ? "" : ": " + error),
            is_whole ? Emphasis::title : Emphasis::bad);
        add_nonzero("recording", {"lost_can", "lost_commits", "lost_depth"});
    }
    void add_map() {
        const Json& map = at(now_, "map");
        add(fmt::format("map {} voxels of {} m, {:.1f} of {} MiB, saved {}", count(at(map, "known_voxels")),
                        text(at(map, "resolution_m")), number(at(map, "memory_mib")),
                        count(at(map, "memory_max_mib")), age(at(map, "saved_age_s"))),
            Emphasis::title);
        add_nonzero("map", {"no_room", "no_memory", "undated", "saves_failed", "saves_skipped"});
        add_nonzero("reloads", {"dropped"});
    }
    /// The counters of each kind of input, with the reasons of those that were not used.
    void add_counters() {
        for (const auto& [unit, inputs] : at(now_, "inputs").items()) {
            add(fmt::format("{}: {} in, {} used", unit, count(at(inputs, "in")), count(at(inputs, "used"))),
                Emphasis::title);
            if (at(inputs, "balanced") == false)
                add("  the counters do not add up: a defect of octoskin", Emphasis::bad);
            for (const auto& [name, value] : at(inputs, "rejected").items()) {
                const Json& was = at(at(at(at(before_, "inputs"), unit), "rejected"), name);
                const CounterMeaning* const meaning = find_counter(unit, name);
                add_counter(name, was, value, meaning == nullptr ? std::string_view{} : meaning->text);
            }
        }
    }
    /// Those counters of the object under `group` that are not 0.
    void add_nonzero(const char* group, std::initializer_list<const char*> names) {
        add_nonzero(group, at(before_, group), at(now_, group), names);
    }
    void add_nonzero(const char* group, const Json& before, const Json& now,
                     std::initializer_list<const char*> names) {
        for (const char* name : names) {
            const Json& value = at(now, name);
            if (number(value) != 0.0)
                add_counter(name, at(before, name), value, find_meaning(status_meanings(), group, name));
        }
    }
    void add_counter(std::string_view name, const Json& before, const Json& now, std::string_view meaning) {
        add(fmt::format("  {:>9} {:<21} {:>8}  {}", count(now), name, rate(before, now, passed_), meaning));
    }

    const Json& before_;
    const Json& now_;
    Seconds passed_;
    std::vector<ScreenLine> lines_;
};

/// The number of bytes of the first `characters` of a UTF-8 text.
std::size_t bytes_of(std::string_view text, std::size_t characters) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins_one = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
        if (begins_one && ++count > characters) return i;
    }
    return text.size();
}

/// The first `columns` characters of a UTF-8 text.
std::string cut(const std::string& line, std::size_t columns) {
    return line.substr(0, bytes_of(line, columns));
}

/// Indent of the continuation lines of a wrapped line.
constexpr std::string_view kIndent = "      ";

void wrap(const ScreenLine& line, std::size_t columns, std::vector<ScreenLine>& all) {
    std::string rest = line.text;
    for (std::size_t fits = 0; (fits = bytes_of(rest, columns)) < rest.size();) {
        const std::size_t blank = rest.rfind(' ', fits);
        const std::size_t end = blank == std::string::npos || blank <= kIndent.size() ? fits : blank;
        all.push_back({rest.substr(0, end), line.emphasis});
        const std::size_t next = rest.find_first_not_of(' ', end);
        if (next == std::string::npos) return;
        rest = std::string(kIndent) + rest.substr(next);
    }
    all.push_back({rest, line.emphasis});
}

std::string coloured(const std::string& line, Emphasis emphasis) {
    switch (emphasis) {
        case Emphasis::none:
            return line;
        case Emphasis::title:
            return "\x1b[1m" + line + "\x1b[0m";
        case Emphasis::good:
            return "\x1b[32m" + line + "\x1b[0m";
        case Emphasis::bad:
            return "\x1b[31m" + line + "\x1b[0m";
    }
    return line;
}

}  // namespace

std::vector<ScreenLine> screen_of(const Json& before, const Json& now, Seconds passed) {
    return Screen(before, now, passed).lines();
}

std::vector<ScreenLine> wrapped(const std::vector<ScreenLine>& lines, std::size_t columns) {
    if (columns < 3 * kIndent.size()) return lines;
    std::vector<ScreenLine> all;
    for (const ScreenLine& line : lines) wrap(line, columns, all);
    return all;
}

std::size_t rows_for(std::size_t lines, ScreenSize size) noexcept {
    return lines > size.rows ? std::max<std::size_t>(size.rows, 1) - 1 : lines;
}

std::string to_terminal(const std::vector<ScreenLine>& lines, ScreenSize size, bool has_colours,
                        std::size_t first) {
    const std::size_t shown = rows_for(lines.size(), size);
    first = std::min(first, lines.size() - shown);
    std::string screen;
    for (std::size_t i = first; i < first + shown; ++i) {
        const std::string line = cut(lines[i].text, size.columns);
        screen += (has_colours ? coloured(line, lines[i].emphasis) : line) + '\n';
    }
    if (shown < lines.size())
        screen += cut(fmt::format("lines {}-{} of {}: arrows, space and b scroll, q ends", first + 1,
                                  first + shown, lines.size()),
                      size.columns) +
                  '\n';
    return screen;
}

}  // namespace octoskin
