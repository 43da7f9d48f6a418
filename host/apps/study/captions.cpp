#include "host/apps/study/captions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace octoskin {
namespace {

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

const char* name_of(DistanceMode mode) {
    switch (mode) {
        case DistanceMode::short_range:
            return "short";
        case DistanceMode::medium_range:
            return "medium";
        case DistanceMode::long_range:
            break;
    }
    return "long";
}

/// The distinct ways in which the rig's sensors range: mode, budget, period.
std::set<std::tuple<DistanceMode, unsigned, unsigned>> timings_of(const rig::Rig& rig) {
    std::set<std::tuple<DistanceMode, unsigned, unsigned>> timings;
    for (const rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const SensorConfig& sensor = node.config.sensors[i];
            timings.insert({sensor.distance_mode, sensor.timing_budget_ms, sensor.inter_measurement_ms});
        }
    }
    return timings;
}

/// VL53L1X datasheet, section 2.5.2: the shortest budgets, and what 4 m take.
std::string timing_sentence(DistanceMode mode, unsigned budget_ms, unsigned period_ms) {
    std::string text = fmt::format("Range sensors run in {} mode with a {} ms timing budget every {} ms.",
                                   name_of(mode), budget_ms, period_ms);
    if (mode != DistanceMode::short_range && budget_ms < 33) {
        text += " ST's driver allows it; the datasheet asks for at least 33 ms, and for 140 ms to reach 4 m.";
    } else if (mode == DistanceMode::long_range && budget_ms < 140) {
        text += " The datasheet asks for 140 ms to reach 4 m.";
    }
    return text;
}

/// As one word of a POSIX shell.
std::string shell_word(const std::string& text) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_-./=:,+@%").find(c) != std::string_view::npos;
    };
    if (!text.empty() && std::ranges::all_of(text, is_plain)) return text;
    std::string inner;
    for (const char c : text) {
        if (c == '\'') inner += R"('\')";  // the quotes end, one stands escaped, and they begin again
        inner += c;
    }
    return fmt::format("'{}'", inner);
}

}  // namespace

std::string scene_caption(const rig::Rig& rig, const sim::Scenario& scenario, std::size_t beams) {
    std::size_t sensors = 0;
    for (const rig::Node& node : rig.nodes) sensors += node.sensors.size();
    std::string text = "The arm";
    if (beams > 0) text += fmt::format(" with beams of {} of its {} range sensors (red)", beams, sensors);
    if (rig.camera) text += beams > 0 ? ", and the external camera" : " and the external camera";
    if (!scenario.hidden_models.empty()) {
        text +=
            fmt::format(". Yellow: what the scenario names as hidden ({})", joined(scenario.hidden_models));
    }
    return text + ".";
}

std::vector<std::string> idealisations_of(const rig::Rig& rig, const sim::Scenario& scenario) {
    std::vector<std::string> sentences;
    for (const auto& [mode, budget_ms, period_ms] : timings_of(rig)) {
        sentences.push_back(timing_sentence(mode, budget_ms, period_ms));
    }
    sentences.push_back(
        fmt::format("Their noise ({:g} cm) and reach ({:g} to {:g} m) are set by the scenario, not by mode, "
                    "budget, target or ambient light.",
                    100.0 * scenario.ranges.sigma_m, scenario.ranges.min_m, scenario.ranges.max_m));
    sentences.push_back(
        "A range is measured along one ideal ray. The real sensor sees a cone of 27 degrees and answers with "
        "something like the nearest part of it.");
    if (rig.camera) {
        sentences.push_back(fmt::format(
            "The camera's noise ({:g} cm along the ray, independent from pixel to pixel) knows no "
            "flying pixels, no reflections and no dependence on distance or material.",
            100.0 * scenario.depth_sigma_m));
    }
    sentences.push_back(
        "Extrinsics, link lengths and joint angles are exactly those of the rig file and the robot "
        "description.");
    sentences.push_back("Nothing in the scene moves but the arm.");
    return sentences;
}

std::string command_of(const StudyRequest& request) {
    std::string text = "octoskin experiment";
    const auto add_file = [&](const char* option, const std::filesystem::path& file) {
        if (!file.empty()) text += fmt::format(" {} {}", option, shell_word(file.string()));
    };
    add_file("--rig", request.inputs.rig);
    add_file("--robot", request.inputs.robot);
    add_file("--scenario", request.inputs.scenario);
    add_file("--world", request.inputs.world);
    text += " --seeds";
    for (const std::uint64_t seed : request.seeds) text += fmt::format(" {}", seed);
    text += " --configurations";
    for (const std::string& name : request.configurations) text.append(" ").append(shell_word(name));
    add_file("--out", request.out);
    return text;
}

}  // namespace octoskin
