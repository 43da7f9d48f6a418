// The canonical text of a rig: every key written out, in a fixed order, numbers in their shortest exact form.
#include <fmt/format.h>

#include <iterator>
#include <string>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {
namespace {

/// Text under construction, one "key: value" line at a time.
class Writer {
  public:
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

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
    return fmt::format("{{xyz_m: {}, rotation_rows: [{}, {}, {}]}}", list(T.translation()), list(rows.col(0)),
                       list(rows.col(1)), list(rows.col(2)));
}

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

const char* word(DistanceMode mode) {
    if (mode == DistanceMode::short_range) return "short";
    return mode == DistanceMode::medium_range ? "medium" : "long";
}

const char* word(StreamGate gate) {
    switch (gate) {
        case StreamGate::off:
            return "'off'";
        case StreamGate::differs:
            return "differs";
        case StreamGate::advanced:
            break;
    }
    return "advanced";
}

void write_robot(Writer& out, const Rig& rig, const std::string& urdf) {
    out.line("robot:");
    out.line("  urdf: {}", quoted(urdf));
    out.line("  base_link: {}", quoted(rig.base_link));
    if (!rig.link_padding_m.empty()) out.line("  link_padding_m:");
    for (const auto& [link, padding_m] : rig.link_padding_m)
        out.line("    {}: {}", quoted(link), number(padding_m));
    // Left out if they have their default: rigs without these keys keep the hash from before the keys
    // existed.
    if (rig.fits_capsules) out.line("  fits_capsules: true");
    if (!rig.attached_capsules.empty()) out.line("  attached_capsules:");
    for (const AttachedCapsule& capsule : rig.attached_capsules) {
        out.line("    - {{name: {}, link: {}, from_m: {}, to_m: {}, radius_m: {}, padding_m: {}}}",
                 quoted(capsule.name), quoted(capsule.link), list(capsule.p_link_a), list(capsule.p_link_b),
                 number(capsule.radius_m), number(capsule.padding_m));
    }
    if (!rig.links_without_body.empty()) out.line("  links_without_body:");
    for (const auto& link : rig.links_without_body) out.line("    - {}", quoted(link));
    if (!rig.links_ignored_by_sensors.empty()) out.line("  links_ignored_by_sensors:");
    for (const auto& link : rig.links_ignored_by_sensors) out.line("    - {}", quoted(link));
    out.line("  depth_self_margin_m: {}", number(rig.depth_self_margin_m));
    out.line("  range_self_margin_m: {}", number(rig.range_self_margin_m));
}

void write_bus(Writer& out, const Bus& bus) {
    out.line("bus:");
    out.line("  protocol: {}", bus.uses_can_fd ? "can_fd" : "can");
    out.line("  nominal_bitrate_bps: {}", bus.nominal_bitrate);
    if (bus.uses_can_fd) out.line("  data_bitrate_bps: {}", bus.data_bitrate);
}

void write_joints(Writer& out, const JointSource& joints) {
    out.line("joints:");
    out.line("  node_id: {}", joints.node_id);
    out.line("  rate_hz: {}", number(joints.rate_hz));
    out.line("  names:");
    for (const auto& name : joints.joints) out.line("    - {}", quoted(name));
}

void write_camera(Writer& out, const Camera& camera) {
    out.line("camera:");
    out.line("  width_px: {}", camera.width);
    out.line("  height_px: {}", camera.height);
    out.line("  fx_px: {}", number(camera.fx));
    out.line("  fy_px: {}", number(camera.fy));
    out.line("  cx_px: {}", number(camera.cx));
    out.line("  cy_px: {}", number(camera.cy));
    if (const LensDistortion& lens = camera.lens; !lens.is_none()) {
        out.line("  distortion: {{k1: {}, k2: {}, p1: {}, p2: {}, k3: {}}}", number(lens.k1), number(lens.k2),
                 number(lens.p1), number(lens.p2), number(lens.k3));
    }
    out.line("  rate_hz: {}", number(camera.rate_hz));
    out.line("  depth_min_m: {}", number(camera.depth_min_m));
    out.line("  depth_max_m: {}", number(camera.depth_max_m));
    // Left out if they have their default, as is a lens without distortion: rigs without these keys keep the
    // hash from before the keys existed.
    const DataSetDepth depth = camera.data_set.depth();
    const double gap_ms = camera.data_set.pose_gap_max_ms;
    const bool has_gap = gap_ms != DataSetKeys{}.pose_gap_max_ms;
    if (depth != DataSetDepth{} || has_gap) {
        out.line("  data_set: {{depth_units_per_m: {}, depth_no_value: {}{}}}", number(depth.units_per_m),
                 depth.no_value, has_gap ? ", pose_gap_max_ms: " + number(gap_ms) : "");
    }
    out.line("  pose: {}", pose(camera.T_base_camera));
}

void write_board(Writer& out, const Board& board) {
    out.line("    board:");
    out.line("      name: {}", quoted(board.name));
    out.line("      board_type: {}", board.board_type);
    out.line("      i2c_bus_count: {}", board.i2c_bus_count);
    out.line("      xshut_line_count: {}", board.xshut_line_count);
    out.line("      sensors_max: {}", board.sensors_max);
    out.line("      sensors_per_bus_max: {}", board.sensors_per_bus_max);
    out.line("      supports_can_fd: {}", board.supports_can_fd);
    out.line("      has_data_ready_lines: {}", board.has_data_ready_lines);
}

void write_sensor(Writer& out, const Sensor& sensor, const SensorConfig& config) {
    out.line("      - name: {}", quoted(sensor.name));
    out.line("        link: {}", quoted(sensor.link));
    out.line("        pose: {}", pose(sensor.T_link_sensor));
    out.line("        bus: {}", config.bus);
    out.line("        xshut_line: {}", config.xshut_line);
    out.line("        address: 0x{:02x}", config.address);
    out.line("        distance_mode: {}", word(config.distance_mode));
    out.line("        timing_budget_ms: {}", config.timing_budget_ms);
    out.line("        inter_measurement_ms: {}", config.inter_measurement_ms);
    out.line("        phase_us: {}", config.phase_us);
    if (config.has_offset) out.line("        device_offset_mm: {}", number(config.offset_quarter_mm / 4.0));
    out.line("        crosstalk_kcps: {}", number(config.crosstalk_raw / 512.0));
    out.line("        sigma_limit_mm: {}", number(config.sigma_limit_quarter_mm / 4.0));
    out.line("        signal_limit_mcps: {}", number(config.signal_limit_raw / 128.0));
    if (config.reflex_below_mm > 0) {
        out.line("        reflex_below_m: {}", number(config.reflex_below_mm / 1000.0));
    }
    out.line("        applies_gain_factor: {}", config.applies_gain_factor);
    out.line("        zones:");
    for (std::size_t i = 0; i < config.zone_count; ++i) {
        const Roi& roi = config.zones[i];
        out.line("          - {{centre_spad: {}, width_spads: {}, height_spads: {}, offset_m: {}}}",
                 roi.centre_spad, roi.width, roi.height, number(sensor.zone_offset_m[i]));
    }
    if (sensor.cone) {
        out.line("        cone: {{sub_rays: {}, half_angle_deg: {}, sigma_deg: {}, blur_deg: {}}}",
                 sensor.cone->sub_rays, number(sensor.cone->half_angle_deg), number(sensor.cone->sigma_deg),
                 number(sensor.cone->blur_deg));
    }
}

/// Left out if it has its default: rigs without these keys keep the hash from before the keys existed.
void write_verification(Writer& out, const NodeConfig& config) {
    if (config.verifies_registers && config.left_out_count == 0) return;
    out.line("    verification:");
    out.line("      enabled: {}", config.verifies_registers);
    if (config.left_out_count > 0) out.line("      leave_out:");
    for (std::size_t i = 0; i < config.left_out_count; ++i)
        out.line("        - 0x{:02x}", config.left_out[i]);
}

void write_node(Writer& out, const Node& node) {
    out.line("  - name: {}", quoted(node.name));
    out.line("    node_id: {}", node.config.node_id);
    write_board(out, node.board);
    out.line("    i2c_hz: {}", node.config.i2c_hz);
    out.line("    io_level: {}", node.config.is_io_2v8 ? "2v8" : "1v8");
    out.line("    reads_twice: {}", node.config.reads_twice);
    out.line("    stream_gate: {}", word(node.config.stream_gate));
    out.line("    aux_every: {}", node.config.aux_every);
    out.line("    zone_guard_us: {}", node.config.zone_guard_us);
    out.line("    holds_phases: {}", node.config.holds_phases);
    if (node.config.data_ready_buses != 0) out.line("    data_ready_buses:");
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if ((node.config.data_ready_buses >> bus & 1U) != 0) out.line("      - {}", bus);
    }
    if (node.config.ready_jitter_us != kReadyJitterMinUs)
        out.line("    ready_jitter_us: {}", node.config.ready_jitter_us);
    write_verification(out, node.config);
    if (node.config.refuses_commands) out.line("    refuses_commands: true");
    if (node.pinned_build_id) out.line("    pinned_build_id: 0x{:08x}", *node.pinned_build_id);
    out.line("    sensors:");
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        write_sensor(out, node.sensors[i], node.config.sensors[i]);
    }
}

}  // namespace

std::string canonical_text(const Rig& rig, const std::string& urdf) {
    Writer out;
    out.line("name: {}", quoted(rig.name));
    write_robot(out, rig, urdf);
    out.line("T_map_base: {}", pose(rig.T_map_base));
    write_bus(out, rig.bus);
    out.line("range_limits:");
    out.line("  min_m: {}", number(rig.range_limits.min_m));
    out.line("  max_m: {}", number(rig.range_limits.max_m));
    out.line("  sigma_max_m: {}", number(rig.range_limits.sigma_max_m));
    out.line("  time_uncertainty_max_ms: {}", number(rig.range_limits.time_uncertainty_max_ms));
    write_joints(out, rig.joints);
    if (rig.camera) write_camera(out, *rig.camera);
    out.line("nodes:");
    for (const Node& node : rig.nodes) write_node(out, node);
    return out.take();
}

}  // namespace octoskin::rig
