// Ray-cast pictures of a map and of the scene: Fig. 1 of the report.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/report/image.hpp"
#include "host/lab/report/view.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::report {

/// From the robot's side and from the camera's.
struct ImagePair {
    Image front;
    Image back;
};

/// Class of a voxel of a map by the ground truth.
enum class VoxelKind : std::uint8_t {
    right,          ///< a surface passes through it (or it is interior to a solid)
    hidden_object,  ///< a surface of a hidden object passes through it
    wrong,          ///< no surface is there
    lost,           ///< a surface voxel that is free in the map, drawn as a frame
    floor,          ///< outside the judged region, drawn subdued
};
struct PaintedVoxel {
    VoxelKey key;
    VoxelKind kind = VoxelKind::right;
};

/// The map's occupied voxels in the judged region and in the layers down to the floor's, and the lost ones,
/// classified by the analytic surfaces.
[[nodiscard]] std::vector<PaintedVoxel> paint_map(const FusedMap& map, const evaluation::Truth& truth);
/// The analytic surface voxels: the picture of a perfect map.
[[nodiscard]] std::vector<PaintedVoxel> paint_truth(const evaluation::Truth& truth);

/// Bounding box of several lists of voxels without the floor, map frame. Empty if there is no voxel.
[[nodiscard]] Eigen::AlignedBox3d content_of(std::span<const std::vector<PaintedVoxel>> lists,
                                             double resolution_m);

/// Voxel cubes, map frame. Deterministic. About 2 s on two cores for both pictures.
[[nodiscard]] ImagePair render_voxels(std::span<const PaintedVoxel> voxels, double resolution_m,
                                      const ViewPair& views);

/// A body of the posed robot: all points within `radius_m` of a segment. Base frame.
struct PosedCapsule {
    Eigen::Vector3d p_base_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};
/// One ranging of a sensor, to be drawn as a thin line.
struct Segment {
    Eigen::Vector3d p_base_from = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_to = Eigen::Vector3d::Zero();
};

/// Content of the scene picture besides the world.
struct SceneDressing {
    /// Base frame. Floors and beams are clipped to this box.
    Eigen::AlignedBox3d stage;
    std::vector<PosedCapsule> robot;
    std::vector<rig::Camera> cameras;  ///< each drawn with the edges of its view
    std::vector<Segment> beams;
    std::vector<std::string> hidden_models;  ///< coloured as `VoxelKind::hidden_object`
    PictureSize size;
};

/// The world in the base frame, from the front and from behind the cameras. About 3 s of CPU time.
[[nodiscard]] ImagePair render_scene(const sim::World& world, const SceneDressing& dressing);

}  // namespace octoskin::report
