#include "host/lab/study/captions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>
#include <variant>

#include "host/io/rig/zone_optics.hpp"

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

/// The distinct timings of the rig's sensors: mode, budget, period.
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

/// VL53L1X datasheet, section 2.5.2: the shortest budgets, and the budget for 4 m.
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

/// The optics of the rig's sensors, all boards together.
struct Optics {
    std::size_t rays = 0;  ///< sensors that are ideal rays
    std::size_t cones = 0;
    bool has_ray_zones = false;   ///< a ray for each of several zones, or for a part of the array
    bool has_cone_zones = false;  ///< the same of a cone
    std::set<double> cone_degrees;
};

bool has_zones(const SensorConfig& sensor) {
    constexpr unsigned kArraySide = 16;
    const Roi& first = sensor.zones[0];
    return sensor.zone_count > 1 || first.width < kArraySide || first.height < kArraySide;
}

Optics optics_of(const rig::Rig& rig) {
    Optics optics;
    for (const rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const auto& cone = node.sensors[i].cone;
            ++(cone ? optics.cones : optics.rays);
            (cone ? optics.has_cone_zones : optics.has_ray_zones) |= has_zones(node.config.sensors[i]);
            if (cone) optics.cone_degrees.insert(2.0 * cone->half_angle_deg);
        }
    }
    return optics;
}

/// "The range sensors", or the count if the sensors differ.
std::string sensors_text(std::size_t count, const Optics& optics) {
    const std::size_t all = optics.rays + optics.cones;
    return count == all ? "The range sensors" : fmt::format("{} of the {} range sensors", count, all);
}

std::vector<std::string> ray_sentences(const Optics& optics, const sim::RangeOptics& ranges) {
    if (optics.rays == 0) return {};
    return {
        fmt::format("{} measure along one ideal ray each{}. The real sensor sees a cone of 27 degrees and "
                    "reports about the nearest part of it.",
                    sensors_text(optics.rays, optics),
                    optics.has_ray_zones ? ", of a zone along its middle" : ""),
        fmt::format("The noise ({:g} cm) and reach ({:g} to {:g} m) of these rays are set by the scenario, "
                    "not by budget, target or ambient light; of the mode, only the longest range "
                    "is modelled.",
                    100.0 * ranges.sigma_m, ranges.min_m, ranges.max_m)};
}

std::vector<std::string> cone_sentences(const Optics& optics, const sim::RangeOptics& ranges) {
    if (optics.cones == 0) return {};
    std::string degrees;
    for (const double each : optics.cone_degrees)
        degrees += fmt::format("{}{:g}", degrees.empty() ? "" : ", ", each);
    return {
        fmt::format("{} see a cone of {} degrees as a bundle of sub-rays{}; a range is that of the nearest "
                    "peak of the echoes. Every surface is diffuse with a reflectivity of {:g} %: no "
                    "mirrors, no differences in darkness, no multiple reflections, and the arm stands still "
                    "while a sensor measures.",
                    sensors_text(optics.cones, optics), degrees,
                    optics.has_cone_zones ? ", shared between the zones" : "", 100.0 * ranges.reflectivity),
        fmt::format("The noise of these ranges, and whether there is a range, follow from the signal: from "
                    "distance, incidence and the filled part of the cone, not from budget or "
                    "ambient light. Of the mode, only its longest range is modelled; nothing "
                    "nearer than {:g} m or further than {:g} m is seen.",
                    ranges.min_m, ranges.max_m)};
}

std::string external_cameras_text(std::size_t cameras) {
    return cameras == 1 ? "the external camera" : fmt::format("the {} external cameras", cameras);
}

std::string camera_sentence(const sim::DepthNoise& noise, std::size_t cameras) {
    const std::string of = cameras == 1 ? "The camera's noise"
                                        : fmt::format("The noise of each of the {} depth cameras", cameras);
    if (const auto* gaussian = std::get_if<sim::GaussianNoise>(&noise.model))
        return fmt::format(
            "{} ({:g} cm along the ray, independent from pixel to pixel) has no "
            "flying pixels, no reflections and no dependence on distance or material.",
            of, 100.0 * gaussian->sigma_m);
    const auto& kinect = std::get<sim::KinectNoise>(noise.model);
    return fmt::format(
        "{} is that of a Kinect: a deviation of {:g} mm + {:g} mm (z - {:g} m)^2, "
        "a fixed error of up to {:g} mm z^2, disparity in steps of {:g} px; {:g} % of the pixels at edges "
        "fly "
        "and {:g} % are missing. It has no reflections and no dependence on material.",
        of, 1e3 * kinect.sigma_min_m, 1e3 * kinect.sigma_growth_per_m, kinect.sigma_min_at_m,
        1e3 * kinect.bias_growth_per_m, kinect.disparity_step_px, 100.0 * kinect.flying_share,
        100.0 * kinect.missing_share);
}

/// `text` as one word of a POSIX shell.
std::string shell_word(const std::string& text) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_-./=:,+@%").find(c) != std::string_view::npos;
    };
    if (!text.empty() && std::ranges::all_of(text, is_plain)) return text;
    std::string inner;
    for (const char c : text) {
        if (c == '\'') inner += R"('\')";  // ends the quotes, adds an escaped one, begins quotes again
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
    if (const std::size_t cameras = rig.external_cameras().size(); cameras > 0)
        text += (beams > 0 ? ", and " : " and ") + external_cameras_text(cameras);
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
    const Optics optics = optics_of(rig);
    for (auto& sentence : ray_sentences(optics, scenario.ranges)) sentences.push_back(std::move(sentence));
    for (auto& sentence : cone_sentences(optics, scenario.ranges)) sentences.push_back(std::move(sentence));
    if (!rig.cameras.empty()) sentences.push_back(camera_sentence(scenario.depth_noise, rig.cameras.size()));
    sentences.push_back(
        "Extrinsics, link lengths and joint angles are exactly those of the rig file and the robot "
        "description.");
    sentences.push_back("Nothing in the scene moves but the arm.");
    return sentences;
}

report::RangeCounting range_counting_of(const rig::Rig& rig, const MappingConfig& mapping) {
    report::RangeCounting counting{.has_rays = false, .cone = {}, .zone = {}, .counts = mapping.map.counts};
    bool has_cone = false;
    bool has_zone = false;
    for (const rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const SensorConfig& config = node.config.sensors[i];
            for (std::size_t z = 0; z < config.zone_count; ++z) {
                const BeamOptics optics = beam_optics(node.sensors[i], config.zones[z]);
                const bool is_counted = mapping.range_update == RangeUpdate::cone && optics.is_cone();
                counting.has_rays |= !is_counted;
                has_zone |= is_counted && optics.is_zone;
                has_cone |= is_counted && !optics.is_zone;
            }
        }
    }
    if (has_cone) counting.cone = mapping.cone;
    if (has_zone) counting.zone = mapping.zone;
    return counting;
}

std::string command_of(const StudyRequest& request) {
    std::string text = "octoskin-lab experiment";
    const auto add_file = [&](const char* option, const std::filesystem::path& file) {
        if (!file.empty()) text += fmt::format(" {} {}", option, shell_word(file.string()));
    };
    add_file("--rig", request.inputs.rig);
    add_file("--robot", request.inputs.robot.urdf);
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
