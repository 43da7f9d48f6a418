#include "host/io/mapping/mapping_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "host/io/folder/confined.hpp"
#include "host/io/mapping/mapping_keys.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin {
namespace {

using rig::Table;

/// Reads one key of `table` over the value that holds without it. A number of a map is stored in single
/// precision: -0.4 in the file is the float nearest to it.
void read_key(const Table& table, const MappingKey& key, MappingConfig& config) {
    const std::string_view name = name_in_table(key);
    if (table.find(name) == nullptr) return;
    const auto read = [&](auto* value) {
        using Value = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>) {
            *value = table.flag(name);
        } else if constexpr (std::is_same_v<Value, DepthUpdate>) {
            *value = table.choice(name, depth_update_words());
        } else if constexpr (std::is_same_v<Value, RangeUpdate>) {
            *value = table.choice(name, range_update_words());
        } else if constexpr (std::is_integral_v<Value>) {
            *value = table.integer<Value>(
                name, {static_cast<std::int64_t>(key.range.min), static_cast<std::int64_t>(key.range.max)});
        } else {
            *value = static_cast<Value>(table.number(name, {key.range.min, key.range.max}));
        }
    };
    std::visit(read, key.value(config));
}

void check_map(const Table& table, const MappingConfig& config) {
    const MapConfig& map = config.map;
    if (map.log_odds_occupied <= map.log_odds_min || map.log_odds_occupied > map.log_odds_max) {
        table.fail("log_odds_occupied",
                   {ErrorCode::conflict,
                    "expected a value above log_odds_min and up to log_odds_max, because "
                    "otherwise no voxel could be free, or none occupied"});
    }
}

void check_age(const Table& table, const MappingConfig& config) {
    const AgeModel& age = config.map.age;
    if (age.unknown_after_s > 0 && age.unknown_after_s <= age.stale_after_s) {
        table.fail(
            "unknown_after_s",
            {ErrorCode::conflict,
             fmt::format("expected more than stale_after_s, {}, or 0 (never), because an unknown voxel "
                         "cannot be stale",
                         age.stale_after_s),
             fmt::format("{}", age.unknown_after_s)});
    }
}

void check_filter(const Table& table, const MappingConfig& config) {
    const DepthFilterConfig& filter = config.depth_filter;
    if (filter.window % 2 == 0) {
        table.fail("window_px",
                   {ErrorCode::bad_value, "expected an odd number", std::to_string(filter.window)});
    }
    for (const auto& [key, gate_m] :
         {std::pair("gate_sigmas", filter.gate_m()), {"mean_sigmas", filter.mean_gate_m()}}) {
        if (gate_m > DepthFilterConfig::kGateMax_m)
            table.fail(key,
                       {ErrorCode::out_of_range,
                        fmt::format("expected at most {} m times sigma_m", DepthFilterConfig::kGateMax_m),
                        fmt::format("{} m", gate_m)});
    }
    const std::uint32_t pixels = filter.window * filter.window;
    if (filter.is_enabled && filter.min_support >= pixels) {
        table.fail(
            "min_support",
            {ErrorCode::conflict,
             fmt::format("expected at most {} with window_px {}, because its window has {} pixels and a "
                         "value needs more than this number of them",
                         pixels - 1, filter.window, pixels),
             std::to_string(filter.min_support), "lower it, widen window_px, or set is_enabled: false"});
    }
}

void check_standing(const Table& table, const MappingConfig& config) {
    if (config.standing.readings == 1)
        table.fail("readings",
                   {ErrorCode::out_of_range,
                    "expected 2 or more, or 0 (never), because a single reading may be wrong", "1"});
}

void check_counts(const Table& table, const MappingConfig& config) {
    const CountModel& counts = config.map.counts;
    if (counts.hits_min >= counts.counts_max)
        table.fail("hits_min", {ErrorCode::conflict,
                                "expected less than counts_max, because no voxel could have so many hits",
                                std::to_string(counts.hits_min)});
    if (counts.misses_min >= counts.counts_max)
        table.fail("misses_min", {ErrorCode::conflict,
                                  "expected less than counts_max, because no voxel could have so many misses",
                                  std::to_string(counts.misses_min)});
}

