// The canonical text of a rig: every key written out, in a fixed order, numbers in their shortest exact form.
#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/rig_keys.hpp"

namespace octoskin::rig {
namespace {

/// Text under construction, one "key: value" line at a time. `indent` is the beginning of the line: blanks,
/// and a hyphen before the first key of an item.
class Writer {
  public:
    void entry(std::string_view indent, const DeclaredKey auto& key, const auto& value) {
        fmt::format_to(std::back_inserter(text_), "{}{}: {}\n", indent, name_of(key), value);
    }
    /// A key that a rig chooses: the name of a link.
    void entry(std::string_view indent, const std::string& key, const auto& value) {
        fmt::format_to(std::back_inserter(text_), "{}{}: {}\n", indent, key, value);
    }
    /// The key of a table or list whose items follow.
    void open(std::string_view indent, const DeclaredKey auto& key) {
        fmt::format_to(std::back_inserter(text_), "{}{}:\n", indent, name_of(key));
    }
    void item(std::string_view indent, const auto& value) {
        fmt::format_to(std::back_inserter(text_), "{}- {}\n", indent, value);
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

/// A table on one line: "{k1: 0, k2: 1}".
class FlowTable {
  public:
    FlowTable& entry(const DeclaredKey auto& key, const auto& value) {
        text_ += fmt::format("{}{}: {}", text_.empty() ? "{" : ", ", name_of(key), value);
        return *this;
    }
    [[nodiscard]] std::string take() { return std::move(text_) + "}"; }

  private:
    std::string text_;
};

/// The shortest decimal that reads back as the same double; -0 is written as 0, which it equals.
std::string number(double value) {
    return fmt::format("{}", value + 0.0);
}

std::string list(const Eigen::Vector3d& v) {
    return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z()));
}

/// The rotation as a matrix: a quaternion would not read back to the same matrix bit for bit.
std::string pose(const Eigen::Isometry3d& T) {
    const Eigen::Matrix3d rows = T.linear().transpose();
    return FlowTable()
        .entry(keys::pose::kPosition, list(T.translation()))
        .entry(keys::pose::kRotationRows,
               fmt::format("[{}, {}, {}]", list(rows.col(0)), list(rows.col(1)), list(rows.col(2))))
        .take();
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

/// A word that YAML 1.1 reads as false is quoted.
std::string word(StreamGate gate) {
    const std::string_view plain = word_of(keys::node::kStreamGate, gate);
    return plain == "off" ? "'off'" : std::string(plain);
}

void write_robot(Writer& out, const Rig& rig, const std::string& urdf) {
    out.open("", keys::kRobotTable);
    out.entry("  ", keys::robot::kUrdf, quoted(urdf));
    out.entry("  ", keys::robot::kBaseLink, quoted(rig.base_link));
    if (!rig.link_padding_m.empty()) out.open("  ", keys::robot::kLinkPadding);
    for (const auto& [link, padding_m] : rig.link_padding_m)
        out.entry("    ", quoted(link), number(padding_m));
    // Left out if they have their default: rigs without these keys keep the hash from before the keys
    // existed.
    if (rig.fits_capsules) out.entry("  ", keys::robot::kFitsCapsules, rig.fits_capsules);
    if (!rig.attached_capsules.empty()) out.open("  ", keys::robot::kAttachedCapsules);
    for (const AttachedCapsule& capsule : rig.attached_capsules) {
        out.item("    ", FlowTable()
                             .entry(keys::capsule::kName, quoted(capsule.name))
                             .entry(keys::capsule::kLink, quoted(capsule.link))
                             .entry(keys::capsule::kFrom, list(capsule.p_link_a))
                             .entry(keys::capsule::kTo, list(capsule.p_link_b))
                             .entry(keys::capsule::kRadius, number(capsule.radius_m))
                             .entry(keys::capsule::kPadding, number(capsule.padding_m))
                             .take());
    }
    if (!rig.links_without_body.empty()) out.open("  ", keys::robot::kLinksWithoutBody);
    for (const auto& link : rig.links_without_body) out.item("    ", quoted(link));
    if (!rig.links_ignored_by_sensors.empty()) out.open("  ", keys::robot::kLinksIgnoredBySensors);
    for (const auto& link : rig.links_ignored_by_sensors) out.item("    ", quoted(link));
    out.entry("  ", keys::robot::kDepthSelfMargin, number(rig.depth_self_margin_m));
    out.entry("  ", keys::robot::kRangeSelfMargin, number(rig.range_self_margin_m));
}

void write_bus(Writer& out, const Bus& bus) {
    out.open("", keys::kBusTable);
    out.entry("  ", keys::bus::kProtocol, word_of(keys::bus::kProtocol, bus.uses_can_fd));
    out.entry("  ", keys::bus::kNominalBitrate, bus.nominal_bitrate);
    if (bus.uses_can_fd) out.entry("  ", keys::bus::kDataBitrate, bus.data_bitrate);
}

/// One source is written as the table that it was before there were several: rigs keep their hash.
void write_joints(Writer& out, const std::vector<JointSource>& sources) {
    out.open("", keys::kJointsTable);
    const bool is_list = sources.size() > 1;
    for (const JointSource& source : sources) {
        out.entry(is_list ? "  - " : "  ", keys::joints::kNodeId, source.node_id);
        const std::string indent = is_list ? "    " : "  ";
        out.entry(indent, keys::joints::kRate, number(source.rate_hz));
        if (source.way != JointWay::can)
            out.entry(indent, keys::joints::kWay, word_of(keys::joints::kWay, source.way));
        out.open(indent, keys::joints::kNames);
        for (const auto& name : source.joints) out.item(indent + "  ", quoted(name));
    }
}

/// Optional keys are left out if they have their default: rigs without them keep the hash from before the
/// keys existed. `first`, `indent`: before the first and the other keys.
void write_camera(Writer& out, const Camera& camera, const std::string& first, const std::string& indent) {
    if (!camera.name.empty()) out.entry(first, keys::camera::kName, quoted(camera.name));
    out.entry(camera.name.empty() ? first : indent, keys::camera::kWidth, camera.width);
    out.entry(indent, keys::camera::kHeight, camera.height);
    out.entry(indent, keys::camera::kFx, number(camera.fx));
    out.entry(indent, keys::camera::kFy, number(camera.fy));
    out.entry(indent, keys::camera::kCx, number(camera.cx));
    out.entry(indent, keys::camera::kCy, number(camera.cy));
    if (const LensDistortion& lens = camera.lens; !lens.is_none()) {
        out.entry(indent, keys::camera::kDistortion,
                  FlowTable()
                      .entry(keys::distortion::kK1, number(lens.k1))
                      .entry(keys::distortion::kK2, number(lens.k2))
                      .entry(keys::distortion::kP1, number(lens.p1))
                      .entry(keys::distortion::kP2, number(lens.p2))
                      .entry(keys::distortion::kK3, number(lens.k3))
                      .take());
    }
    out.entry(indent, keys::camera::kRate, number(camera.rate_hz));
    out.entry(indent, keys::camera::kDepthMin, number(camera.depth_min_m));
    out.entry(indent, keys::camera::kDepthMax, number(camera.depth_max_m));
    if (camera.noise)
        out.entry(indent, keys::camera::kNoise,
                  FlowTable()
                      .entry(keys::noise::kNoise, number(camera.noise->noise_m))
                      .entry(keys::noise::kNoisePer, number(camera.noise->noise_per_m))
                      .entry(keys::noise::kNoiseFrom, number(camera.noise->noise_from_m))
                      .entry(keys::noise::kBiasPer, number(camera.noise->bias_per_m))
                      .take());
    const DataSetDepth depth = camera.data_set.depth();
    const double gap_ms = camera.data_set.pose_gap_max_ms;
    const bool has_gap = gap_ms != keys::data_set::kPoseGapMax.fallback.value;
    if (depth != DataSetDepth{} || has_gap) {
        FlowTable data_set;
        data_set.entry(keys::data_set::kDepthUnits, number(depth.units_per_m))
            .entry(keys::data_set::kDepthNoValue, depth.no_value);
        if (has_gap) data_set.entry(keys::data_set::kPoseGapMax, number(gap_ms));
        out.entry(indent, keys::camera::kDataSet, data_set.take());
    }
    if (!camera.device.empty()) out.entry(indent, keys::camera::kDevice, quoted(camera.device));
    if (!camera.link.empty()) out.entry(indent, keys::camera::kLink, quoted(camera.link));
    out.entry(indent, keys::camera::kPose, pose(camera.T_link_camera));
}

void write_cameras(Writer& out, const std::vector<Camera>& cameras) {
    if (cameras.empty()) return;
    const bool is_list = !cameras.front().name.empty();
    if (is_list) {
        out.open("", keys::kCameras);
    } else {
        out.open("", keys::kCameraTable);
    }
    for (const Camera& camera : cameras)
        write_camera(out, camera, is_list ? "  - " : "  ", is_list ? "    " : "  ");
}

void write_board(Writer& out, const Board& board) {
    out.open("    ", keys::node::kBoard);
    out.entry("      ", keys::board::kName, quoted(board.name));
    out.entry("      ", keys::board::kBoardType, board.board_type);
    out.entry("      ", keys::board::kI2cBusCount, board.i2c_bus_count);
    out.entry("      ", keys::board::kXshutLineCount, board.xshut_line_count);
    out.entry("      ", keys::board::kSensorsMax, board.sensors_max);
    out.entry("      ", keys::board::kSensorsPerBusMax, board.sensors_per_bus_max);
    out.entry("      ", keys::board::kSupportsCanFd, board.supports_can_fd);
    out.entry("      ", keys::board::kHasDataReadyLines, board.has_data_ready_lines);
}

void write_sensor(Writer& out, const Sensor& sensor, const SensorConfig& config) {
    out.entry("      - ", keys::sensor::kName, quoted(sensor.name));
    out.entry("        ", keys::sensor::kLink, quoted(sensor.link));
    out.entry("        ", keys::sensor::kPose, pose(sensor.T_link_sensor));
    out.entry("        ", keys::sensor::kBus, config.bus);
    out.entry("        ", keys::sensor::kXshutLine, config.xshut_line);
    out.entry("        ", keys::sensor::kAddress, fmt::format("0x{:02x}", config.address));
    out.entry("        ", keys::sensor::kDistanceMode,
              word_of(keys::sensor::kDistanceMode, config.distance_mode));
    out.entry("        ", keys::sensor::kTimingBudget, config.timing_budget_ms);
    out.entry("        ", keys::sensor::kInterMeasurement, config.inter_measurement_ms);
    out.entry("        ", keys::sensor::kPhase, config.phase_us);
    if (config.has_offset)
        out.entry("        ", keys::sensor::kDeviceOffset,
                  number(config.offset_quarter_mm / keys::sensor::kQuartersPer_mm));
    out.entry("        ", keys::sensor::kCrosstalk,
              number(config.crosstalk_raw / keys::sensor::kCrosstalkStepsPer_kcps));
    out.entry("        ", keys::sensor::kSigmaLimit,
              number(config.sigma_limit_quarter_mm / keys::sensor::kQuartersPer_mm));
    out.entry("        ", keys::sensor::kSignalLimit,
              number(config.signal_limit_raw / keys::sensor::kSignalStepsPer_mcps));
    if (config.reflex_below_mm > 0) {
        out.entry("        ", keys::sensor::kReflexBelow, number(config.reflex_below_mm / 1000.0));
    }
    out.entry("        ", keys::sensor::kAppliesGainFactor, config.applies_gain_factor);
    out.open("        ", keys::sensor::kZones);
    for (std::size_t i = 0; i < config.zone_count; ++i) {
        const Roi& roi = config.zones[i];
        out.item("          ", FlowTable()
                                   .entry(keys::zone::kCentre, roi.centre_spad)
                                   .entry(keys::zone::kWidth, roi.width)
                                   .entry(keys::zone::kHeight, roi.height)
                                   .entry(keys::zone::kOffset, number(sensor.zone_offset_m[i]))
                                   .take());
    }
    if (sensor.cone) {
        out.entry("        ", keys::sensor::kCone,
                  FlowTable()
                      .entry(keys::cone::kSubRays, sensor.cone->sub_rays)
                      .entry(keys::cone::kHalfAngle, number(sensor.cone->half_angle_deg))
                      .entry(keys::cone::kSigma, number(sensor.cone->sigma_deg))
                      .entry(keys::cone::kBlur, number(sensor.cone->blur_deg))
                      .take());
    }
}

/// Left out if it has its default: rigs without these keys keep the hash from before the keys existed.
void write_verification(Writer& out, const NodeConfig& config) {
    if (config.verifies_registers && config.left_out_count == 0) return;
    out.open("    ", keys::node::kVerification);
    out.entry("      ", keys::verification::kEnabled, config.verifies_registers);
    if (config.left_out_count > 0) out.open("      ", keys::verification::kLeaveOut);
    for (std::size_t i = 0; i < config.left_out_count; ++i)
        out.item("        ", fmt::format("0x{:02x}", config.left_out[i]));
}

void write_node(Writer& out, const Node& node) {
    out.entry("  - ", keys::node::kName, quoted(node.name));
    out.entry("    ", keys::node::kNodeId, node.config.node_id);
    write_board(out, node.board);
    out.entry("    ", keys::node::kI2cHz, node.config.i2c_hz);
    out.entry("    ", keys::node::kIoLevel, word_of(keys::node::kIoLevel, node.config.is_io_2v8));
    out.entry("    ", keys::node::kReadsTwice, node.config.reads_twice);
    out.entry("    ", keys::node::kStreamGate, word(node.config.stream_gate));
    out.entry("    ", keys::node::kAuxEvery, node.config.aux_every);
    out.entry("    ", keys::node::kZoneGuard, node.config.zone_guard_us);
    out.entry("    ", keys::node::kHoldsPhases, node.config.holds_phases);
    if (node.config.data_ready_buses != 0) out.open("    ", keys::node::kDataReadyBuses);
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if ((node.config.data_ready_buses >> bus & 1U) != 0) out.item("      ", bus);
    }
    if (node.config.ready_jitter_us != kReadyJitterMinUs)
        out.entry("    ", keys::node::kReadyJitter, node.config.ready_jitter_us);
    write_verification(out, node.config);
    if (node.config.refuses_commands)
        out.entry("    ", keys::node::kRefusesCommands, node.config.refuses_commands);
    if (node.pinned_build_id)
        out.entry("    ", keys::node::kPinnedBuildId, fmt::format("0x{:08x}", *node.pinned_build_id));
    out.open("    ", keys::node::kSensors);
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        write_sensor(out, node.sensors[i], node.config.sensors[i]);
    }
}

}  // namespace

std::string canonical_text(const Rig& rig, const std::string& urdf) {
    Writer out;
    out.entry("", keys::kName, quoted(rig.name));
    write_robot(out, rig, urdf);
    out.entry("", keys::kMapBase, pose(rig.T_map_base));
    write_bus(out, rig.bus);
    out.open("", keys::kRangeLimitsTable);
    out.entry("  ", keys::range_limits::kMin, number(rig.range_limits.min_m));
    out.entry("  ", keys::range_limits::kMax, number(rig.range_limits.max_m));
    out.entry("  ", keys::range_limits::kSigmaMax, number(rig.range_limits.sigma_max_m));
    out.entry("  ", keys::range_limits::kTimeUncertaintyMax,
              number(rig.range_limits.time_uncertainty_max_ms));
    write_joints(out, rig.joint_sources);
    write_cameras(out, rig.cameras);
    out.open("", keys::kNodes);
    for (const Node& node : rig.nodes) write_node(out, node);
    return out.take();
}

}  // namespace octoskin::rig
