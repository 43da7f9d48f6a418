#include "host/apps/rig/new_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/wire/messages.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/core/kinematics/joint_twist.hpp"
#include "host/io/folder/confined.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kSensorsOfBoard = 16;
constexpr std::size_t kBuses = 4;
constexpr int kFirstAddress = 0x30;
constexpr std::size_t kPeriod_us = 20'000;

struct PlacedSensor {
    std::string name;
    std::string link;
    std::string pose;
    bool is_to_measure = false;
};

Unexpected<AppError> refused(Error error) {
    return unexpected(reading_error(ExitCode::bad_config, std::move(error)));
}

std::string yaml_text(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

std::string list_of(const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : ", ") + yaml_text(name);
    return "[" + out + "]";
}

/// Letters and digits of the robot's file name.
std::string name_of(const std::filesystem::path& urdf) {
    std::string name;
    for (const char c : urdf.stem().string()) {
        const bool is_kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        name += is_kept ? c : '_';
    }
    return (name.empty() ? "robot" : name.substr(0, 50)) + "_rig";
}

std::string pose_of(const RingPlace& place) {
    // Yaw turns after pitch: the sensor's z first to the link's x, then about the link's z.
    return fmt::format("{{xyz_m: [{:.4f}, {:.4f}, {:.4f}], rpy_deg: [0, 90, {:.6g}]}}", place.p_link.x(),
                       place.p_link.y(), place.p_link.z(), place.azimuth_deg);
}

Result<std::vector<PlacedSensor>, Error> sensors_of(const NewRig& request, const rig::Rig& rig,
                                                    const std::string& tip) {
    std::vector<PlacedSensor> sensors;
    if (request.rings.empty()) {
        constexpr std::array kNames{"front", "left", "back", "right"};
        for (std::size_t i = 0; i < kNames.size(); ++i) {
            sensors.push_back(
                {kNames[i], tip, fmt::format("{{xyz_m: [0, 0, 0], rpy_deg: [0, 90, {}]}}", 90 * i), true});
        }
        return sensors;
    }
    const auto body = rig::real_body(rig);
    if (!body) return unexpected(body.error());
    for (std::size_t k = 0; k < request.rings.size(); ++k) {
        const auto places = places_of(request.rings[k], *body);
        if (!places) return unexpected(places.error());
        for (std::size_t i = 0; i < places->size(); ++i) {
            sensors.push_back({fmt::format("ring{}_{}", k, i), request.rings[k].link, pose_of((*places)[i])});
        }
    }
    if (sensors.size() <= kRigSensorsMax) return sensors;
    return unexpected(Error{.code = ErrorCode::limit_exceeded,
                            .what = fmt::format("expected at most {} sensors on a robot", kRigSensorsMax),
                            .value = std::to_string(sensors.size()),
                            .remedy = "give rings of fewer sensors",
                            .key = "--ring"});
}

/// The sensors of a bus range in turn, evenly, and the buses are staggered.
std::size_t phase_us(std::size_t sensor, std::size_t count) {
    const std::size_t bus = sensor % kBuses;
    const std::size_t on_bus = (count - bus + kBuses - 1) / kBuses;
    return kPeriod_us * (kBuses * (sensor / kBuses) + bus) / (kBuses * on_bus);
}

std::string node_text(std::size_t number, std::span<const PlacedSensor> sensors, const std::string& board) {
    std::string text = fmt::format("  - name: board{0}\n    node_id: {0}\n    board: {1}\n    sensors:\n",
                                   number, yaml_text(board));
    for (std::size_t i = 0; i < sensors.size(); ++i) {
        const PlacedSensor& sensor = sensors[i];
        text += fmt::format(
            "      - {{name: {}, link: {}, bus: {}, xshut_line: {}, address: {:#x}, phase_us: {},\n"
            "         pose: {}}}{}\n",
            sensor.name, yaml_text(sensor.link), i % kBuses, i, kFirstAddress + static_cast<int>(i),
            phase_us(i, sensors.size()), sensor.pose, sensor.is_to_measure ? "  # TO MEASURE" : "");
    }
    return text;
}

/// More than seven joints are of several senders.
std::string joints_text(const std::vector<std::string>& joints) {
    constexpr int kFirstNode = 60;
    const std::string what = "of the sender of joint states on the bus; unused with `octoskin run --joints`";
    std::string text = "joints:\n";
    const bool is_one = joints.size() <= wire::kJointsPerSample;
    for (std::size_t first = 0; first < joints.size(); first += wire::kJointsPerSample) {
        const std::size_t count = std::min<std::size_t>(wire::kJointsPerSample, joints.size() - first);
        const auto of_source = std::span(joints).subspan(first, count);
        text += fmt::format(
            "{}node_id: {}  # {}\n{}rate_hz: 100\n{}names: {}  # in the order of the sender\n",
            is_one ? "  " : "  - ", kFirstNode - static_cast<int>(first / wire::kJointsPerSample), what,
            is_one ? "  " : "    ", is_one ? "  " : "    ", list_of({of_source.begin(), of_source.end()}));
    }
    return text;
}

