// octoskin mapping: checks a mapping configuration and prints it in full.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/core/mapping/thin_objects.hpp"
#include "host/core/pipeline/depth_stage.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/mapping/mapping_keys.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin::app {

namespace {

/// Each key with its unit, the accepted values and the default, and its meaning on the lines below.
std::string keys_text() {
    const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
    std::string text;
    for (const MappingKey& key : mapping_keys()) {
        std::string meaning = std::regex_replace(std::string(key.meaning), link, "$1");
        std::erase_if(meaning, [](char character) { return character == '`' || character == '*'; });
        text +=
            fmt::format("{}{}{}{}: {}; default {}\n", key.path, key.unit.empty() ? "" : " [", key.unit,
                        key.unit.empty() ? "" : "]", expected_text(key), value_text(key, denoised_mapping()));
        if (!meaning.empty()) text += fmt::format("    {}\n", meaning);
    }
    return text;
}

/// Depths between the camera's limits, in steps of half a metre or more, and the limits themselves.
std::vector<double> depths_of(const rig::Camera& camera) {
    constexpr double kStep_m = 0.5;
    constexpr double kRowsMax = 10.0;
    const double range_m = camera.depth_max_m - camera.depth_min_m;
    const double step_m = kStep_m * std::max(1.0, std::ceil(range_m / (kStep_m * kRowsMax)));
    std::vector<double> depths{camera.depth_min_m};
    for (double depth_m = step_m; depth_m < camera.depth_max_m; depth_m += step_m)
        if (depth_m > camera.depth_min_m) depths.push_back(depth_m);
    depths.push_back(camera.depth_max_m);
    return depths;
}

std::string millimetres(const std::optional<double>& metres) {
    return metres ? fmt::format("{:.1f}", 1000.0 * *metres) : "none";
}

/// As comments of a YAML file, as all that follows.
std::string thin_table(const ThinView& view, const rig::Camera& camera) {
    const double in_a_second = std::max(1.0, std::round(camera.rate_hz));
    std::string text = fmt::format(
        "# The thinnest object that is kept, at most of a voxel's width ({:.1f} mm), after one image and\n"
        "# after {:.0f}, and how far it must be before the surface behind it; in mm, at depths in m\n"
        "# {:>6}{:>10}{:>10}{:>12}{:>12}{:>12}{:>12}\n",
        1000.0 * view.voxel_m, in_a_second, "depth", "pixel", "noise", "thinnest 1",
        fmt::format("thinnest {:.0f}", in_a_second), "before 1", fmt::format("before {:.0f}", in_a_second));
    for (const double depth_m : depths_of(camera)) {
        text += fmt::format(
            "# {:>6.2f}{:>10}{:>10}{:>12}{:>12}{:>12}{:>12}\n", depth_m, millimetres(depth_m / view.focal_px),
            millimetres(view.denoiser.noise.sigma_m(depth_m)),
            millimetres(thinnest_kept_m(view, depth_m, 1.0)),
            millimetres(thinnest_kept_m(view, depth_m, in_a_second)),
            millimetres(standoff_m(view, depth_m, 1.0)), millimetres(standoff_m(view, depth_m, in_a_second)));
    }
    return text;
}

std::string thin_text(const MappingConfig& mapping, const rig::Camera& camera) {
    const std::string title = camera.name.empty() ? "" : fmt::format("# {}\n", camera_text(camera.name));
    return title + thin_table({.focal_px = std::min(camera.fx, camera.fy),
                               .denoiser = mapping_of(host_camera(camera), mapping).depth_denoiser,
                               .voxel_m = mapping.map.resolution_m},
                              camera);
}

std::string thin_text(const MappingConfig& mapping, const rig::Rig& rig) {
    if (rig.cameras.empty()) return fmt::format("# rig {}: no camera, so no thinnest object\n", rig.name);
    if (mapping.depth_update != DepthUpdate::denoised)
        return "# thinnest objects: known for depth_update denoised only\n";
    std::string text;
    for (const rig::Camera& camera : rig.cameras) text += thin_text(mapping, camera);
    return text;
}

}  // namespace

void add_mapping_command(CLI::App& app) {
    auto name = std::make_shared<std::string>(kDefaultMapping);
    auto lists_keys = std::make_shared<bool>(false);
    auto rig_file = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("mapping", "Check a mapping configuration and print it in full");
    command->add_option("configuration", *name, configuration_help("One of"))->capture_default_str();
    CLI::Option* const keys =
        command->add_flag("--keys", *lists_keys, "List each key with its unit, range, default and meaning");
    command
        ->add_option("--rig", *rig_file,
                     "Print also the thinnest object that each camera of this rig keeps in the map, by depth")
        ->type_name("FILE")
        ->check(existing_file())
        ->excludes(keys);
    command->callback([name, lists_keys, rig_file] {
        if (*lists_keys) return print_text(keys_text());
        const auto configuration = named_mapping(*name);
        if (!configuration) throw CommandFailure(configuration.error());
        std::string text = mapping_text(configuration->mapping);
        if (!rig_file->empty())
            text += "\n" + thin_text(configuration->mapping, value_or_fail(read_given_rig(*rig_file)));
        print_text(text);
    });
}

}  // namespace octoskin::app
