// The one declaration of each key of a scenario file and of a file with the motion of a world.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "common/config/node_config.hpp"
#include "hw/rigfile/key.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/sim/scenario/scenario.hpp"

namespace octoskin::sim {

/// All tables of both files in the order of docs/scenario.md. Each declared key is in one of them.
[[nodiscard]] std::span<const rig::KeyTable> scenario_key_tables() noexcept;

namespace keys {

extern const rig::KeyTable kTop;
extern const rig::KeyTable kMotion;
extern const rig::KeyTable kDepth;
extern const rig::KeyTable kKinect;
extern const rig::KeyTable kRanges;
extern const rig::KeyTable kSlowClocks;
extern const rig::KeyTable kSeeds;
extern const rig::KeyTable kRegion;
extern const rig::KeyTable kSensorTraits;
extern const rig::KeyTable kCircle;
extern const rig::KeyTable kWorldMotion;
extern const rig::KeyTable kModel;
extern const rig::KeyTable kPlace;

/// Of positions: a larger value is probably in millimetres.
inline constexpr rig::Range<double> kReach_m{-20.0, 20.0};

inline constexpr rig::TextKey kName{.path = "name", .meaning = "for messages and recordings"};
inline constexpr rig::TextKey kWorld{
    .path = "world",
    .kind = rig::TextKind::path,
    .meaning = "[SDF file](#worlds-of-others), in metres; `--world` takes another"};
inline constexpr rig::TextKey kWorldMotionFile{
    .path = "world_motion",
    .kind = rig::TextKind::path,
    .fallback = {.text = "no motion"},
    .meaning = "file with the [motion of the world](#a-world-that-moves)"};
inline constexpr rig::TableKey kMotionTable{.path = "motion", .meaning = "motion of the arm"};
inline constexpr rig::TableKey kDepthTable{.path = "depth",
                                           .meaning = "noise of the camera; required also without a camera"};
inline constexpr rig::TableKey kRangesTable{.path = "ranges", .meaning = "optics of the range sensors"};
inline constexpr rig::TableKey kSlowClocksTable{
    .path = "slow_clocks", .fallback = {.text = "its defaults"}, .meaning = "[below](#slow-clocks)"};
inline constexpr rig::ListKey kSensorTraitsList{.path = "sensor_traits",
                                                .items = "traits",
                                                .fallback = {.text = "none"},
                                                .meaning = "[below](#sensor-traits)"};
inline constexpr rig::TableKey kSeedsTable{.path = "seeds", .meaning = "[below](#seeds)"};
inline constexpr rig::ListKey kHiddenModels{
    .path = "hidden_models",
    .items = "models",
    .meaning = "SDF models that the camera should not see (`object_recall`); may be empty"};
inline constexpr rig::TableKey kRegionTable{.path = "region", .meaning = "the box that is judged"};

namespace motion {
/// A node is usable after two SYNCs at 1 Hz, and all must be usable at START.
inline constexpr rig::NumberKey kRest{
    .path = "motion.rest_s",
    .unit = "s",
    .range = {3.0, 600.0},
    .meaning = "rest before the START mark: each node needs two SYNCs at 1 Hz"};
inline constexpr rig::TableKey kCircle{.path = "motion.circle",
                                       .meaning = "[the only motion](#motioncircle)"};
}  // namespace motion

namespace depth {
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kNoises{
    {{"gaussian", false}, {"kinect", true}}};
/// The meaning of its words: a Kinect's.
inline constexpr rig::WordKey<bool> kNoise{.path = "depth.noise",
                                           .words = kNoises,
                                           .fallback = {false},
                                           .meaning = "model of the noise; `kinect` ignores `sigma_m`"};
inline constexpr rig::NumberKey kSigma{.path = "depth.sigma_m",
                                       .unit = "m",
                                       .range = {0.0, 1.0},
                                       .meaning = "camera noise along the ray, independent per pixel"};
inline constexpr rig::TableKey kKinectTable{.path = "depth.kinect",
                                            .fallback = {.text = "its defaults"},
                                            .meaning = "numbers of the model; with `noise: kinect` only"};
}  // namespace depth

namespace kinect {
inline constexpr KinectNoise kDefaults{};
inline constexpr rig::Range<double> kShare{0.0, 1.0};
inline constexpr rig::NumberKey kSigmaMin{
    .path = "depth.kinect.sigma_min_m",
    .unit = "m",
    .range = {0.0, 1.0},
    .fallback = {kDefaults.sigma_min_m},
    .meaning = "deviation at depth z: *sigma_min_m + sigma_growth_per_m (z - sigma_min_at_m)^2*"};
inline constexpr rig::NumberKey kSigmaMinAt{.path = "depth.kinect.sigma_min_at_m",
                                            .unit = "m",
                                            .range = {0.0, 10.0},
                                            .fallback = {kDefaults.sigma_min_at_m},
                                            .meaning = "depth of the least deviation"};
inline constexpr rig::NumberKey kSigmaGrowth{.path = "depth.kinect.sigma_growth_per_m",
                                             .unit = "1/m",
                                             .range = {0.0, 0.1},
                                             .fallback = {kDefaults.sigma_growth_per_m},
                                             .meaning = "growth of the deviation"};
inline constexpr rig::NumberKey kBiasGrowth{
    .path = "depth.kinect.bias_growth_per_m",
    .unit = "1/m",
    .range = {0.0, 0.1},
    .fallback = {kDefaults.bias_growth_per_m},
    .meaning = "an error that stays from frame to frame, of the seed: at most *bias_growth_per_m z^2*"};
inline constexpr rig::IntegerKey kBiasSpacing{
    .path = "depth.kinect.bias_spacing_px",
    .unit = "px",
    .range = {1, 4096},
    .fallback = {kDefaults.bias_spacing_px},
    .meaning = "it is drawn at pixels this far apart and interpolated between them"};
inline constexpr rig::NumberKey kDisparityStep{
    .path = "depth.kinect.disparity_step_px",
    .unit = "px",
    .range = {0.0, 10.0},
    .fallback = {kDefaults.disparity_step_px},
    .meaning = "*focal_px baseline_m / z* is rounded to multiples of it; 0: not rounded"};
inline constexpr rig::NumberKey kBaseline{.path = "depth.kinect.baseline_m",
                                          .unit = "m",
                                          .range = {0.001, 10.0},
                                          .fallback = {kDefaults.baseline_m},
                                          .meaning = "from projector to camera"};
inline constexpr rig::NumberKey kFocal{.path = "depth.kinect.focal_px",
                                       .unit = "px",
                                       .range = {1.0, 100'000.0},
                                       .fallback = {kDefaults.focal_px},
                                       .meaning = "of the camera that measures disparity"};
inline constexpr rig::NumberKey kEdgeStep{
    .path = "depth.kinect.edge_step_m",
    .unit = "m",
    .range = {0.001, 10.0},
    .fallback = {kDefaults.edge_step_m},
    .meaning = "a pixel is at an edge if one of its four neighbours differs by more"};
inline constexpr rig::NumberKey kFlyingShare{
    .path = "depth.kinect.flying_share",
    .range = kShare,
    .fallback = {kDefaults.flying_share},
    .meaning = "of edge pixels: lies between the two surfaces, in each frame elsewhere"};
inline constexpr rig::NumberKey kMissingShare{
    .path = "depth.kinect.missing_share",
    .range = kShare,
    .fallback = {kDefaults.missing_share},
    .meaning = "of edge pixels: has no depth; at most *1 - flying_share*"};
}  // namespace kinect

namespace ranges {
inline constexpr rig::Range<double> kRange_m{0.0, 10.0};
inline constexpr rig::NumberKey kSigma{
    .path = "ranges.sigma_m",
    .unit = "m",
    .range = {0.0, 1.0},
    .meaning = "range noise of a sensor without [cone](rig.md#cone); with one the signal sets it"};
inline constexpr rig::NumberKey kMin{.path = "ranges.min_m",
                                     .unit = "m",
                                     .range = kRange_m,
                                     .meaning = "nothing nearer is seen, in every mode of the sensor"};
inline constexpr rig::NumberKey kMax{
    .path = "ranges.max_m",
    .unit = "m",
    .range = kRange_m,
    .meaning = "nothing further is seen, in every mode of the sensor; at least `min_m`"};
inline constexpr rig::NumberKey kReflectivity{.path = "ranges.reflectivity",
                                              .range = {0.01, 1.0},
                                              .fallback = {RangeOptics{}.reflectivity},
                                              .meaning = "of every surface, for sensors with a cone"};
}  // namespace ranges

namespace slow_clocks {
/// No known part deviates this far; a value outside is probably in percent.
inline constexpr rig::Range<double> kFactor{0.9, 1.2};
inline constexpr rig::NumberKey kFactorMin{.path = "slow_clocks.factor_min",
                                           .range = kFactor,
                                           .fallback = {SlowClockSpread{}.factor_min},
                                           .meaning = "the slowest oscillator"};
inline constexpr rig::NumberKey kFactorMax{.path = "slow_clocks.factor_max",
                                           .range = kFactor,
                                           .fallback = {SlowClockSpread{}.factor_max},
                                           .meaning = "the fastest one; at least `factor_min`"};
}  // namespace slow_clocks

namespace seeds {
inline constexpr rig::NumbersKey kMapShift{.path = "seeds.map_shift_m[]",
                                           .unit = "m",
                                           .range = {-1.0, 1.0},
                                           .meaning = "the shifts of the seeds 0, 1, ...; may be empty"};
inline constexpr rig::NumberKey kFurtherMapShiftMax{
    .path = "seeds.further_map_shift_max_m",
    .unit = "m",
    .range = {0.0, 1.0},
    .meaning = "for seeds beyond the list: uniform from 0 to this, per axis"};
}  // namespace seeds

namespace region {
inline constexpr rig::NumbersKey kMin{
    .path = "region.min_m", .unit = "m", .range = kReach_m, .meaning = "lower corner"};
inline constexpr rig::NumbersKey kMax{
    .path = "region.max_m", .unit = "m", .range = kReach_m, .meaning = "upper corner, greater on each axis"};
inline constexpr rig::NumberKey kFloorTop{.path = "region.floor_top_m",
                                          .unit = "m",
                                          .range = kReach_m,
                                          .fallback = {.text = "no floor"},
                                          .meaning = "height of the floor"};
}  // namespace region

namespace traits {
inline constexpr rig::Range<std::int64_t> kByte{0, 255};
inline constexpr rig::Range<std::int64_t> kTime_us{0, 20'000};
inline constexpr rig::IntegerKey kNodeId{.path = "sensor_traits[].node_id",
                                         .range = rig::keys::kNodeId,
                                         .fallback = {.text = "all nodes"},
                                         .meaning = "the sensors of this node only"};
inline constexpr rig::IntegerKey kSensor{.path = "sensor_traits[].sensor",
                                         .range = {0, kNodeSensorsMax - 1},
                                         .fallback = {.text = "all sensors"},
                                         .meaning = "the sensor with this index only"};
inline constexpr rig::IntegerKey kRegister{
    .path = "sensor_traits[].register",
    .range = {0, 0x1FF},
    .fallback = {.text = "none"},
    .meaning = "index of a register that keeps its value, up to 0x1FF"};
inline constexpr rig::IntegerKey kReads{
    .path = "sensor_traits[].reads",
    .range = kByte,
    .fallback = {.text = "none"},
    .meaning = "the value that is read, whatever is written; required with `register`"};
inline constexpr rig::IntegerKey kMask{.path = "sensor_traits[].mask",
                                       .range = kByte,
                                       .fallback = {255},
                                       .meaning = "the bits that keep it; with `register` only"};
inline constexpr rig::IntegerKey kRangeSpread{.path = "sensor_traits[].range_spread_us",
                                              .unit = "us",
                                              .range = kTime_us,
                                              .fallback = {0},
                                              .meaning = "each range takes longer by up to this"};
inline constexpr rig::IntegerKey kRangeStep{.path = "sensor_traits[].range_step_us",
                                            .unit = "us",
                                            .range = kTime_us,
                                            .fallback = {0},
                                            .meaning = "and by this if there is a target"};
inline constexpr rig::IntegerKey kBootLoad{
    .path = "sensor_traits[].boot_load_us",
    .unit = "us",
    .range = kTime_us,
    .fallback = {0},
    .meaning = "this long after it first answers, its boot loads all registers, its address included"};
}  // namespace traits

namespace circle {
inline constexpr rig::Range<double> kUnit{-1.0, 1.0};
inline constexpr rig::TextKey kLink{.path = "motion.circle.link",
                                    .kind = rig::TextKind::element_name,
                                    .meaning = "the link of the robot that is moved"};
inline constexpr rig::TableKey kCentre{
    .path = "motion.circle.centre",
    .expected = "a [pose](rig.md#poses) within 20 m",
    .meaning = "`xyz_m`, and the link's orientation: `rpy_deg`, `quaternion_wxyz` or `rotation_rows`"};
inline constexpr rig::NumberKey kRadius{
    .path = "motion.circle.radius_m", .unit = "m", .range = {0.0, 5.0}, .meaning = "0: the arm rests"};
inline constexpr rig::NumbersKey kTowardsStart{
    .path = "motion.circle.towards_start",
    .range = kUnit,
    .meaning = "from the centre to the start of the motion; of length 1"};
inline constexpr rig::NumbersKey kTowardsQuarter{
    .path = "motion.circle.towards_quarter",
    .range = kUnit,
    .meaning =
        "from the centre to its place a quarter turn later; of length 1, at right angles to "
        "`towards_start`"};
inline constexpr rig::IntegerKey kTicksPerRevolution{
    .path = "motion.circle.ticks_per_revolution",
    .range = {3, 100'000},
    .meaning = "ticks with inverse kinematics; between two, joints move at constant speed"};
inline constexpr rig::NumberKey kTickRate{
    .path = "motion.circle.tick_rate_hz", .unit = "Hz", .range = {1.0, 1000.0}, .meaning = "ticks a second"};
inline constexpr rig::IntegerKey kRevolutions{
    .path = "motion.circle.revolutions", .range = {1, 1000}, .fallback = {1}, .meaning = "number of turns"};
inline constexpr rig::NumberKey kStartPosition{
    .path = "motion.circle.start_position_rad[]",
    .unit = "rad",
    .range = {-10.0, 10.0},
    .meaning = "one for each joint: start of the first inverse kinematics, near the posture wanted"};
}  // namespace circle

/// Of the file that `world_motion` names.
namespace world_motion {
inline constexpr rig::ListKey kModels{.path = "models", .items = "models", .meaning = "each model once"};
inline constexpr rig::TextKey kModel{
    .path = "models[].model", .kind = rig::TextKind::element_name, .meaning = "a model of the SDF"};
inline constexpr rig::ListKey kPlaces{
    .path = "models[].places", .items = "places", .meaning = "at least one, the earliest first"};
inline constexpr rig::NumberKey kAt{.path = "models[].places[].at_s",
                                    .unit = "s",
                                    .range = {-600.0, 600.0},
                                    .meaning = "start of this place, later than that of the place before"};
inline constexpr rig::FlagKey kIsThere{.path = "models[].places[].is_there",
                                       .fallback = {true},
                                       .meaning = "false: absent until its next place"};
inline constexpr rig::NumbersKey kOffset{.path = "models[].places[].offset_m",
                                         .unit = "m",
                                         .range = kReach_m,
                                         .fallback = {.text = "0, 0, 0"},
                                         .meaning = "from its place in the SDF, not from the place before"};
inline constexpr rig::FlagKey kMovesOn{
    .path = "models[].places[].moves_on",
    .fallback = {false},
    .meaning = "moves to the next place, straight and at one speed; else it rests"};
}  // namespace world_motion

}  // namespace keys
}  // namespace octoskin::sim
