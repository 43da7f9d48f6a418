// What the daemon's rig and robot say, as its answer to `describe`.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::bridge {

struct SensorFacts {
    std::uint8_t node = 0;
    std::uint8_t sensor = 0;
    std::string link;
    Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();  ///< ranges run along +z
    double fov_rad = 0.0;                                             ///< full angle of the cone
    double range_min_m = 0.0;
    double range_max_m = 0.0;

    /// "n1_s0": the sensor in names of topics and frames.
    [[nodiscard]] std::string label() const;
};

struct JointSourceFacts {
    bool is_local = false;  ///< its samples come through the daemon's joint socket
    std::vector<std::string> joints;
};

struct CameraFacts {
    std::string name;
    std::string device;  ///< "ros:/topic" if a program feeds it
    std::string link;
    Eigen::Isometry3d T_link_camera = Eigen::Isometry3d::Identity();
    CameraIntrinsics intrinsics = {};  ///< without its lens distortion
    double rate_hz = 0.0;

    /// The topic without "ros:"; empty for another device.
    [[nodiscard]] std::optional<std::string> topic() const;
};

struct RobotFacts {
    std::string rig;
    std::uint64_t reloads = 0;  ///< since the daemon's start: which rig this is
    std::string root_link;      ///< of the URDF
    std::string base_link;
    Eigen::Isometry3d T_root_base = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d T_root_map = Eigen::Isometry3d::Identity();
    std::vector<std::string> links;        ///< of the URDF
    std::vector<JointDescription> joints;  ///< below the base link
    std::vector<LinkCapsule> body;
    std::vector<JointSourceFacts> joint_sources;
    std::vector<SensorFacts> sensors;
    std::vector<CameraFacts> cameras;

    [[nodiscard]] const SensorFacts* find_sensor(std::uint8_t node, std::uint8_t sensor) const noexcept;
    [[nodiscard]] bool has_link(const std::string& link) const;
};

/// From the daemon's answer. The error names the key that is missing or wrong.
[[nodiscard]] Result<RobotFacts, std::string> robot_facts(const nlohmann::ordered_json& described);

}  // namespace octoskin::bridge
