#include "hw/rigfile/sensor_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/zone.hpp"

namespace octoskin::rig {
namespace {

constexpr std::uint8_t kDefaultAddress =
    0x29;  ///< VL53L1X datasheet DS12385 rev 7: the address after power-on
constexpr std::int64_t kSpareMs =
    5;  ///< a shorter pause after the budget makes the device skip every other slot
constexpr std::int64_t kBudgetMaxMs = 200;  ///< the wire's time field spans 262 ms
/// ST ULD 3.5.2, VL53L1X_SetTimingBudgetInMs; medium mode, which it does not have, needs 33 ms (datasheet
/// DS12385 rev 7, 2.5.2). ST has 500 ms as well, which the wire's time field cannot carry.
constexpr std::array<std::int64_t, 6> kShortBudgetsMs = {15, 20, 33, 50, 100, 200};
constexpr std::array<std::int64_t, 4> kMediumBudgetsMs = {33, 50, 100, 200};
constexpr std::array<std::int64_t, 5> kLongBudgetsMs = {20, 33, 50, 100, 200};

struct ModeBudgets {
    const char* mode;
    std::span<const std::int64_t> budgets_ms;
};
ModeBudgets mode_budgets(DistanceMode mode) {
    if (mode == DistanceMode::short_range) return {"short", kShortBudgetsMs};
    if (mode == DistanceMode::medium_range) return {"medium", kMediumBudgetsMs};
    return {"long", kLongBudgetsMs};
}

void read_wiring(const Table& table, const Board& board, SensorConfig& config) {
    config.bus = table.integer<std::uint8_t>("bus", {0, board.i2c_bus_count - 1});
    config.xshut_line = table.integer<std::uint8_t>("xshut_line", {0, board.xshut_line_count - 1});
    config.address = table.integer<std::uint8_t>("address", {0x08, 0x77});
    if (config.address == kDefaultAddress) {
        table.fail("address",
                   "expected any address but 0x29, found 0x29: a sensor that resets itself answers there");
    }
}

void read_timing(const Table& table, SensorConfig& config) {
    config.distance_mode =
        table.choice<DistanceMode>("distance_mode", {{"short", DistanceMode::short_range},
                                                     {"medium", DistanceMode::medium_range},
                                                     {"long", DistanceMode::long_range}});
    const auto budget_ms = table.integer<std::int64_t>("timing_budget_ms", {1, 1000});
    if (budget_ms > kBudgetMaxMs) {
        table.fail("timing_budget_ms",
                   fmt::format("expected at most {}, found {}: a reading's time on the wire would be "
                               "ambiguous",
                               kBudgetMaxMs, budget_ms));
    }
    const auto [mode, budgets_ms] = mode_budgets(config.distance_mode);
    if (std::find(budgets_ms.begin(), budgets_ms.end(), budget_ms) == budgets_ms.end()) {
        table.fail("timing_budget_ms", fmt::format("expected one of {} in {} mode, found {}",
                                                   joined(budgets_ms), mode, budget_ms));
    }
    const auto period_ms = table.integer<std::int64_t>("inter_measurement_ms", {1, 10'000});
    if (period_ms < budget_ms + kSpareMs) {
        table.fail(
            "inter_measurement_ms",
            fmt::format(
                "expected at least timing_budget_ms + {} = {}, found {}: the device would range at half the "
                "rate",
                kSpareMs, budget_ms + kSpareMs, period_ms));
    }
    config.timing_budget_ms = static_cast<std::uint16_t>(budget_ms);
    config.inter_measurement_ms = static_cast<std::uint16_t>(period_ms);
    config.phase_us = table.integer<std::uint16_t>(
        "phase_us", {0, std::min<std::int64_t>(period_ms * 1000 - 1, 65'535)}, std::uint16_t{0});
}

/// A number in the device's fixed point, rounded to its nearest step.
template <class T>
T fixed_point(const Table& table, std::string_view key, Range<double> range, double steps_per_unit,
              T fallback) {
    const double number = table.number(key, range, static_cast<double>(fallback) / steps_per_unit);
    return static_cast<T>(std::lround(number * steps_per_unit));
}

/// Exact, not rounded to the nearest step: a limit of 0.4 mm would become 0, which means no limit.
std::uint16_t read_reflex_limit_mm(const Table& table) {
    constexpr double kRoundingMm = 1e-6;  // of a decimal fraction times 1000
    const double limit_m = table.number("reflex_below_m", {0.0, kReflexLimitMaxMm / 1000.0}, 0.0);
    const double limit_mm = std::round(1000.0 * limit_m);
    if (std::abs(1000.0 * limit_m - limit_mm) > kRoundingMm) {
        table.fail("reflex_below_m",
                   fmt::format("expected whole millimetres, found {} mm", 1000.0 * limit_m));
    }
    return static_cast<std::uint16_t>(limit_mm);
}

void read_device_settings(const Table& table, SensorConfig& config) {
    config.has_offset = table.find("device_offset_mm") != nullptr;
    config.offset_quarter_mm =
        fixed_point<std::int16_t>(table, "device_offset_mm", {-1024.0, 1023.75}, 4.0, 0);
    config.crosstalk_raw =
        fixed_point<std::uint16_t>(table, "crosstalk_kcps", {0.0, 127.0}, 512.0, config.crosstalk_raw);
    config.sigma_limit_quarter_mm = fixed_point<std::uint16_t>(table, "sigma_limit_mm", {0.25, 16'000.0}, 4.0,
                                                               config.sigma_limit_quarter_mm);
    config.signal_limit_raw =
        fixed_point<std::uint16_t>(table, "signal_limit_mcps", {0.0, 511.0}, 128.0, config.signal_limit_raw);
    config.reflex_below_mm = read_reflex_limit_mm(table);
    config.applies_gain_factor = table.flag("applies_gain_factor", config.applies_gain_factor);
}

void read_zones(const Table& table, SensorEntry& entry) {
    const Value* zones = table.find("zones");
    if (!zones) return;
    const std::string path = table.path_of("zones");
    const auto& items = read_list(*zones, path);
    if (items.empty() || items.size() > kSensorZonesMax) {
        fail(*zones, path, fmt::format("expected 1 to {} zones, found {}", kSensorZonesMax, items.size()));
    }
    entry.config.zone_count = static_cast<std::uint8_t>(items.size());
    entry.sensor.zone_offset_m.clear();
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table zone(items[i], fmt::format("{}[{}]", path, i),
                         {"centre_spad", "width_spads", "height_spads", "offset_m"});
        const Roi roi{zone.integer<std::uint8_t>("centre_spad", {0, 255}),
                      zone.integer<std::uint8_t>("width_spads", {4, 16}),
                      zone.integer<std::uint8_t>("height_spads", {4, 16})};
        if (!fits_on_array(roi)) {
            zone.fail("centre_spad",
                      fmt::format("expected a zone within the 16 x 16 array, found {} x {} about SPAD {}",
                                  roi.width, roi.height, roi.centre_spad));
        }
        entry.config.zones[i] = roi;
        entry.sensor.zone_offset_m.push_back(zone.number("offset_m", {-0.5, 0.5}, 0.0));
    }
}

std::optional<Cone> read_cone(const Table& table) {
    const Value* value = table.find("cone");
    if (value == nullptr) return std::nullopt;
    const Table entry(*value, table.path_of("cone"), {"sub_rays", "half_angle_deg", "sigma_deg", "blur_deg"});
    Cone cone;
    cone.sub_rays = entry.integer<std::uint8_t>("sub_rays", {1, 64}, cone.sub_rays);
    cone.half_angle_deg = entry.number("half_angle_deg", {0.1, 45.0}, cone.half_angle_deg);
    cone.sigma_deg = entry.number("sigma_deg", {0.1, 90.0}, cone.sigma_deg);
    cone.blur_deg = entry.number("blur_deg", {0.1, 20.0}, cone.blur_deg);
    return cone;
}

std::string read_link(const Table& table, const UrdfDocument& robot, const std::string& base_link) {
    auto link = table.element_name("link");
    if (!robot.is_below(base_link, link)) {
        table.fail("link", fmt::format("expected a link of {} at or below {}, found '{}'; there are {}",
                                       robot.file().filename().string(), base_link, link,
                                       joined(robot.link_names(base_link))));
    }
    return link;
}

}  // namespace

Table sensor_table(const Value& value, const std::string& path) {
    return {value,
            path,
            {"name", "link", "pose", "bus", "xshut_line", "address", "distance_mode", "timing_budget_ms",
             "inter_measurement_ms", "phase_us", "device_offset_mm", "crosstalk_kcps", "sigma_limit_mm",
             "signal_limit_mcps", "reflex_below_m", "applies_gain_factor", "zones", "cone"}};
}

SensorEntry read_sensor(const Table& table, const UrdfDocument& robot, const std::string& base_link,
                        const Board& board) {
    SensorEntry entry;
    entry.sensor.name = table.name("name");
    entry.sensor.link = read_link(table, robot, base_link);
    entry.sensor.T_link_sensor = read_pose(table.require("pose"), table.path_of("pose"), {});
    read_wiring(table, board, entry.config);
    read_timing(table, entry.config);
    read_device_settings(table, entry.config);
    read_zones(table, entry);
    entry.sensor.cone = read_cone(table);
    return entry;
}

}  // namespace octoskin::rig
