#include "hw/sim/scenario/scenario.hpp"

#include <cmath>

#include "host/io/folder/confined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/sim/noise/noise.hpp"

namespace octoskin::sim {
namespace {

using rig::Table;
using rig::Value;

constexpr double kReach_m = 20.0;  ///< of positions: a larger value is probably in millimetres

Eigen::Vector3d position(const Table& table, std::string_view key) {
    return rig::read_position(table.require(key), table.path_of(key), kReach_m);
}

/// Three numbers of length 1.
Eigen::Vector3d unit_vector(const Table& table, std::string_view key) {
    Eigen::Vector3d vector = rig::read_position(table.require(key), table.path_of(key), 1.0);
    if (std::abs(vector.norm() - 1.0) > 1e-9) {
        table.fail(key, "expected three numbers that make a vector of length 1, found length " +
                            std::to_string(vector.norm()));
    }
    return vector;
}

Eigen::VectorXd joint_positions(const Table& table, std::string_view key) {
    const auto& items = rig::read_list(table.require(key), table.path_of(key));
    Eigen::VectorXd positions(static_cast<Eigen::Index>(items.size()));
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::string path = table.path_of(key) + "[" + std::to_string(i) + "]";
        positions[static_cast<Eigen::Index>(i)] = rig::read_number(items[i], path, {-10.0, 10.0});
    }
    return positions;
}

void note_place(const Table& table, std::string_view key, Scenario& scenario) {
    const Value& value = table.require(key);
    scenario.places[table.path_of(key)] = {value.file->shown(), value.line};
}

CircleMotion read_circle(const Value& value, const std::string& path, Scenario& scenario) {
    const Table table(value, path,
                      {"link", "centre", "radius_m", "towards_start", "towards_quarter",
                       "ticks_per_revolution", "tick_rate_hz", "revolutions", "start_position_rad"});
    CircleMotion motion;
    motion.link = table.element_name("link");
    const Eigen::Isometry3d T_base_centre =
        rig::read_pose(table.require("centre"), table.path_of("centre"), {.reach_m = kReach_m});
    motion.p_base_centre = T_base_centre.translation();
    motion.R_base_link = T_base_centre.linear();
    motion.radius_m = table.number("radius_m", {0.0, 5.0});
    motion.towards_start = unit_vector(table, "towards_start");
    motion.towards_quarter = unit_vector(table, "towards_quarter");
    if (std::abs(motion.towards_start.dot(motion.towards_quarter)) > 1e-9) {
        table.fail("towards_quarter", "expected a vector at right angles to towards_start");
    }
    motion.ticks_per_revolution = table.integer<std::uint32_t>("ticks_per_revolution", {3, 100'000});
    motion.tick_rate_hz = table.number("tick_rate_hz", {1.0, 1000.0});
    motion.revolutions = table.integer<std::uint32_t>("revolutions", {1, 1000}, 1U);
    motion.start_position = joint_positions(table, "start_position_rad");
    note_place(table, "link", scenario);
    note_place(table, "start_position_rad", scenario);
    return motion;
}

void read_motion(const Table& top, Scenario& scenario) {
    const Table table(top.require("motion"), "motion", {"rest_s", "circle"});
    // A node is usable after two SYNCs at 1 Hz, and all must be usable at START.
    scenario.rest_s = table.number("rest_s", {3.0, 600.0});
    scenario.motion = read_circle(table.require("circle"), table.path_of("circle"), scenario);
    note_place(table, "circle", scenario);
}

void read_sensing(const Table& top, Scenario& scenario) {
    const Table depth(top.require("depth"), "depth", {"sigma_m"});
    scenario.depth_sigma_m = depth.number("sigma_m", {0.0, 1.0});
    const Table ranges(top.require("ranges"), "ranges", {"sigma_m", "min_m", "max_m", "reflectivity"});
    scenario.ranges.sigma_m = ranges.number("sigma_m", {0.0, 1.0});
    scenario.ranges.min_m = ranges.number("min_m", {0.0, 10.0});
    scenario.ranges.max_m = ranges.number("max_m", {scenario.ranges.min_m, 10.0});
    scenario.ranges.reflectivity = ranges.number("reflectivity", {0.01, 1.0}, scenario.ranges.reflectivity);
}

SlowClockSpread read_slow_clocks(const Table& top) {
    SlowClockSpread spread;
    const Value* value = top.find("slow_clocks");
    if (value == nullptr) return spread;
    // No known part deviates this far; a value outside is probably in percent.
    constexpr rig::Range<double> kModelled{0.9, 1.2};
    const Table table(*value, "slow_clocks", {"factor_min", "factor_max"});
    spread.factor_min = table.number("factor_min", kModelled, spread.factor_min);
    spread.factor_max = table.number("factor_max", kModelled, spread.factor_max);
    if (spread.factor_max < spread.factor_min)
        table.fail("factor_max", "expected at least factor_min, " + std::to_string(spread.factor_min));
    return spread;
}

TraitsOf read_traits(const Value& value, const std::string& path) {
    constexpr rig::Range<std::int64_t> kTimeUs{0, 20'000};
    const Table table(value, path,
                      {"node_id", "sensor", "register", "reads", "mask", "range_spread_us", "range_step_us",
                       "boot_load_us"});
    TraitsOf of;
    if (table.find("node_id") != nullptr) of.node_id = table.integer<std::uint8_t>("node_id", {1, 61});
    if (table.find("sensor") != nullptr)
        of.sensor = table.integer<std::uint8_t>("sensor", {0, kNodeSensorsMax - 1});
    if (table.find("register") != nullptr) {
        of.traits.misread.push_back({.index = table.integer<std::uint16_t>("register", {0, 0x1FF}),
                                     .value = table.integer<std::uint8_t>("reads", {0, 255}),
                                     .mask = table.integer<std::uint8_t>("mask", {0, 255}, 255)});
    } else if (table.find("reads") != nullptr || table.find("mask") != nullptr) {
        table.fail(table.find("reads") != nullptr ? "reads" : "mask", "expected a register with it");
    }
    const auto time = [&](std::string_view key) {
        return Microseconds{table.integer<std::int64_t>(key, kTimeUs, std::int64_t{0})};
    };
    of.traits.range_spread = time("range_spread_us");
    of.traits.range_step = time("range_step_us");
    of.traits.boot_load = time("boot_load_us");
    return of;
}

/// `sensor_traits: [{register: 0x47, reads: 0x0c}]`: for all sensors, unless `node_id` and `sensor` select
/// some.
void read_sensor_traits(const Table& top, Scenario& scenario) {
    const Value* list = top.find("sensor_traits");
    if (list == nullptr) return;
    const auto& items = rig::read_list(*list, "sensor_traits");
    for (std::size_t i = 0; i < items.size(); ++i)
        scenario.sensor_traits.push_back(read_traits(items[i], "sensor_traits[" + std::to_string(i) + "]"));
}

void read_seeds(const Table& top, Scenario& scenario) {
    const Table seeds(top.require("seeds"), "seeds", {"map_shift_m", "further_map_shift_max_m"});
    const auto& shifts = rig::read_list(seeds.require("map_shift_m"), seeds.path_of("map_shift_m"));
    for (std::size_t i = 0; i < shifts.size(); ++i) {
        const std::string path = seeds.path_of("map_shift_m") + "[" + std::to_string(i) + "]";
        scenario.map_shifts_m.push_back(rig::read_position(shifts[i], path, 1.0));
    }
    scenario.further_map_shift_max_m = seeds.number("further_map_shift_max_m", {0.0, 1.0});
}

void read_judgement(const Table& top, Scenario& scenario) {
    const auto& models = rig::read_list(top.require("hidden_models"), "hidden_models");
    note_place(top, "hidden_models", scenario);
    note_place(top, "region", scenario);
    for (std::size_t i = 0; i < models.size(); ++i) {
        scenario.hidden_models.push_back(
            rig::read_element_name(models[i], "hidden_models[" + std::to_string(i) + "]"));
    }
    const Table region(top.require("region"), "region", {"min_m", "max_m", "floor_top_m"});
    scenario.region.p_base_min = position(region, "min_m");
    scenario.region.p_base_max = position(region, "max_m");
    if (!(scenario.region.p_base_min.array() < scenario.region.p_base_max.array()).all()) {
        region.fail("max_m", "expected each number greater than that of min_m");
    }
    if (region.find("floor_top_m") != nullptr) {
        scenario.region.floor_top_m = region.number("floor_top_m", {-kReach_m, kReach_m});
    }
}

/// `what`: description of the file for messages.
FilePlace read_path(const Table& top, std::string_view key, const std::string& what) {
    const Value& value = top.require(key);
    FilePlace file = confined_to_recording(value.file->beside(value.text));
    if (file.folder() == nullptr) file = std::filesystem::absolute(file.name()).lexically_normal();
    const bool is_scalar = value.kind == Value::Kind::scalar;
    const auto opened = file.open();
    if (opened && is_scalar) return file;
    const std::string expected = "expected the path of " + what + ", relative to this file; ";
    if (is_scalar && file.folder() != nullptr && opened.error().fault != FolderFault::absent)
        top.fail(key, expected + "'" + value.text + "' " + opened.error().reason());
    top.fail(key, expected + "there is none at " + file.shown().string());
}

/// The document with the names of its files replaced by those in a recording.
std::string standalone(Value document) {
    for (Value& item : document.items) {
        if (item.kind != Value::Kind::scalar) continue;
        if (item.key == "world") item.text = kRecordedWorld;
        if (item.key == "world_motion") item.text = kRecordedMotion;
    }
    return rig::document_text(document);
}

Scenario read_checked(const FilePlace& file, WorldOf world) {
    Scenario scenario;
    scenario.file = file.shown();
    const Value document = rig::load_with_extends(file, &scenario.extended_files);
    const Table top(document, "",
                    {"name", "world", "world_motion", "motion", "depth", "ranges", "slow_clocks",
                     "sensor_traits", "seeds", "hidden_models", "region"});
    scenario.name = top.name("name");
    if (world == WorldOf::scenario) scenario.world = read_path(top, "world", "an SDF file");
    if (top.find("world_motion") != nullptr) {
        scenario.world_motion =
            read_path(top, "world_motion", "a file with the motion of the world's models");
        note_place(top, "world_motion", scenario);
    }
    read_motion(top, scenario);
    read_sensing(top, scenario);
    scenario.slow_clocks = read_slow_clocks(top);
    read_sensor_traits(top, scenario);
    read_seeds(top, scenario);
    read_judgement(top, scenario);
    scenario.standalone_text = standalone(document);
    return scenario;
}

}  // namespace

Eigen::Vector3d Scenario::map_shift_m(std::uint64_t seed) const {
    if (seed < map_shifts_m.size()) {
        return map_shifts_m[seed];
    }
    const Noise noise(seed, NoiseSource::map_shift);
    return further_map_shift_max_m * Eigen::Vector3d(noise.uniform(0), noise.uniform(1), noise.uniform(2));
}

rig::RigError Scenario::error(std::string_view key, std::string what) const {
    const auto place = places.find(key);
    if (place == places.end()) return {file, 0, std::string(key), std::move(what)};
    return {place->second.file, place->second.line, std::string(key), std::move(what)};
}

Result<Scenario, rig::RigError> read_scenario(const FilePlace& file, WorldOf world) {
    try {
        return read_checked(confined_to_recording(file), world);
    } catch (const rig::Fault& fault) {
        return unexpected(fault.error);
    }
}

}  // namespace octoskin::sim
