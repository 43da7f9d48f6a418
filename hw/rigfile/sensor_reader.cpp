#include "hw/rigfile/sensor_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/zone.hpp"

namespace octoskin::rig {
namespace {

constexpr std::uint8_t kDefaultAddress =
    0x29;  ///< VL53L1X datasheet DS12385 rev 7: the address after power-on
constexpr std::int64_t kSpareMs =
    5;  ///< a shorter pause after the budget makes the device skip every other slot
constexpr std::int64_t kBudgetMaxMs = 200;  ///< the wire's time field spans 262 ms
static_assert(std::ranges::max(keys::sensor::kTimingBudget.values) == kBudgetMaxMs);

std::span<const std::int64_t> budgets_of(DistanceMode mode) {
    if (mode == DistanceMode::short_range) return keys::sensor::kShortBudgets_ms;
    if (mode == DistanceMode::medium_range) return keys::sensor::kMediumBudgets_ms;
    return keys::sensor::kLongBudgets_ms;
}

void read_wiring(const Table& table, const Board& board, SensorConfig& config) {
    config.bus = table.integer<std::uint8_t>(keys::sensor::kBus,
                                             {keys::sensor::kBus.range.min, board.i2c_bus_count - 1});
    config.xshut_line = table.integer<std::uint8_t>(
        keys::sensor::kXshutLine, {keys::sensor::kXshutLine.range.min, board.xshut_line_count - 1});
    config.address = table.integer<std::uint8_t>(keys::sensor::kAddress);
    if (config.address == kDefaultAddress) {
        table.fail(keys::sensor::kAddress,
                   {ErrorCode::bad_value,
                    "expected any address but 0x29, at which a sensor that resets itself answers", "0x29"});
    }
}

void read_timing(const Table& table, SensorConfig& config) {
    config.distance_mode = table.choice(keys::sensor::kDistanceMode);
    const auto budget_ms = table.integer<std::int64_t>(keys::sensor::kTimingBudget);
    if (budget_ms > kBudgetMaxMs) {
        table.fail(
            keys::sensor::kTimingBudget,
            {ErrorCode::out_of_range,
             fmt::format("expected at most {}, because the time of a reading on the bus would be ambiguous",
                         kBudgetMaxMs),
             std::to_string(budget_ms)});
    }
    const auto budgets_ms = budgets_of(config.distance_mode);
    if (std::ranges::find(budgets_ms, budget_ms) == budgets_ms.end()) {
        table.fail(keys::sensor::kTimingBudget,
                   {ErrorCode::out_of_range,
                    fmt::format("expected one of {} in {} mode", joined(budgets_ms),
                                word_of(keys::sensor::kDistanceMode, config.distance_mode)),
                    std::to_string(budget_ms)});
    }
    const auto period_ms = table.integer<std::int64_t>(keys::sensor::kInterMeasurement);
    if (period_ms < budget_ms + kSpareMs) {
        table.fail(
            keys::sensor::kInterMeasurement,
            {ErrorCode::conflict,
             fmt::format(
                 "expected at least timing_budget_ms + {} = {}, because the device would range at half "
                 "the rate",
                 kSpareMs, budget_ms + kSpareMs),
             std::to_string(period_ms)});
    }
    config.timing_budget_ms = static_cast<std::uint16_t>(budget_ms);
    config.inter_measurement_ms = static_cast<std::uint16_t>(period_ms);
    config.phase_us = table.integer<std::uint16_t>(
        keys::sensor::kPhase,
        {keys::sensor::kPhase.range.min, std::min(period_ms * 1000 - 1, keys::sensor::kPhase.range.max)});
}

/// A number in the device's fixed point, rounded to its nearest step.
template <class T>
T fixed_point(const Table& table, const NumberKey& key, double steps_per_unit) {
    return static_cast<T>(std::lround(table.number(key) * steps_per_unit));
}

/// Exact, not rounded to the nearest step: a limit of 0.4 mm would become 0, which means no limit.
std::uint16_t read_reflex_limit_mm(const Table& table) {
    constexpr double kRoundingMm = 1e-6;  // of a decimal fraction times 1000
    const double limit_m = table.number(keys::sensor::kReflexBelow);
    const double limit_mm = std::round(1000.0 * limit_m);
    if (std::abs(1000.0 * limit_m - limit_mm) > kRoundingMm) {
        table.fail(keys::sensor::kReflexBelow, {ErrorCode::bad_value, "expected whole millimetres",
                                                fmt::format("{} mm", 1000.0 * limit_m)});
    }
    return static_cast<std::uint16_t>(limit_mm);
}

void read_device_settings(const Table& table, SensorConfig& config) {
    config.has_offset = table.find(keys::sensor::kDeviceOffset) != nullptr;
    if (config.has_offset)
        config.offset_quarter_mm =
            fixed_point<std::int16_t>(table, keys::sensor::kDeviceOffset, keys::sensor::kQuartersPer_mm);
    config.crosstalk_raw =
        fixed_point<std::uint16_t>(table, keys::sensor::kCrosstalk, keys::sensor::kCrosstalkStepsPer_kcps);
    config.sigma_limit_quarter_mm =
        fixed_point<std::uint16_t>(table, keys::sensor::kSigmaLimit, keys::sensor::kQuartersPer_mm);
    config.signal_limit_raw =
        fixed_point<std::uint16_t>(table, keys::sensor::kSignalLimit, keys::sensor::kSignalStepsPer_mcps);
    config.reflex_below_mm = read_reflex_limit_mm(table);
    config.applies_gain_factor = table.flag(keys::sensor::kAppliesGainFactor);
}

void read_zones(const Table& table, SensorEntry& entry) {
    const Value* zones = table.find(keys::sensor::kZones);
    if (!zones) return;
    const std::string path = table.path_of(keys::sensor::kZones);
    const auto& items = read_list(*zones, path);
    if (items.size() < keys::sensor::kZones.count.min || items.size() > keys::sensor::kZones.count.max) {
        fail(*zones, path,
             {ErrorCode::limit_exceeded,
              fmt::format("expected {} to {} zones", keys::sensor::kZones.count.min,
                          keys::sensor::kZones.count.max),
              std::to_string(items.size())});
    }
    entry.config.zone_count = static_cast<std::uint8_t>(items.size());
    entry.sensor.zone_offset_m.clear();
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table zone(items[i], fmt::format("{}[{}]", path, i), keys::kZone);
        const Roi roi{zone.integer<std::uint8_t>(keys::zone::kCentre),
                      zone.integer<std::uint8_t>(keys::zone::kWidth),
                      zone.integer<std::uint8_t>(keys::zone::kHeight)};
        if (!fits_on_array(roi)) {
            zone.fail(keys::zone::kCentre,
                      {ErrorCode::out_of_range, "expected a zone within the 16 x 16 array",
                       fmt::format("{} x {} about SPAD {}", roi.width, roi.height, roi.centre_spad)});
        }
        entry.config.zones[i] = roi;
        entry.sensor.zone_offset_m.push_back(zone.number(keys::zone::kOffset));
    }
}

std::optional<Cone> read_cone(const Table& table) {
    const Value* value = table.find(keys::sensor::kCone);
    if (value == nullptr) return std::nullopt;
    const Table entry(*value, table.path_of(keys::sensor::kCone), keys::kCone);
    return Cone{.sub_rays = entry.integer<std::uint8_t>(keys::cone::kSubRays),
                .half_angle_deg = entry.number(keys::cone::kHalfAngle),
                .sigma_deg = entry.number(keys::cone::kSigma),
                .blur_deg = entry.number(keys::cone::kBlur)};
}

std::string read_link(const Table& table, const UrdfDocument& robot, const std::string& base_link) {
    auto link = table.text(keys::sensor::kLink);
    if (!robot.is_below(base_link, link)) {
        table.fail(
            keys::sensor::kLink,
            {ErrorCode::unknown_name,
             fmt::format("expected a link of {} at or below {}", robot.file().filename().string(), base_link),
             fmt::format("'{}'", link), "there are " + joined(robot.link_names(base_link))});
    }
    return link;
}

}  // namespace

Table sensor_table(const Value& value, const std::string& path) {
    return {value, path, keys::kSensor};
}

SensorEntry read_sensor(const Table& table, const UrdfDocument& robot, const std::string& base_link,
                        const Board& board) {
    SensorEntry entry;
    entry.sensor.name = table.text(keys::sensor::kName);
    entry.sensor.link = read_link(table, robot, base_link);
    entry.sensor.T_link_sensor =
        read_pose(table.require(keys::sensor::kPose), table.path_of(keys::sensor::kPose), {});
    read_wiring(table, board, entry.config);
    read_timing(table, entry.config);
    read_device_settings(table, entry.config);
    read_zones(table, entry);
    entry.sensor.cone = read_cone(table);
    return entry;
}

}  // namespace octoskin::rig
