#include "host/io/mapping/mapping_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "host/io/folder/confined.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin {
namespace {

using rig::Table;
using Keys = std::initializer_list<std::string_view>;

const Keys kTopKeys = {"base",
                       "map",
                       "age",
                       "proximity_hit",
                       "depth_hit",
                       "miss_log_odds",
                       "depth_update",
                       "depth_filter",
                       "range_update",
                       "cone",
                       "zone",
                       "standing",
                       "counts",
                       "removes_robot_from_depth",
                       "removes_robot_from_ranges",
                       "reports_contradicting_sensors",
                       "refuses_contradicting_sensors",
                       "depth_range_max_m",
                       "no_return_clear_m",
                       "depth_box_voxels_max"};
const Keys kMapKeys = {"resolution_m",     "log_odds_min",      "log_odds_max",  "log_odds_passed_max",
                       "log_odds_hit_min", "log_odds_occupied", "memory_max_mib"};
const Keys kAgeKeys = {"stale_after_s", "unknown_after_s"};
const Keys kHitKeys = {"log_odds_offset", "log_odds_slope_per_m", "range_min_m", "is_range_min_exclusive"};
const Keys kFilterKeys = {"is_enabled", "window_px", "sigma_m", "gate_sigmas", "mean_sigmas", "min_support"};
const Keys kConeKeys = {"hit_range_max_m", "cap_half_thickness_m", "cap_sigmas", "cap_angle_share",
                        "core_weight_min", "core_margin_voxels",   "hit_mass",   "miss_mass"};
const Keys kStandingKeys = {"readings", "hits", "angle_share", "clears_after_s"};
const Keys kCountKeys = {"prior_hits",           "prior_misses", "occupied_hits", "free_misses",
                         "occupied_probability", "hits_min",     "misses_min",    "counts_max",
                         "image_clears",         "image_marks",  "range_clears",  "range_clears_from"};

const std::initializer_list<std::pair<std::string_view, RangeUpdate>> kRangeUpdates = {
    {"ray", RangeUpdate::ray}, {"cone", RangeUpdate::cone}};

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
                                                        {"age", kAgeKeys},
                                                        {"proximity_hit", kHitKeys},
                                                        {"depth_hit", kHitKeys},
                                                        {"depth_filter", kFilterKeys},
                                                        {"cone", kConeKeys},
                                                        {"zone", kConeKeys},
                                                        {"standing", kStandingKeys},
                                                        {"counts", kCountKeys}};
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
    map.log_odds_passed_max = single(table, "log_odds_passed_max", {-100.0, 100.0}, map.log_odds_passed_max);
    map.log_odds_hit_min = single(table, "log_odds_hit_min", {-100.0, 100.0}, map.log_odds_hit_min);
    map.log_odds_occupied = single(table, "log_odds_occupied", {-100.0, 100.0}, map.log_odds_occupied);
    map.memory_max_mib = table.integer<std::uint32_t>("memory_max_mib", {1, 1'000'000}, map.memory_max_mib);
    if (map.log_odds_occupied <= map.log_odds_min || map.log_odds_occupied > map.log_odds_max) {
        table.fail("log_odds_occupied",
                   "expected a value above log_odds_min and up to log_odds_max: beyond them "
                   "no voxel could be free, or none occupied");
    }
    return map;
}

