// The rig as a value: boards, sensors, robot and cameras. Only read_rig() reads it from a file.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/lens/lens_distortion.hpp"
#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::rig {

/// The optics of a sensor that sees a cone. In degrees as written, so that the canonical text reads back bit
/// for bit.
struct Cone {
    std::uint8_t sub_rays = 16;    ///< across the cone, for the simulator: their grid's side
    double half_angle_deg = 13.5;  ///< from the axis to the edge
    double sigma_deg = 7.0;  ///< standard deviation of the Gaussian fall-off of the signal from the axis
    double blur_deg = 2.5;   ///< standard deviation of the lens's blur, which widens a zone's view
    friend bool operator==(const Cone&, const Cone&) = default;
};

/// A sensor of a node: its extrinsics and the data that the host needs to use its ranges.
struct Sensor {
    std::string name;
    std::string link;                                                 ///< URDF link that carries it
    Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();  ///< ranges run along the sensor's +z
    std::vector<double> zone_offset_m = {0.0};                        ///< added to a valid range, per zone
    std::optional<Cone> cone;  ///< none: one ideal ray along the middle of each zone
};

/// Limits of a type of board, for the check of a rig.
struct Board {
    std::string name;
    std::uint8_t board_type = 0;  ///< the number that NODE_INFO reports
    std::uint8_t i2c_bus_count = 0;
    std::uint8_t xshut_line_count = 0;
    std::uint8_t sensors_max = 0;
    std::uint8_t sensors_per_bus_max = 0;
    bool supports_can_fd = false;
    bool has_data_ready_lines = false;  ///< one input per I2C bus
};

struct Node {
    std::string name;
    Board board;
    NodeConfig config;  ///< complete, with sensors: the content of the configuration block
    std::optional<std::uint32_t> pinned_build_id;
    std::vector<Sensor> sensors;  ///< in the order of the local index
};

/// How the joint states of a source reach the host.
enum class JointWay : std::uint8_t { can, socket };

/// A sender of joint states.
struct JointSource {
    std::uint8_t node_id = 0;         ///< of the node that sends them
    std::vector<std::string> joints;  ///< URDF joint names in the order on the wire, 1..7
    double rate_hz = 100.0;
    JointWay way = JointWay::can;  ///< `socket`: they do not load the bus
};

inline constexpr std::size_t kCamerasMax = 8;
/// Of all cameras together: each pixel takes memory for its history.
inline constexpr std::uint64_t kCameraPixelsMax = std::uint64_t{4096} * 4096;
/// Depth images are in millimetres of 16 bits.
inline constexpr double kDepthLargest_m = 65.5;
inline constexpr double kDepthMinDefault_m = 0.5;
inline constexpr double kDepthMaxDefault_m = 4.5;

/// The noise of a camera's depth, as in a mapping file (`depth_denoiser`): one standard deviation is
/// `noise_m` + `noise_per_m` * (depth - `noise_from_m`)^2; what no mean removes is `bias_per_m` * depth^2.
struct CameraNoise {
    double noise_m = 0.03;
    double noise_per_m = 0.0;
    double noise_from_m = 0.4;
    double bias_per_m = 0.0;
};

struct Camera {
    std::string name = {};  ///< unique; empty: the only camera, given as `camera`
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
    LensDistortion lens = {};  ///< checked on load: every pixel has one ray
    double rate_hz = 0.0;
    double depth_min_m = kDepthMinDefault_m;
    double depth_max_m = kDepthMaxDefault_m;
    std::string link = {};  ///< that carries it; empty: the base link
    Eigen::Isometry3d T_link_camera =
        Eigen::Isometry3d::Identity();      ///< optical frame: z forward, x right, y down
    std::string device = {};                ///< OpenNI2 URI, .oni file or "ros:/TOPIC"; empty: not given
    std::optional<CameraNoise> noise = {};  ///< empty: that of the mapping
    DataSetKeys data_set = {};
};

/// A piece of the robot's body that its URDF does not have: a tool, a grasped object, a stretch of cable. All
/// points within `radius_m` of the segment from p_link_a to p_link_b (equal ends: a sphere).
struct AttachedCapsule {
    std::string name;
    std::string link;  ///< that carries it
    Eigen::Vector3d p_link_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_link_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    double padding_m =
        0.0;  ///< added to the radius in addition to the link's padding, such as for a cable that swings
};

