#include "host/apps/rig/rig_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/apps/robot/svg_view.hpp"
#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/kinematics/self_hit.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/core/text/markup.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr double kSide_px = 460.0;
constexpr double kHead_px = 46.0;
constexpr double kBeam_m = 0.25;
constexpr double kPyramid_m = 0.5;
constexpr double kGrid_m = 0.5;
constexpr std::array kColours{"#d62728", "#1f77b4", "#2ca02c", "#9467bd", "#ff7f0e", "#8c564b"};

struct DrawnSensor {
    std::string name;
    std::size_t colour = 0;
    Eigen::Vector3d origin;
    std::vector<Points> beams;  ///< a line, or the outline of a cone's end
};

struct DrawnCamera {
    std::string name;  ///< empty: the only one
    std::vector<Points> lines;
};

/// Everything in the base frame.
struct Drawing {
    std::vector<PosedCapsule> arm;
    std::vector<DrawnSensor> sensors;
    std::vector<DrawnCamera> cameras;
    Eigen::AlignedBox3d box;
};

/// The edge of a cone's end, or the end of a ray.
Points end_of(const HostZone& zone, const Eigen::Isometry3d& T_base_sensor) {
    constexpr int kSides = 24;
    const Eigen::Vector3d axis = zone.direction_sensor;
    const double half_angle = zone.optics.half_angle_rad;
    if (half_angle == 0.0) return {T_base_sensor * (kBeam_m * axis)};
    const Eigen::Vector3d side = axis.unitOrthogonal();
    Points edge;
    for (int i = 0; i < kSides; ++i) {
        const Eigen::Vector3d across = Eigen::AngleAxisd(2.0 * std::numbers::pi * i / kSides, axis) * side;
        edge.push_back(T_base_sensor *
                       (kBeam_m * (std::cos(half_angle) * axis + std::sin(half_angle) * across)));
    }
    return edge;
}

std::vector<Points> pyramid_of(const HostCamera& camera, const Eigen::Isometry3d& T_base_camera) {
    const CameraIntrinsics& of = camera.intrinsics;
    Points corners;
    for (const auto& [u, v] :
         {std::pair{0.0, 0.0}, std::pair{1.0, 0.0}, std::pair{1.0, 1.0}, std::pair{0.0, 1.0}}) {
        const double x = (u * of.width - of.cx) / of.fx, y = (v * of.height - of.cy) / of.fy;
        corners.push_back(T_base_camera * (kPyramid_m * Eigen::Vector3d(x, y, 1.0)));
    }
    std::vector<Points> lines{corners};
    lines.front().push_back(corners.front());
    for (const Eigen::Vector3d& corner : corners) lines.push_back({T_base_camera.translation(), corner});
    return lines;
}

Drawing drawing_of(const HostSetup& setup, std::span<const double> position) {
    std::vector<Eigen::Isometry3d> T_base_link(setup.robot.link_count());
    setup.robot.forward(position, T_base_link);
    Drawing drawing;
    if (const auto body = RobotBody::build(setup.rig.body, setup.robot)) body->pose(T_base_link, drawing.arm);
    drawing.box = box_of(drawing.arm);
    drawing.box.extend(Eigen::Vector3d::Zero().eval());
    for (std::size_t node = 0; node < setup.rig.nodes.size(); ++node) {
        for (const HostSensor& sensor : setup.rig.nodes[node].sensors) {
            const auto link = setup.robot.find_link(sensor.link);
            if (!link) continue;
            const Eigen::Isometry3d T_base_sensor = T_base_link[*link] * sensor.T_link_sensor;
            DrawnSensor drawn{sensor.name, node % kColours.size(), T_base_sensor.translation(), {}};
            for (const HostZone& zone : sensor.zones) drawn.beams.push_back(end_of(zone, T_base_sensor));
            drawing.box.extend(drawn.origin);
            for (const Points& beam : drawn.beams)
                for (const Eigen::Vector3d& point : beam) drawing.box.extend(point);
            drawing.sensors.push_back(std::move(drawn));
        }
    }
    for (const HostCamera& camera : setup.rig.cameras) {
        const auto link = setup.robot.find_link(camera.link);
        drawing.cameras.push_back(
            {camera.name, pyramid_of(camera, T_base_link[link.value_or(0)] * camera.T_link_camera)});
        for (const Points& line : drawing.cameras.back().lines)
            for (const Eigen::Vector3d& point : line) drawing.box.extend(point);
    }
    return drawing;
}