AgeModel read_age(const Table& table, AgeModel age) {
    constexpr std::uint32_t kLongest_s = 7200;
    age.stale_after_s = table.integer<std::uint32_t>("stale_after_s", {0, kLongest_s}, age.stale_after_s);
    age.unknown_after_s =
        table.integer<std::uint32_t>("unknown_after_s", {0, kLongest_s}, age.unknown_after_s);
    if (age.unknown_after_s > 0 && age.unknown_after_s <= age.stale_after_s) {
        table.fail(
            "unknown_after_s",
            fmt::format("expected more than stale_after_s, {}, or 0 (never), found {}: what is unknown is "
                        "no longer stale",
                        age.stale_after_s, age.unknown_after_s));
    }
    return age;
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

ConeModel read_cone(const Table& table, ConeModel cone) {
    cone.hit_range_max_m = table.number("hit_range_max_m", {0.0, 100.0}, cone.hit_range_max_m);
    cone.cap_half_thickness_m = table.number("cap_half_thickness_m", {0.0, 1.0}, cone.cap_half_thickness_m);
    cone.cap_sigmas = table.number("cap_sigmas", {0.0, 10.0}, cone.cap_sigmas);
    cone.cap_angle_share = table.number("cap_angle_share", {0.0, 1.0}, cone.cap_angle_share);
    cone.core_weight_min = table.number("core_weight_min", {0.01, 0.999}, cone.core_weight_min);
    cone.core_margin_voxels = table.number("core_margin_voxels", {0.0, 2.0}, cone.core_margin_voxels);
    cone.hit_mass = single(table, "hit_mass", {0.0, 100.0}, cone.hit_mass);
    cone.miss_mass = single(table, "miss_mass", {0.0, 100.0}, cone.miss_mass);
    return cone;
}

StationaryModel read_standing(const Table& table, StationaryModel standing) {
    constexpr std::uint32_t kReadingsMax = 8;
    standing.readings = table.integer<std::uint32_t>("readings", {0, kReadingsMax}, standing.readings);
    standing.hits = single(table, "hits", {0.0, 10'000.0}, standing.hits);
    standing.angle_share = table.number("angle_share", {0.0, 1.0}, standing.angle_share);
    standing.clears_after_s = table.number("clears_after_s", {0.0, 5.0}, standing.clears_after_s);
    if (standing.readings == 1)
        table.fail("readings", "expected 2 or more, or 0 (never), found 1: one reading alone may be wrong");
    return standing;
}

CountModel read_counts(const Table& table, CountModel counts) {
    counts.prior_hits = single(table, "prior_hits", {0.001, 100.0}, counts.prior_hits);
    counts.prior_misses = single(table, "prior_misses", {0.001, 100.0}, counts.prior_misses);
    counts.occupied_hits = single(table, "occupied_hits", {0.0, 10'000.0}, counts.occupied_hits);
    counts.free_misses = single(table, "free_misses", {0.0, 10'000.0}, counts.free_misses);
    counts.occupied_probability =
        single(table, "occupied_probability", {0.01, 0.99}, counts.occupied_probability);
    counts.hits_min = single(table, "hits_min", {0.0, 1000.0}, counts.hits_min);
    counts.misses_min = single(table, "misses_min", {0.0, 1000.0}, counts.misses_min);
    counts.counts_max = single(table, "counts_max", {1.0, 10'000.0}, counts.counts_max);
    counts.image_clears = single(table, "image_clears", {0.0, 1.0}, counts.image_clears);
    counts.image_marks = single(table, "image_marks", {0.0, 1.0}, counts.image_marks);
    counts.range_clears = single(table, "range_clears", {0.0, 100.0}, counts.range_clears);
    counts.range_clears_from = single(table, "range_clears_from", {0.0, 10'000.0}, counts.range_clears_from);
    if (counts.hits_min >= counts.counts_max)
        table.fail("hits_min", "expected less than counts_max: no voxel could have so many hits");
    if (counts.misses_min >= counts.counts_max)
        table.fail("misses_min", "expected less than counts_max: no voxel could have so many misses");
    return counts;
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

MappingConfig read_checked(const FilePlace& file) {
    const rig::Value document = rig::load_document(confined_to_recording(file));
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
    read_part(top, "age", kAgeKeys, config.map.age, read_age);
    read_hit_part(top, "proximity_hit", config.model.proximity);
    read_hit_part(top, "depth_hit", config.model.depth);
    read_part(top, "depth_filter", kFilterKeys, config.depth_filter, read_filter);
    config.range_update = top.choice<RangeUpdate>("range_update", kRangeUpdates, config.range_update);
    read_part(top, "cone", kConeKeys, config.cone, read_cone);
    read_part(top, "zone", kConeKeys, config.zone, read_cone);
    read_part(top, "standing", kStandingKeys, config.standing, read_standing);
    read_part(top, "counts", kCountKeys, config.map.counts, read_counts);
    config.model.miss_log_odds = single(top, "miss_log_odds", {-100.0, 0.0}, config.model.miss_log_odds);
    config.depth_update = top.choice<DepthUpdate>("depth_update", kDepthUpdates, config.depth_update);
    config.removes_robot_from_depth = top.flag("removes_robot_from_depth", config.removes_robot_from_depth);
    config.removes_robot_from_ranges =
        top.flag("removes_robot_from_ranges", config.removes_robot_from_ranges);
    config.reports_contradicting_sensors =
        top.flag("reports_contradicting_sensors", config.reports_contradicting_sensors);
    config.refuses_contradicting_sensors =
        top.flag("refuses_contradicting_sensors", config.refuses_contradicting_sensors);
    if (config.refuses_contradicting_sensors && !config.reports_contradicting_sensors)
        top.fail(
            "refuses_contradicting_sensors",
            "expected false where reports_contradicting_sensors is: a sensor is refused once it is named");
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

std::string cone_text(std::string_view key, const ConeModel& cone) {
    return fmt::format(
        "{}:\n  hit_range_max_m: {}\n  cap_half_thickness_m: {}\n  cap_sigmas: {}\n  cap_angle_share: {}\n"
        "  core_weight_min: {}\n  core_margin_voxels: {}\n  hit_mass: {}\n  miss_mass: {}\n",
        key, cone.hit_range_max_m, cone.cap_half_thickness_m, cone.cap_sigmas, cone.cap_angle_share,
        cone.core_weight_min, cone.core_margin_voxels, cone.hit_mass, cone.miss_mass);
}

std::string counts_text(const CountModel& counts) {
    return fmt::format(
        "counts:\n  prior_hits: {}\n  prior_misses: {}\n  occupied_hits: {}\n  free_misses: {}\n"
        "  occupied_probability: {}\n  hits_min: {}\n  misses_min: {}\n  counts_max: {}\n  image_clears: "
        "{}\n  image_marks: {}\n  range_clears: {}\n  range_clears_from: {}\n",
        counts.prior_hits, counts.prior_misses, counts.occupied_hits, counts.free_misses,
        counts.occupied_probability, counts.hits_min, counts.misses_min, counts.counts_max,
        counts.image_clears, counts.image_marks, counts.range_clears, counts.range_clears_from);
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
    return read_mapping_file(name_or_file);
}

Result<MappingConfig, MappingFileError> read_mapping_file(const FilePlace& file) {
    try {
        return read_checked(file);
    } catch (const rig::Fault& fault) {
        return unexpected(fault.error);
    }
}

std::string mapping_text(const MappingConfig& config) {
    const MapConfig& map = config.map;
    const DepthFilterConfig& filter = config.depth_filter;
    std::string text = fmt::format(
        "map:\n  resolution_m: {}\n  log_odds_min: {}\n  log_odds_max: {}\n  log_odds_passed_max: {}\n"
        "  log_odds_hit_min: {}\n  log_odds_occupied: {}\n  memory_max_mib: {}\n"
        "age:\n  stale_after_s: {}\n  unknown_after_s: {}\n",
        map.resolution_m, map.log_odds_min, map.log_odds_max, map.log_odds_passed_max, map.log_odds_hit_min,
        map.log_odds_occupied, map.memory_max_mib, map.age.stale_after_s, map.age.unknown_after_s);
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
    text += fmt::format("range_update: {}\n", config.range_update == RangeUpdate::cone ? "cone" : "ray");
    text += cone_text("cone", config.cone) + cone_text("zone", config.zone);
    text += fmt::format("standing:\n  readings: {}\n  hits: {}\n  angle_share: {}\n  clears_after_s: {}\n",
                        config.standing.readings, config.standing.hits, config.standing.angle_share,
                        config.standing.clears_after_s);
    text += counts_text(map.counts);
    text += fmt::format(
        "removes_robot_from_depth: {}\nremoves_robot_from_ranges: {}\n"
        "reports_contradicting_sensors: {}\nrefuses_contradicting_sensors: {}\n"
        "depth_range_max_m: {}\nno_return_clear_m: {}\n"
        "depth_box_voxels_max: {}\n",
        config.removes_robot_from_depth, config.removes_robot_from_ranges,
        config.reports_contradicting_sensors, config.refuses_contradicting_sensors, config.depth_range_max_m,
        config.no_return_clear_m, config.depth_box_voxels_max);
    return text;
}

}  // namespace octoskin
