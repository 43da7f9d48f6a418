// The rig as plain values, without files and YAML. host/io/rig creates it from a rig file; tests fill it in
// directly.
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "common/wire/bus_load.hpp"
#include "common/wire/messages.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/noise_law.hpp"
#include "host/core/rig/beam_optics.hpp"

namespace octoskin {

/// One region of interest of a sensor, in the order of the zone index on the wire.
struct HostZone {
    double offset_m = 0.0;  ///< added to every valid range of this zone
    /// Axis of the zone: unit vector in the sensor's frame. A zone over the whole array has +z.
    Eigen::Vector3d direction_sensor = Eigen::Vector3d::UnitZ();
    BeamOptics optics = {};  ///< about `direction_sensor`
};

struct HostSensor {
    std::string name;
    std::string link;                                                 ///< URDF link that carries it
    Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();  ///< ranges run along the sensor's +z
    Microseconds timing_budget{20'000};
    Microseconds period{33'000};  ///< inter-measurement period as configured
    std::vector<HostZone> zones = {HostZone{}};
    double fov_rad = 0.0;         ///< full angle of its cone: its only zone's, or the whole array's; 0: a ray
    double reflex_below_m = 0.0;  ///< a hit closer than this makes the node send REFLEX; 0: never
};

struct HostNode {
    wire::NodeId node_id = 0;
    std::string name;
    std::uint32_t node_hash = 0;  ///< the node must report exactly this hash before its ranges are used
    std::optional<std::uint32_t> pinned_build_id;  ///< if set, any other build is refused
    std::vector<HostSensor> sensors;               ///< in the order of the sensor index on the wire
    std::uint8_t aux_every = 0;                    ///< RANGE_AUX with every n-th reading; 0: never
};

/// A sender of joint states. It answers SYNC as every node does. It need not be one of `HostRig::nodes`.
struct HostJointSource {
    wire::NodeId node_id = 0;
    std::vector<std::string> joints;  ///< URDF joint names in the order on the wire, 1..7
    double rate_hz = 100.0;
    /// They come from this machine, which has the bus's clock. No other sender can use their node id.
    bool is_local = false;
};

inline constexpr std::size_t kCamerasMax = 8;

struct HostCamera {
    std::string name = {};  ///< unique; empty: the rig's only camera
    CameraIntrinsics intrinsics;
    double depth_min_m = 0.5;  ///< along the optical axis
    double depth_max_m = 4.5;
    std::string link = {};  ///< URDF link that carries it; empty: the base link
    /// Optical frame: z forward, x right, y down.
    Eigen::Isometry3d T_link_camera = Eigen::Isometry3d::Identity();
    double rate_hz = 10.0;
    std::optional<DepthNoiseLaw> noise = {};  ///< empty: that of the mapping
    std::string device = {};                  ///< OpenNI2 URI, .oni file, ros:/TOPIC; empty: the first
};

/// A piece of the robot's body: all points within `radius_m` of the segment from p_link_a to p_link_b,
/// padding included. Equal ends: a sphere.
struct LinkCapsule {
    std::string link;
    Eigen::Vector3d p_link_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_link_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// A link that a joint moves and that has a <visual>, but no body that covers a useful part of it; nor has a
/// link that is rigidly attached to it (`rig::bodyless_links`). It is not removed from images and ranges, and
/// no query about the robot's body covers it.
struct LinkWithoutBody {
    std::string link;
    bool is_listed = false;  ///< listed in the rig as intended (`links_without_body`)
};

/// A link that a joint moves and that has a <visual>, but no capsule of its own: it uses the body of a link
/// that is rigidly attached to it.
struct LinkWithBorrowedBody {
    std::string link;
    std::string body_of;
};

/// The limits that each range must meet to be accepted.
struct HostRangeLimits {
    double min_m = 0.04;
    double max_m = 4.0;
    double sigma_max_m = 0.2;
    /// Limit of a capture time's error: the clock map's error bound plus the node's own.
    Nanoseconds time_uncertainty_max{5'000'000};
};

struct HostRig {
    std::string name;
    std::uint32_t rig_hash = 0;
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
    std::vector<HostNode> nodes;                 ///< sensor nodes, unique ids
    std::vector<HostJointSource> joint_sources;  ///< unique ids and joints, at most kJointsMax in all
    std::vector<HostCamera> cameras;             ///< at most kCamerasMax
    std::vector<LinkCapsule> body;
    /// Space that only the robot can occupy: without padding, and inside each element of the robot
    /// description.
    std::vector<LinkCapsule> certain_body;
    std::vector<LinkWithoutBody> links_without_body;             ///< by name
    std::vector<LinkWithBorrowedBody> links_with_borrowed_body;  ///< by name
    /// Links that are ignored when a sensor's self-hit is predicted: its mount.
    std::vector<std::string> links_ignored_by_sensors;
    double depth_self_margin_m = 0.09;  ///< depth points this close to a capsule's surface are the robot
    double range_self_margin_m = 0.12;  ///< ranges beyond (predicted self-hit - this) are the robot
    HostRangeLimits range_limits;
    wire::BitRates bit_rates;  ///< of the CAN bus

    /// The joints of all sources, in their order: the order of all joint vectors.
    [[nodiscard]] std::vector<std::string> joint_names() const {
        std::vector<std::string> names;
        for (const HostJointSource& source : joint_sources)
            names.insert(names.end(), source.joints.begin(), source.joints.end());
        return names;
    }
    /// The number of joints of each source.
    [[nodiscard]] std::vector<std::size_t> joint_counts() const {
        std::vector<std::size_t> counts;
        for (const HostJointSource& source : joint_sources) counts.push_back(source.joints.size());
        return counts;
    }
    /// The index of a source in `joint_sources`; empty if the node is none.
    [[nodiscard]] std::optional<std::size_t> joint_source_of(wire::NodeId node) const {
        for (std::size_t i = 0; i < joint_sources.size(); ++i)
            if (joint_sources[i].node_id == node) return i;
        return std::nullopt;
    }
};

}  // namespace octoskin
