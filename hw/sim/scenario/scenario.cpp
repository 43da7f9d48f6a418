#include "hw/sim/scenario/scenario.hpp"

#include <cmath>

#include "host/io/folder/confined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/sim/noise/noise.hpp"
#include "hw/sim/scenario/scenario_keys.hpp"

namespace octoskin::sim {
namespace {

using rig::Table;
using rig::Value;

Table table_of(const Table& above, const rig::TableKey& key, const rig::KeyTable& declared) {
    return {above.require(key), above.path_of(key), declared};
}

std::string item_path(const Table& table, const rig::DeclaredKey auto& key, std::size_t index) {
    return table.path_of(key) + "[" + std::to_string(index) + "]";
}

/// Three numbers of length 1.
Eigen::Vector3d unit_vector(const Table& table, const rig::NumbersKey& key) {
    Eigen::Vector3d vector = rig::read_position(table, key);
    if (std::abs(vector.norm() - 1.0) > 1e-9) {
        table.fail(key, {ErrorCode::bad_value, "expected three numbers that make a vector of length 1",
                         "length " + std::to_string(vector.norm())});
    }
    return vector;
}

Eigen::VectorXd joint_positions(const Table& table, const rig::NumberKey& key) {
    const auto& items = rig::read_list(table.require(key), table.path_of(key));
    Eigen::VectorXd positions(static_cast<Eigen::Index>(items.size()));
    for (std::size_t i = 0; i < items.size(); ++i) {
        positions[static_cast<Eigen::Index>(i)] =
            rig::read_number(items[i], item_path(table, key, i), key.range);
    }
    return positions;
}

void note_place(const Table& table, const rig::DeclaredKey auto& key, Scenario& scenario) {
    const Value& value = table.require(key);
    scenario.places[table.path_of(key)] = {value.file->shown(), value.line};
}

CircleMotion read_circle(const Value& value, const std::string& path, Scenario& scenario) {
    const Table table(value, path, keys::kCircle);
    CircleMotion motion;
    motion.link = table.text(keys::circle::kLink);
    const Eigen::Isometry3d T_base_centre =
        rig::read_pose(table.require(keys::circle::kCentre), table.path_of(keys::circle::kCentre),
                       {.reach_m = keys::kReach_m.max});
    motion.p_base_centre = T_base_centre.translation();
    motion.R_base_link = T_base_centre.linear();
    motion.radius_m = table.number(keys::circle::kRadius);
    motion.towards_start = unit_vector(table, keys::circle::kTowardsStart);
    motion.towards_quarter = unit_vector(table, keys::circle::kTowardsQuarter);
    if (std::abs(motion.towards_start.dot(motion.towards_quarter)) > 1e-9) {
        table.fail(keys::circle::kTowardsQuarter,
                   {ErrorCode::bad_value, "expected a vector at right angles to towards_start"});
    }
    motion.ticks_per_revolution = table.integer<std::uint32_t>(keys::circle::kTicksPerRevolution);
    motion.tick_rate_hz = table.number(keys::circle::kTickRate);
    motion.revolutions = table.integer<std::uint32_t>(keys::circle::kRevolutions);
    motion.start_position = joint_positions(table, keys::circle::kStartPosition);
    note_place(table, keys::circle::kLink, scenario);
    note_place(table, keys::circle::kStartPosition, scenario);
    return motion;
}

void read_motion(const Table& top, Scenario& scenario) {
    const Table table = table_of(top, keys::kMotionTable, keys::kMotion);
    scenario.rest_s = table.number(keys::motion::kRest);
    scenario.motion =
        read_circle(table.require(keys::motion::kCircle), table.path_of(keys::motion::kCircle), scenario);
    note_place(table, keys::motion::kCircle, scenario);
}

KinectNoise read_kinect(const Table& depth) {
    KinectNoise kinect;
    if (depth.find(keys::depth::kKinectTable) == nullptr) return kinect;
    const Table table = table_of(depth, keys::depth::kKinectTable, keys::kKinect);
    kinect.sigma_min_m = table.number(keys::kinect::kSigmaMin);
    kinect.sigma_min_at_m = table.number(keys::kinect::kSigmaMinAt);
    kinect.sigma_growth_per_m = table.number(keys::kinect::kSigmaGrowth);
    kinect.bias_growth_per_m = table.number(keys::kinect::kBiasGrowth);
    kinect.bias_spacing_px = table.integer<std::uint32_t>(keys::kinect::kBiasSpacing);
    kinect.disparity_step_px = table.number(keys::kinect::kDisparityStep);
    kinect.baseline_m = table.number(keys::kinect::kBaseline);
    kinect.focal_px = table.number(keys::kinect::kFocal);
    kinect.edge_step_m = table.number(keys::kinect::kEdgeStep);
    kinect.flying_share = table.number(keys::kinect::kFlyingShare);
    kinect.missing_share = table.number(keys::kinect::kMissingShare);
    if (kinect.flying_share + kinect.missing_share > 1.0)
        table.fail(keys::kinect::kMissingShare,
                   {ErrorCode::out_of_range,
                    "expected at most 1 - flying_share, " + std::to_string(1.0 - kinect.flying_share),
                    std::to_string(kinect.missing_share)});
    return kinect;
}

DepthNoise read_depth_noise(const Table& top) {
    const Table depth = table_of(top, keys::kDepthTable, keys::kDepth);
    if (depth.choice(keys::depth::kNoise)) return {read_kinect(depth)};
    if (depth.find(keys::depth::kKinectTable) != nullptr)
        depth.fail(keys::depth::kKinectTable,
                   {ErrorCode::conflict, "expected `noise: kinect` with it, found gaussian"});
    return gaussian_noise(depth.number(keys::depth::kSigma));
}

void read_sensing(const Table& top, Scenario& scenario) {
    scenario.depth_noise = read_depth_noise(top);
    const Table ranges = table_of(top, keys::kRangesTable, keys::kRanges);
    scenario.ranges.sigma_m = ranges.number(keys::ranges::kSigma);
    scenario.ranges.min_m = ranges.number(keys::ranges::kMin);
    scenario.ranges.max_m =
        ranges.number(keys::ranges::kMax, {scenario.ranges.min_m, keys::ranges::kMax.range.max});
    scenario.ranges.reflectivity = ranges.number(keys::ranges::kReflectivity);
}

SlowClockSpread read_slow_clocks(const Table& top) {
    SlowClockSpread spread;
    if (top.find(keys::kSlowClocksTable) == nullptr) return spread;
    const Table table = table_of(top, keys::kSlowClocksTable, keys::kSlowClocks);
    spread.factor_min = table.number(keys::slow_clocks::kFactorMin);
    spread.factor_max = table.number(keys::slow_clocks::kFactorMax);
    if (spread.factor_max < spread.factor_min)
        table.fail(
            keys::slow_clocks::kFactorMax,
            {ErrorCode::out_of_range, "expected at least factor_min, " + std::to_string(spread.factor_min),
             std::to_string(spread.factor_max)});
    return spread;
}

TraitsOf read_traits(const Value& value, const std::string& path) {
    const Table table(value, path, keys::kSensorTraits);
    TraitsOf of;
    if (table.find(keys::traits::kNodeId) != nullptr)
        of.node_id = table.integer<std::uint8_t>(keys::traits::kNodeId);
    if (table.find(keys::traits::kSensor) != nullptr)
        of.sensor = table.integer<std::uint8_t>(keys::traits::kSensor);
    if (table.find(keys::traits::kRegister) != nullptr) {
        of.traits.misread.push_back({.index = table.integer<std::uint16_t>(keys::traits::kRegister),
                                     .value = table.integer<std::uint8_t>(keys::traits::kReads),
                                     .mask = table.integer<std::uint8_t>(keys::traits::kMask)});
    } else {
        for (const rig::IntegerKey& key : {keys::traits::kReads, keys::traits::kMask})
            if (table.find(key) != nullptr)
                table.fail(key, {ErrorCode::missing_key, "expected a register with it, found none"});
    }
    const auto time = [&](const rig::IntegerKey& key) {
        return Microseconds{table.integer<std::int64_t>(key)};
    };
    of.traits.range_spread = time(keys::traits::kRangeSpread);
    of.traits.range_step = time(keys::traits::kRangeStep);
    of.traits.boot_load = time(keys::traits::kBootLoad);
    return of;
}

/// `sensor_traits: [{register: 0x47, reads: 0x0c}]`: for all sensors, unless `node_id` and `sensor` select
/// some.
void read_sensor_traits(const Table& top, Scenario& scenario) {
    if (top.find(keys::kSensorTraitsList) == nullptr) return;
    const auto& items = top.list(keys::kSensorTraitsList);
    for (std::size_t i = 0; i < items.size(); ++i)
        scenario.sensor_traits.push_back(read_traits(items[i], item_path(top, keys::kSensorTraitsList, i)));
}

void read_seeds(const Table& top, Scenario& scenario) {
    const Table seeds = table_of(top, keys::kSeedsTable, keys::kSeeds);
    constexpr rig::NumbersKey kShift = keys::seeds::kMapShift;
    const auto& shifts = rig::read_list(seeds.require(kShift), seeds.path_of(kShift));
    for (std::size_t i = 0; i < shifts.size(); ++i) {
        scenario.map_shifts_m.push_back(
            rig::read_position(shifts[i], item_path(seeds, kShift, i), kShift.range.max));
    }
    scenario.further_map_shift_max_m = seeds.number(keys::seeds::kFurtherMapShiftMax);
}

void read_judgement(const Table& top, Scenario& scenario) {
    const auto& models = top.list(keys::kHiddenModels);
    note_place(top, keys::kHiddenModels, scenario);
    note_place(top, keys::kRegionTable, scenario);
    for (std::size_t i = 0; i < models.size(); ++i) {
        scenario.hidden_models.push_back(
            rig::read_element_name(models[i], item_path(top, keys::kHiddenModels, i)));
    }
    const Table region = table_of(top, keys::kRegionTable, keys::kRegion);
    scenario.region.p_base_min = rig::read_position(region, keys::region::kMin);
    scenario.region.p_base_max = rig::read_position(region, keys::region::kMax);
    if (!(scenario.region.p_base_min.array() < scenario.region.p_base_max.array()).all()) {
        region.fail(keys::region::kMax,
                    {ErrorCode::out_of_range, "expected each number greater than that of min_m"});
    }
    if (region.find(keys::region::kFloorTop) != nullptr)
        scenario.region.floor_top_m = region.number(keys::region::kFloorTop);
}

/// `what`: description of the file for messages.
FilePlace read_path(const Table& top, const rig::TextKey& key, const std::string& what) {
    const Value& value = top.require(key);
    FilePlace file = confined_to_recording(value.file->beside(value.text));
    if (file.folder() == nullptr) file = std::filesystem::absolute(file.name()).lexically_normal();
    const bool is_scalar = value.kind == Value::Kind::scalar;
    const auto opened = file.open();
    if (opened && is_scalar) return file;
    Error error{ErrorCode::not_found, "expected the path of " + what + ", relative to this file",
                "none at " + file.shown().string()};
    if (is_scalar && file.folder() != nullptr && opened.error().fault != FolderFault::absent) {
        const Error refused = to_error(opened.error());
        error.code = refused.code;
        error.value = "'" + value.text + "', which " + refused.what;
        error.remedy = refused.remedy;
    }
    top.fail(key, std::move(error));
}

/// The document with the names of its files replaced by those in a recording.
std::string standalone(Value document) {
    for (Value& item : document.items) {
        if (item.kind != Value::Kind::scalar) continue;
        if (item.key == name_of(keys::kWorld)) item.text = kRecordedWorld;
        if (item.key == name_of(keys::kWorldMotionFile)) item.text = kRecordedMotion;
    }
    return rig::document_text(document);
}

Scenario read_checked(const FilePlace& file, WorldOf world) {
    Scenario scenario;
    scenario.file = file.shown();
    const Value document = rig::load_with_extends(file, &scenario.extended_files);
    const Table top(document, "", keys::kTop);
    scenario.name = top.text(keys::kName);
    if (world == WorldOf::scenario) scenario.world = read_path(top, keys::kWorld, "an SDF file");
    if (top.find(keys::kWorldMotionFile) != nullptr) {
        scenario.world_motion =
            read_path(top, keys::kWorldMotionFile, "a file with the motion of the world's models");
        note_place(top, keys::kWorldMotionFile, scenario);
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

Error Scenario::error(std::string_view key, Error error) const {
    const auto place = places.find(key);
    error.file = place == places.end() ? file : place->second.file;
    error.line = place == places.end() ? 0 : place->second.line;
    error.key = std::string(key);
    return error;
}

Result<Scenario, Error> read_scenario(const FilePlace& file, WorldOf world) {
    try {
        return read_checked(confined_to_recording(file), world);
    } catch (const Error& error) {
        return unexpected(error);
    }
}

}  // namespace octoskin::sim