std::string text_of(const NewRig& request, const rig::Rig& rig, const std::vector<std::string>& joints,
                    const std::vector<PlacedSensor>& sensors, bool has_meshes) {
    std::vector<std::string> mounts;
    for (const PlacedSensor& sensor : sensors)
        if (std::ranges::find(mounts, sensor.link) == mounts.end()) mounts.push_back(sensor.link);
    std::string nodes;
    for (std::size_t first = 0; first < sensors.size(); first += kSensorsOfBoard) {
        const std::size_t count = std::min(kSensorsOfBoard, sensors.size() - first);
        nodes += node_text(1 + first / kSensorsOfBoard, std::span(sensors).subspan(first, count),
                           request.board_in_rig);
    }
    return fmt::format(
        "# A rig, written by `octoskin rig --new`. It loads as it is. {}\n"
        "# `octoskin rig FILE --picture rig.svg` shows what it says. docs/rig.md explains every key.\n"
        "name: {}\n\n"
        "robot:\n"
        "{}"
        "  urdf: {}\n"
        "  base_link: {}  # frame of the map's origin and of the camera's pose\n"
        "  # Left out where a sensor predicts that its beam meets the robot: the links that hold sensors.\n"
        "  links_ignored_by_sensors: {}\n\n"
        "bus:\n"
        "  protocol: can_fd\n"
        "  nominal_bitrate_bps: 1000000\n"
        "  data_bitrate_bps: 5000000\n\n"
        "{}\n"
        "sensor_defaults:\n"
        "  distance_mode: short      # to 1.36 m, best in bright light; long: to 3.6 m in the dark\n"
        "  timing_budget_ms: 15\n"
        "  inter_measurement_ms: 20  # 50 Hz\n"
        "  cone: {{}}                  # the sensor's cone of 27 degrees; remove it for ideal rays\n\n"
        "# A sensor looks along its own z. Its pose is that of its lens on its link.\n"
        "nodes:\n"
        "{}\n"
        "# An external depth camera (`octoskin cameras` lists sizes):\n"
        "# camera:\n"
        "#   width_px: 640\n"
        "#   height_px: 480\n"
        "#   fx_px: 570.3\n"
        "#   fy_px: 570.3\n"
        "#   cx_px: 320\n"
        "#   cy_px: 240\n"
        "#   rate_hz: 30\n"
        "#   pose: {{xyz_m: [1.5, 0, 1.2], looking_at_m: [0, 0, 0.4]}}\n"
        "# Several are a list, `cameras:`, each with a `name` and a `device`; one on the robot has a "
        "`link`.\n",
        request.rings.empty() ? "The poses of the sensors are yours to measure."
                              : "The poses of the sensors lie on the links' bodies: check them on the robot.",
        name_of(request.robot.urdf),
        has_meshes
            ? "  # It has meshes. `octoskin run` wants the file of `octoskin robot URDF --out FITTED.urdf`.\n"
            : "",
        yaml_text(request.robot_in_rig), yaml_text(rig.base_link), list_of(mounts), joints_text(joints),
        nodes);
}

}  // namespace

Result<std::string, AppError> new_rig_text(const NewRig& request) {
    rig::Rig rig;
    rig.urdf = confined_to_recording(request.robot.urdf);
    const auto robot = read_robot_text(rig.urdf, request.base_link);
    if (!robot) return refused(robot.error());
    rig.urdf = FilePlace::held(robot->text, rig.urdf);
    rig.base_link = robot->shapes.base_link;
    const auto document = rig::UrdfDocument::read(rig.urdf);
    if (!document) return refused(document.error());
    if (const auto joint = document->joint_moving(rig.base_link)) {
        return fail(ExitCode::usage,
                    {.code = ErrorCode::conflict,
                     .what = "expected a base link that no joint moves",
                     .value = fmt::format("'{}', which joint '{}' moves", rig.base_link, *joint),
                     .remedy = "leave --base out for the URDF's root",
                     .key = "--base"});
    }
    const auto moving = document->moving_joints_outward(rig.base_link);
    std::vector<std::string> joints;
    for (const rig::JointOfLink& joint : moving) joints.push_back(joint.joint);
    if (joints.empty() || joints.size() > kJointsMax) {
        return refused(
            {.code = ErrorCode::limit_exceeded,
             .what = fmt::format("expected 1 to {} moving joints below {}", kJointsMax, rig.base_link),
             .value = std::to_string(joints.size()),
             .remedy = "make the others fixed in a copy of the URDF, or give another --base",
             .file = rig.urdf.shown()});
    }
    const bool has_meshes = needs_fit(robot->shapes);
    if (!request.rings.empty()) {
        auto fitted = with_fitted_body(std::move(rig), request.robot.packages, BodyFitting::if_needed);
        if (!fitted) return unexpected(fitted.error());
        rig = *std::move(fitted);
    }
    for (const SensorRing& ring : request.rings) {
        if (document->is_below(rig.base_link, ring.link)) continue;
        return fail(ExitCode::usage, {.code = ErrorCode::unknown_name,
                                      .what = fmt::format("expected a link at or below {}", rig.base_link),
                                      .value = fmt::format("'{}'", ring.link),
                                      .remedy = "`octoskin robot` lists them",
                                      .key = "--ring"});
    }
    const auto sensors = sensors_of(request, rig, moving.back().child_link);
    if (!sensors) return fail(ExitCode::usage, sensors.error());
    return text_of(request, rig, joints, *sensors, has_meshes);
}

}  // namespace octoskin