struct Bus {
    std::uint32_t nominal_bitrate = 1'000'000;
    bool uses_can_fd = true;
    std::uint32_t data_bitrate = 5'000'000;
};

/// Limits for every range; the acceptance check rejects others.
struct RangeLimits {
    double min_m = 0.04;
    double max_m = 4.0;
    double sigma_max_m = 0.2;
    double time_uncertainty_max_ms =
        5.0;  ///< of a capture time: the sum of the clock map's bound and the node's
};

inline constexpr double kDepthSelfMarginDefault_m = 0.09;
inline constexpr double kRangeSelfMarginDefault_m = 0.12;

struct Rig {
    std::vector<FilePlace> extended_files;  ///< the files that its file extends, the nearest first
    std::string name;
    FilePlace urdf;  ///< absolute, or below the folder of a recording; holds the text that was read
    std::string base_link;
    Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
    std::map<std::string, double> link_padding_m;  ///< added to the capsules of a link
    bool fits_capsules = false;                    ///< a box of the URDF is replaced by the capsule around it
    std::vector<AttachedCapsule> attached_capsules;
    /// Links without a body on purpose: answers about the robot do not include them.
    std::vector<std::string> links_without_body;
    /// Links ignored when the host predicts where a sensor's beam meets the robot (the sensor's own mount).
    std::vector<std::string> links_ignored_by_sensors;
    /// Depth points this close to a capsule's surface are the robot.
    double depth_self_margin_m = kDepthSelfMarginDefault_m;
    /// Ranges beyond (predicted self-hit - this) are the robot.
    double range_self_margin_m = kRangeSelfMarginDefault_m;
    Bus bus;
    std::vector<Node> nodes;
    std::vector<JointSource> joint_sources;  ///< 1..32; each moving joint is in one of them
    std::vector<Camera> cameras;             ///< at most kCamerasMax
    RangeLimits range_limits;

    /// The joints of all sources, in their order: the order of all joint vectors.
    [[nodiscard]] std::vector<std::string> joint_names() const {
        std::vector<std::string> names;
        for (const JointSource& source : joint_sources)
            names.insert(names.end(), source.joints.begin(), source.joints.end());
        return names;
    }
    /// The cameras beside the robot: those that are not on a link.
    [[nodiscard]] std::vector<Camera> external_cameras() const {
        std::vector<Camera> external;
        for (const Camera& camera : cameras)
            if (camera.link.empty()) external.push_back(camera);
        return external;
    }
    /// The number of joints of each source.
    [[nodiscard]] std::vector<std::size_t> joint_counts() const {
        std::vector<std::size_t> counts;
        for (const JointSource& source : joint_sources) counts.push_back(source.joints.size());
        return counts;
    }
};

/// Reads and checks a rig: unknown keys, types, units, ranges, references, unique ids and addresses, I2C
/// capacity, and the computed CAN load (refused above 70 %). Paths in it are relative to the file. A
/// top-level `extends: other.yaml` reads that file first and overrides it with this file's keys.
/// `urdf_instead`: a robot to use in place of the one the rig names. A rig below a named folder, or in a
/// recording however it was named (confined_to_recording()), may refer only to files of that folder, without
/// links. Not to be called from two threads at once (urdfdom's log is global).
[[nodiscard]] Result<Rig, Error> read_rig(const FilePlace& file,
                                          const std::filesystem::path& urdf_instead = {});

/// The canonical YAML text of a rig: reading it gives an equal rig, and equal rigs give equal text. `urdf` is
/// written as given.
[[nodiscard]] std::string canonical_text(const Rig& rig, const std::string& urdf);
/// The rig without the devices of its cameras, which are of one machine.
[[nodiscard]] Rig without_devices(Rig rig);
/// CRC-32 of the canonical text without the path of the URDF and the devices of cameras.
[[nodiscard]] std::uint32_t rig_hash(const Rig& rig);
/// CRC-32 of everything that determines where a measurement lies in the map: the robot's base, its joints,
/// poses and optics of sensors and cameras, and `robot`, the text of its URDF.
[[nodiscard]] std::uint32_t placement_crc32(const Rig& rig, std::string_view robot);

}  // namespace octoskin::rig
