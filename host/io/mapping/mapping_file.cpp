#include "host/io/mapping/mapping_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "hw/rigfile/table.hpp"

namespace octoskin {
namespace {

using rig::Table;
using Keys = std::initializer_list<std::string_view>;

const Keys kTopKeys = {"base",
                       "map",
                       "proximity_hit",
                       "depth_hit",
                       "miss_log_odds",
                       "depth_update",
                       "depth_filter",
                       "removes_robot_from_depth",
                       "removes_robot_from_ranges",
                       "depth_range_max_m",
                       "no_return_clear_m",
                       "depth_box_voxels_max"};
const Keys kMapKeys = {"resolution_m", "log_odds_min", "log_odds_max", "log_odds_occupied", "memory_max_mib"};
const Keys kHitKeys = {"log_odds_offset", "log_odds_slope_per_m", "range_min_m", "is_range_min_exclusive"};
const Keys kFilterKeys = {"is_enabled", "window_px", "sigma_m", "gate_sigmas", "mean_sigmas", "min_support"};

/// The depth updates, each also the name of the configuration that is built round it.
const std::initializer_list<std::pair<std::string_view, DepthUpdate>> kDepthUpdates = {
    {"paper", DepthUpdate::paper}, {"robust", DepthUpdate::robust}, {"fast", DepthUpdate::fast}};

std::string_view name_of(DepthUpdate depth_update) {
    return std::ranges::find(kDepthUpdates, depth_update, [](const auto& entry) { return entry.second; })
        ->first;
}

MappingConfig configuration_of(DepthUpdate depth_update) {
    switch (depth_update) {
        case DepthUpdate::paper:
            return paper_mapping();
        case DepthUpdate::robust:
            return robust_mapping();
        case DepthUpdate::fast:
            return fast_mapping();
    }
    return fast_mapping();
}

std::vector<std::string> keys_below_top() {
    const std::pair<std::string_view, Keys> tables[] = {{"map", kMapKeys},
                                                        {"proximity_hit", kHitKeys},
                                                        {"depth_hit", kHitKeys},
                                                        {"depth_filter", kFilterKeys}};
    std::vector<std::string> paths;
    for (const auto& [table, keys] : tables) {
        for (const std::string_view key : keys) paths.push_back(fmt::format("{}.{}", table, key));
    }
    return paths;
}

/// Single precision is what maps are made of; a file says -0.4 and means the float nearest to it.
float single(const Table& table, std::string_view key, rig::Range<double> range, float fallback) {
    if (table.find(key) == nullptr) return fallback;
    return static_cast<float>(table.number(key, range));
}

MapConfig read_map(const Table& table, MapConfig map) {
    map.resolution_m = table.number("resolution_m", {0.001, 10.0}, map.resolution_m);
    map.log_odds_min = single(table, "log_odds_min", {-100.0, 0.0}, map.log_odds_min);
    map.log_odds_max = single(table, "log_odds_max", {0.0, 100.0}, map.log_odds_max);
    map.log_odds_occupied = single(table, "log_odds_occupied", {-100.0, 100.0}, map.log_odds_occupied);
    map.memory_max_mib = table.integer<std::uint32_t>("memory_max_mib", {1, 1'000'000}, map.memory_max_mib);
    if (map.log_odds_occupied <= map.log_odds_min || map.log_odds_occupied > map.log_odds_max) {
        table.fail("log_odds_occupied",
                   "expected a value above log_odds_min and up to log_odds_max: beyond them "
                   "no voxel could be free, or none occupied");
    }
    return map;
}

HitModel read_hit(const Table& table, HitModel hit) {
    hit.offset = table.number("log_odds_offset", {-100.0, 100.0}, hit.offset);
    hit.slope_per_m = table.number("log_odds_slope_per_m", {-100.0, 100.0}, hit.slope_per_m);
    hit.range_min_m = table.number("range_min_m", {0.0, 100.0}, hit.range_min_m);
    hit.is_min_exclusive = table.flag("is_range_min_exclusive", hit.is_min_exclusive);
    return hit;
}

DepthFilterConfig read_filter(const Table& table, DepthFilterConfig filter) {
    filter.is_enabled = table.flag("is_enabled", filter.is_enabled);
    filter.window = table.integer<std::uint32_t>("window_px", {1, 7}, filter.window);
    if (filter.window % 2 == 0) {
        table.fail("window_px", fmt::format("expected an odd number, found {}", filter.window));
    }
    filter.sigma_m = table.number("sigma_m", {1e-6, 10.0}, filter.sigma_m);
    filter.gate_sigmas = table.number("gate_sigmas", {0.0, 1000.0}, filter.gate_sigmas);
    filter.mean_sigmas = table.number("mean_sigmas", {0.0, 1000.0}, filter.mean_sigmas);
    for (const auto& [key, gate_m] :
         {std::pair("gate_sigmas", filter.gate_m()), {"mean_sigmas", filter.mean_gate_m()}}) {
        if (gate_m > DepthFilterConfig::kGateMax_m)
            table.fail(key, fmt::format("times sigma_m it is {} m; at most {} m", gate_m,
                                        DepthFilterConfig::kGateMax_m));
    }
    filter.min_support = table.integer<std::uint32_t>("min_support", {0, 48}, filter.min_support);
    const std::uint32_t pixels = filter.window * filter.window;
    if (filter.is_enabled && filter.min_support >= pixels) {
        table.fail("min_support",
                   fmt::format("expected at most {} with window_px {}, found {}: a value needs more pixels "
                               "than that, its window has {}, so none would be left; lower it, widen "
                               "window_px, or say is_enabled: false",
                               pixels - 1, filter.window, filter.min_support, pixels));
    }
    return filter;
}

/// Reads the table under `key`, if it is there, over the values that hold without it.
template <class T, class Read>
void read_part(const Table& top, std::string_view key, Keys known_keys, T& part, Read read) {
    if (const rig::Value* value = top.find(key))
        part = read(Table(*value, std::string(key), known_keys), part);
}

void read_hit_part(const Table& top, std::string_view key, HitModel& hit) {
    read_part(top, key, kHitKeys, hit, read_hit);
}

MappingConfig read_checked(const std::string& file) {
    const rig::Value document = rig::load_document(file);
    for (const std::string_view key : {"nodes", "robot", "sensor_defaults", "extends"}) {
        if (const rig::Value* found = document.find(key)) {
            rig::fail(*found, std::string(key),
                      "no key of a mapping file, but of a rig, which this looks like: give a mapping file "
                      "(`octoskin mapping` prints one)");
        }
    }
    const Table top(document, "", kTopKeys, keys_below_top());
    MappingConfig config =
        configuration_of(top.choice<DepthUpdate>("base", kDepthUpdates, DepthUpdate::fast));
    read_part(top, "map", kMapKeys, config.map, read_map);
    read_hit_part(top, "proximity_hit", config.model.proximity);
    read_hit_part(top, "depth_hit", config.model.depth);
    read_part(top, "depth_filter", kFilterKeys, config.depth_filter, read_filter);
    config.model.miss_log_odds = single(top, "miss_log_odds", {-100.0, 0.0}, config.model.miss_log_odds);
    config.depth_update = top.choice<DepthUpdate>("depth_update", kDepthUpdates, config.depth_update);
    config.removes_robot_from_depth = top.flag("removes_robot_from_depth", config.removes_robot_from_depth);
    config.removes_robot_from_ranges =
        top.flag("removes_robot_from_ranges", config.removes_robot_from_ranges);
    config.depth_range_max_m = top.number("depth_range_max_m", {0.0, 100.0}, config.depth_range_max_m);
    config.no_return_clear_m = top.number("no_return_clear_m", {0.0, 100.0}, config.no_return_clear_m);
    config.depth_box_voxels_max =
        top.integer<std::uint32_t>("depth_box_voxels_max", {1000, 1 << 30}, config.depth_box_voxels_max);
    return config;
}

std::string hit_text(std::string_view key, const HitModel& hit) {
    return fmt::format(
        "{}:\n  log_odds_offset: {}\n  log_odds_slope_per_m: {}\n  range_min_m: {}\n"
        "  is_range_min_exclusive: {}\n",
        key, hit.offset, hit.slope_per_m, hit.range_min_m, hit.is_min_exclusive);
}

}  // namespace

Result<MappingConfig, MappingFileError> read_mapping(const std::string& name_or_file) {
    for (const auto& [name, depth_update] : kDepthUpdates) {
        if (name_or_file == name) return configuration_of(depth_update);
    }
    if (name_or_file == "paper_noise_free_robot_seen") {
        MappingConfig mapping = paper_mapping();
        mapping.removes_robot_from_depth = false;
        return mapping;
    }
    try {
        return read_checked(name_or_file);
    } catch (const rig::Fault& fault) {
        return unexpected(fault.error);
    }
}

std::string mapping_text(const MappingConfig& config) {
    const MapConfig& map = config.map;
    const DepthFilterConfig& filter = config.depth_filter;
    std::string text = fmt::format(
        "map:\n  resolution_m: {}\n  log_odds_min: {}\n  log_odds_max: {}\n  log_odds_occupied: {}\n"
        "  memory_max_mib: {}\n",
        map.resolution_m, map.log_odds_min, map.log_odds_max, map.log_odds_occupied, map.memory_max_mib);
    text += hit_text("proximity_hit", config.model.proximity);
    text += hit_text("depth_hit", config.model.depth);
    text += fmt::format("miss_log_odds: {}\ndepth_update: {}\n", config.model.miss_log_odds,
                        name_of(config.depth_update));
    text += fmt::format(
        "depth_filter:\n  is_enabled: {}\n  window_px: {}\n  sigma_m: {}\n  gate_sigmas: {}\n  mean_sigmas: "
        "{}\n"
        "  min_support: {}\n",
        filter.is_enabled, filter.window, filter.sigma_m, filter.gate_sigmas, filter.mean_sigmas,
        filter.min_support);
    text += fmt::format(
        "removes_robot_from_depth: {}\nremoves_robot_from_ranges: {}\n"
        "depth_range_max_m: {}\nno_return_clear_m: {}\n"
        "depth_box_voxels_max: {}\n",
        config.removes_robot_from_depth, config.removes_robot_from_ranges, config.depth_range_max_m,
        config.no_return_clear_m, config.depth_box_voxels_max);
    return text;
}

}  // namespace octoskin
