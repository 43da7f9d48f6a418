// The rig as the host core needs it: plain values, no file, no YAML. host/io/rig makes one from a rig file;
// tests write one by hand.
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
#include "host/core/rig/beam_optics.hpp"

namespace octoskin {

/// One region of interest of a sensor, in the order of the zone index on the wire.
struct HostZone {
    double offset_m = 0.0;  ///< added to every valid range of this zone
    /// Where the zone looks: unit vector in the sensor's frame. One zone over the whole array looks along +z.
    Eigen::Vector3d direction_sensor = Eigen::Vector3d::UnitZ();
    BeamOptics optics = {};  ///< about that direction
};

struct HostSensor {
    std::string name;
    std::string link;                                                 ///< URDF link that carries it
    Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();  ///< ranges run along the sensor's +z
    Microseconds timing_budget{20'000};
    Microseconds period{33'000};  ///< inter-measurement period as configured
    std::vector<HostZone> zones = {HostZone{}};
    double reflex_below_m = 0.0;  ///< a hit closer than this makes its node send REFLEX; 0: never
};

struct HostNode {
    wire::NodeId node_id = 0;
    std::string name;
    std::uint32_t node_hash = 0;  ///< the node must report exactly this one before its ranges count
    std::optional<std::uint32_t> pinned_build_id;  ///< refused with any other, if given
    std::vector<HostSensor> sensors;               ///< in the order of the local index on the wire
    std::uint8_t aux_every = 0;                    ///< RANGE_AUX with every n-th reading; 0: never
};

/// Who sends joint states. It answers SYNC as every node does; it need not be one of `HostRig::nodes`.
struct HostJointSource {
    wire::NodeId node_id = 0;
    std::vector<std::string> joints;  ///< URDF joint names in the order on the wire, 1..7
    double rate_hz = 100.0;
};

struct HostCamera {
    CameraIntrinsics intrinsics;
    double depth_min_m = 0.5;  ///< along the optical axis
    double depth_max_m = 4.5;
    /// Optical frame: z forward, x right, y down.
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
    double rate_hz = 10.0;
};

/// A piece of the robot's body: all points within `radius_m` of the segment from p_link_a to p_link_b,
/// padding included. Equal ends: a sphere.
struct LinkCapsule {
    std::string link;
    Eigen::Vector3d p_link_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_link_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// A link that a joint moves and that has a <visual>, but no body that covers a useful part of it, nor has a
/// link that is rigidly attached to it (`rig::bodyless_links`). Nothing of it is taken out of images and
/// ranges, and no answer about the robot's body tells of it.
struct LinkWithoutBody {
    std::string link;
    bool is_listed = false;  ///< the rig says that it is so on purpose (`links_without_body`)
};

/// A link that a joint moves and that has a <visual>, but no capsule of its own: the body of a link that is
/// rigidly attached to it is taken for its body.
struct LinkWithBorrowedBody {
    std::string link;
    std::string body_of;
};

/// The limits that acceptance applies to every range.
struct HostRangeLimits {
    double min_m = 0.04;
    double max_m = 4.0;
    double sigma_max_m = 0.2;
    /// Of a capture time: the clock map's error bound and the node's own together.
    Nanoseconds time_uncertainty_max{5'000'000};
};

struct HostRig {
    std::string name;
    std::uint32_t rig_hash = 0;
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
    std::vector<HostNode> nodes;  ///< sensor nodes, unique ids
    HostJointSource joints;
    std::optional<HostCamera> camera;
    std::vector<LinkCapsule> body;
    /// Where nothing can be but the robot: without padding, and within each element of its description.
    std::vector<LinkCapsule> certain_body;
    std::vector<LinkWithoutBody> links_without_body;             ///< by name
    std::vector<LinkWithBorrowedBody> links_with_borrowed_body;  ///< by name
    /// Links left out when a sensor predicts where its own beam meets the robot: its mount.
    std::vector<std::string> links_ignored_by_sensors;
    double depth_self_margin_m = 0.09;  ///< depth points this close to a capsule's surface are the robot
    double range_self_margin_m = 0.12;  ///< ranges beyond (predicted self-hit - this) are the robot
    HostRangeLimits range_limits;
    wire::BitRates bit_rates;  ///< of the CAN bus
};

}  // namespace octoskin
