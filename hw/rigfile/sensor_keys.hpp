// The keys of a sensor, of its zones and of its cone.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "common/config/node_config.hpp"
#include "hw/rigfile/key.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig::keys {

/// `sensor_defaults` has the same keys.
namespace sensor {
inline constexpr std::array<std::pair<std::string_view, DistanceMode>, 3> kDistanceModes{
    {{"short", DistanceMode::short_range},
     {"medium", DistanceMode::medium_range},
     {"long", DistanceMode::long_range}}};
/// ST ULD 3.5.2, VL53L1X_SetTimingBudgetInMs. It has no medium mode, which needs 33 ms (datasheet DS12385
/// rev 7, 2.5.2). Its 500 ms are left out: the wire's time field covers 262 ms.
inline constexpr std::array<std::int64_t, 6> kShortBudgets_ms{15, 20, 33, 50, 100, 200};
inline constexpr std::array<std::int64_t, 4> kMediumBudgets_ms{33, 50, 100, 200};
inline constexpr std::array<std::int64_t, 5> kLongBudgets_ms{20, 33, 50, 100, 200};
/// Steps of the device's fixed-point registers.
inline constexpr double kQuartersPer_mm = 4.0;
inline constexpr double kCrosstalkStepsPer_kcps = 512.0;
inline constexpr double kSignalStepsPer_mcps = 128.0;

inline constexpr TextKey kName{.path = "nodes[].sensors[].name", .meaning = "unique on its node"};
inline constexpr TextKey kLink{.path = "nodes[].sensors[].link",
                               .kind = TextKind::element_name,
                               .meaning = "the URDF link that carries it"};
inline constexpr TableKey kPose{.path = "nodes[].sensors[].pose",
                                .expected = "a [pose](#poses)",
                                .meaning = "T_link_sensor; ranges are along the sensor's own +z"};
inline constexpr IntegerKey kBus{.path = "nodes[].sensors[].bus",
                                 .range = {0, kNodeBusesMax - 1},
                                 .meaning = "index of the node's I2C bus, of those that the board has",
                                 .is_in_node_block = true};
inline constexpr IntegerKey kXshutLine{
    .path = "nodes[].sensors[].xshut_line",
    .range = {0, kNodeXshutLinesMax - 1},
    .meaning = "index of the node's XSHUT output, of those that the board has; unique on the node (below)",
    .is_in_node_block = true};
inline constexpr IntegerKey kAddress{
    .path = "nodes[].sensors[].address",
    .range = {0x08, 0x77},
    .meaning = "7-bit I2C address after bring-up, 0x08..0x77, unique on its bus, not 0x29",
    .is_in_node_block = true};
inline constexpr WordKey<DistanceMode> kDistanceMode{
    .path = "nodes[].sensors[].distance_mode",
    .words = kDistanceModes,
    .meaning = "`short` (to 1.36 m), `medium` (to 2.9 m) or `long` (to 3.6 m); below",
    .is_in_node_block = true};
inline constexpr IntegerKey kTimingBudget{.path = "nodes[].sensors[].timing_budget_ms",
                                          .unit = "ms",
                                          .range = {1, 1000},
                                          .values = kShortBudgets_ms,
                                          .meaning =
                                              "length of one ranging; 15 with `short` only, 20 not "
                                              "with `medium`",
                                          .is_in_node_block = true};
inline constexpr IntegerKey kInterMeasurement{
    .path = "nodes[].sensors[].inter_measurement_ms",
    .unit = "ms",
    .range = {1, 10'000},
    .meaning = "from start to start; at least the budget plus 5 ms, or the device halves the rate",
    .is_in_node_block = true};
inline constexpr IntegerKey kPhase{.path = "nodes[].sensors[].phase_us",
                                   .unit = "us",
                                   .range = {0, 65'535},
                                   .fallback = {SensorConfig{}.phase_us},
                                   .meaning =
                                       "start within the period ([phases](#phases)); less than the "
                                       "period",
                                   .is_in_node_block = true};
inline constexpr NumberKey kDeviceOffset{.path = "nodes[].sensors[].device_offset_mm",
                                         .unit = "mm",
                                         .range = {-1024.0, 1023.75},
                                         .fallback = {.text = "the part's own"},
                                         .meaning = "added by the device, in steps of 0.25",
                                         .is_in_node_block = true};
inline constexpr NumberKey kCrosstalk{.path = "nodes[].sensors[].crosstalk_kcps",
                                      .unit = "kcps",
                                      .range = {0.0, 127.0},
                                      .fallback = {SensorConfig{}.crosstalk_raw / kCrosstalkStepsPer_kcps},
                                      .meaning = "crosstalk compensation per SPAD, in steps of 1/512",
                                      .is_in_node_block = true};
inline constexpr NumberKey kSigmaLimit{
    .path = "nodes[].sensors[].sigma_limit_mm",
    .unit = "mm",
    .range = {0.25, 16'000.0},
    .fallback = {SensorConfig{}.sigma_limit_quarter_mm / kQuartersPer_mm},
    .meaning = "the device flags ranges with a larger sigma, in steps of 0.25",
    .is_in_node_block = true};
inline constexpr NumberKey kSignalLimit{.path = "nodes[].sensors[].signal_limit_mcps",
                                        .unit = "Mcps",
                                        .range = {0.0, 511.0},
                                        .fallback = {SensorConfig{}.signal_limit_raw / kSignalStepsPer_mcps},
                                        .meaning = "the device flags weaker returns, in steps of 1/128",
                                        .is_in_node_block = true};
inline constexpr NumberKey kReflexBelow{
    .path = "nodes[].sensors[].reflex_below_m",
    .unit = "m",
    .range = {0.0, kReflexLimitMaxMm / 1000.0},
    .fallback = {0.0},
    .meaning = "a closer hit makes the node send REFLEX; whole millimetres, 0: never",
    .is_in_node_block = true};
inline constexpr FlagKey kAppliesGainFactor{
    .path = "nodes[].sensors[].applies_gain_factor",
    .fallback = {SensorConfig{}.applies_gain_factor},
    .meaning = "multiplies ranges by 2011/2048, as ST's full driver does and its light one does not",
    .is_in_node_block = true};
inline constexpr ListKey kZones{.path = "nodes[].sensors[].zones",
                                .items = "zones",
                                .count = {1, kSensorZonesMax},
                                .fallback = {.text = "the whole array"},
                                .meaning = "regions of interest, ranged in turn",
                                .is_in_node_block = true};
inline constexpr TableKey kCone{.path = "nodes[].sensors[].cone",
                                .fallback = {.text = "none: one ideal ray"},
                                .meaning = "the optics of a sensor with a [cone](#cone)"};
}  // namespace sensor

namespace zone {
inline constexpr Range<std::int64_t> kSide_spads{4, 16};
inline constexpr IntegerKey kCentre{
    .path = "nodes[].sensors[].zones[].centre_spad",
    .range = {0, 255},
    .meaning = "number of its centre SPAD in ST's table (UM2555); 199 is the centre of the array",
    .is_in_node_block = true};
inline constexpr IntegerKey kWidth{.path = "nodes[].sensors[].zones[].width_spads",
                                   .unit = "SPADs",
                                   .range = kSide_spads,
                                   .meaning = "the zone must lie on the 16 x 16 array",
                                   .is_in_node_block = true};
inline constexpr IntegerKey kHeight{.path = "nodes[].sensors[].zones[].height_spads",
                                    .unit = "SPADs",
                                    .range = kSide_spads,
                                    .meaning = "as above",
                                    .is_in_node_block = true};
inline constexpr NumberKey kOffset{.path = "nodes[].sensors[].zones[].offset_m",
                                   .unit = "m",
                                   .range = {-0.5, 0.5},
                                   .fallback = {0.0},
                                   .meaning = "added by the host to every valid range of this zone"};
}  // namespace zone

namespace cone {
inline constexpr IntegerKey kSubRays{
    .path = "nodes[].sensors[].cone.sub_rays",
    .range = {1, 64},
    .fallback = {Cone{}.sub_rays},
    .meaning = "the simulator's rays across the cone, a grid of this many by this many"};
inline constexpr NumberKey kHalfAngle{
    .path = "nodes[].sensors[].cone.half_angle_deg",
    .unit = "deg",
    .range = {0.1, 45.0},
    .fallback = {Cone{}.half_angle_deg},
    .meaning = "from the axis to the cone's edge; 27 degrees in all, by DS12385"};
inline constexpr NumberKey kSigma{
    .path = "nodes[].sensors[].cone.sigma_deg",
    .unit = "deg",
    .range = {0.1, 90.0},
    .fallback = {Cone{}.sigma_deg},
    .meaning = "standard deviation of the Gaussian by which the signal falls off from the axis"};
inline constexpr NumberKey kBlur{
    .path = "nodes[].sensors[].cone.blur_deg",
    .unit = "deg",
    .range = {0.1, 20.0},
    .fallback = {Cone{}.blur_deg},
    .meaning = "standard deviation of the lens's blur: how far a zone sees beyond its SPADs"};
}  // namespace cone

}  // namespace octoskin::rig::keys