std::string line_of(const SvgView& view, const char* css_class, const Points& points,
                    bool is_closed = false) {
    return fmt::format("<path class=\"{}\" d=\"{}\"/>\n", css_class, view.path(points, is_closed));
}

std::string sensor_of(const SvgView& view, const DrawnSensor& sensor) {
    std::string text = fmt::format("<g stroke=\"{0}\" fill=\"{0}\"><title>{1}</title>\n",
                                   kColours.at(sensor.colour), escaped(printable(sensor.name)));
    for (const Points& beam : sensor.beams) {
        if (beam.size() > 1) text += line_of(view, "cone", beam, true);
        // The two flanks of the cone, and lines between them.
        const std::size_t step = std::max<std::size_t>(1, beam.size() / 6);
        for (std::size_t i = 0; i < beam.size(); i += step)
            text += line_of(view, "beam", {sensor.origin, beam[i]});
    }
    const std::string at = view.at(sensor.origin);
    const auto comma = at.find(',');
    return text + fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"3\"/></g>\n", at.substr(0, comma),
                              at.substr(comma + 1));
}

std::string camera_of(const SvgView& view, const DrawnCamera& camera) {
    std::string lines;
    for (const Points& line : camera.lines) lines += line_of(view, "camera", line);
    if (camera.name.empty()) return lines;
    return fmt::format("<g><title>{}</title>\n{}</g>\n", escaped(camera_text(printable(camera.name))), lines);
}

std::string panel_of(const Drawing& drawing, const ViewAxes& axes, double x_px) {
    const SvgView view(drawing.box, axes, kSide_px, x_px, kHead_px);
    std::string text = fmt::format("<text x=\"{:.0f}\" y=\"40\">{}</text>\n", x_px + 8.0, axes.name);
    for (const Eigen::Vector3d& direction :
         {Eigen::Vector3d::Unit(axes.right).eval(), Eigen::Vector3d::Unit(axes.up).eval()})
        text += line_of(view, "grid", {Eigen::Vector3d::Zero(), kGrid_m * direction});
    for (const PosedCapsule& capsule : drawing.arm) text += view.capsule("arm", capsule);
    for (const DrawnCamera& camera : drawing.cameras) text += camera_of(view, camera);
    for (const DrawnSensor& sensor : drawing.sensors) text += sensor_of(view, sensor);
    return text;
}

}  // namespace

std::vector<double> posture_at_rest(const RobotModel& robot) {
    std::vector<double> position;
    for (const JointLimits& limits : robot.limits())
        position.push_back(std::clamp(0.0, limits.min, limits.max));
    return position;
}

std::string rig_picture(const HostSetup& setup, std::span<const double> position) {
    const Drawing drawing = drawing_of(setup, position);
    std::string panels;
    for (std::size_t i = 0; i < kThreeViews.size(); ++i)
        panels += panel_of(drawing, kThreeViews[i], kSide_px * static_cast<double>(i));
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\">\n"
        "<style>text {{ font: 13px sans-serif }} path {{ fill: none }} .arm {{ stroke: #888; stroke-opacity: "
        ".45; stroke-linecap: round }} .grid {{ stroke: #000; stroke-width: 2 }} .camera {{ stroke: #000; "
        "stroke-dasharray: 5 3 }} .beam {{ stroke-opacity: .6 }} .cone {{ fill-opacity: .08; fill: inherit }}"
        "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        "<text x=\"8\" y=\"18\">{2}: {3} sensors, {4} capsules; black lines: 0.5 m from {5}'s origin; "
        "dashed: "
        "{7}</text>\n{6}</svg>\n",
        3.0 * kSide_px, kHead_px + kSide_px, escaped(printable(setup.rig.name)), drawing.sensors.size(),
        drawing.arm.size(), escaped(printable(setup.robot.link_names().front())), panels,
        drawing.cameras.size() > 1 ? "the cameras' views" : "the camera's view");
}

}  // namespace octoskin