void check_top(const Table& table, const MappingConfig& config) {
    if (config.refuses_contradicting_sensors && !config.reports_contradicting_sensors)
        table.fail("refuses_contradicting_sensors",
                   {ErrorCode::conflict,
                    "expected false because reports_contradicting_sensors is: a sensor is refused "
                    "only after it was reported"});
}

/// The rules between the keys of one table, which hold where the file has the table.
struct TableRules {
    std::string_view table;
    void (*check)(const Table& table, const MappingConfig& config);
};
constexpr std::array kTableRules = {
    TableRules{"map", check_map}, TableRules{"age", check_age}, TableRules{"depth_filter", check_filter},
    TableRules{"standing", check_standing}, TableRules{"counts", check_counts}};

/// The tables of the file, and the keys at its top.
std::vector<std::string_view> names_at_top() {
    std::vector<std::string_view> names{"base"};
    for (const MappingKey& key : mapping_keys()) {
        const std::string_view table = table_of(key);
        const std::string_view name = table.empty() ? key.path : table;
        if (names.back() != name) names.push_back(name);
    }
    return names;
}
std::vector<std::string_view> names_in(std::string_view table) {
    std::vector<std::string_view> names;
    for (const MappingKey& key : mapping_keys())
        if (table_of(key) == table) names.push_back(name_in_table(key));
    return names;
}
std::vector<std::string> paths_below_top() {
    std::vector<std::string> paths;
    for (const MappingKey& key : mapping_keys())
        if (!table_of(key).empty()) paths.emplace_back(key.path);
    return paths;
}

void read_table(const Table& table, std::string_view name, MappingConfig& config) {
    for (const MappingKey& key : mapping_keys())
        if (table_of(key) == name) read_key(table, key, config);
    const auto rules = std::ranges::find(kTableRules, name, &TableRules::table);
    if (rules != kTableRules.end()) rules->check(table, config);
}

MappingConfig read_checked(const FilePlace& file) {
    const rig::Value document = rig::load_document(confined_to_recording(file));
    for (const std::string_view key : {"nodes", "robot", "sensor_defaults", "extends"}) {
        if (const rig::Value* found = document.find(key)) {
            rig::fail(*found, std::string(key),
                      {.code = ErrorCode::foreign_format,
                       .what = "not a key of a mapping file, but of a rig, which this looks like",
                       .remedy = "give a mapping file (`octoskin mapping` prints one)"});
        }
    }
    const std::vector<std::string_view> names = names_at_top();
    const Table top(document, "", names, paths_below_top());
    MappingConfig config = denoised_mapping();
    if (top.find("base") != nullptr) config = mapping_with(top.choice("base", depth_update_words()));
    for (const std::string_view name : names) {
        const std::vector<std::string_view> keys = names_in(name);
        const rig::Value* value = keys.empty() ? nullptr : top.find(name);
        if (value != nullptr) read_table(Table(*value, std::string(name), keys), name, config);
    }
    read_table(top, "", config);
    check_top(top, config);
    return config;
}

}  // namespace

Result<MappingConfig, Error> read_mapping(const std::string& name_or_file) {
    for (const auto& [name, depth_update] : depth_update_words()) {
        if (name_or_file == name) return mapping_with(depth_update);
    }
    if (name_or_file == "paper_noise_free_robot_seen") {
        MappingConfig mapping = paper_mapping();
        mapping.removes_robot_from_depth = false;
        return mapping;
    }
    return read_mapping_file(name_or_file);
}

Result<MappingConfig, Error> read_mapping_file(const FilePlace& file) {
    try {
        return read_checked(file);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

std::string mapping_text(const MappingConfig& config) {
    std::string text;
    std::string_view table;
    for (const MappingKey& key : mapping_keys()) {
        const bool is_in_table = !table_of(key).empty();
        if (is_in_table && table_of(key) != table) text += fmt::format("{}:\n", table_of(key));
        table = table_of(key);
        text +=
            fmt::format("{}{}: {}\n", is_in_table ? "  " : "", name_in_table(key), value_text(key, config));
    }
    return text;
}

}  // namespace octoskin
