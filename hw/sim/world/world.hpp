// The simulated world: the solids of an SDF file, ray-cast with Embree, and as surfaces and interiors for the
// ground truth. All coordinates in the world frame, which is the robot's base frame; metres. A ray should
// begin within about 100 m of the origin: the triangle is found in single precision, and geometry beyond 500
// m along an axis is not seen.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

struct RayHit {
    double range_m = 0.0;
    std::uint32_t solid = 0;                           ///< index into `solids()`
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, out of the solid
};

class World {
  public:
    /// Reads the visuals of an SDF file; see read_solids() for shapes, errors, limits and the files it may
    /// refer to.
    [[nodiscard]] static Result<World, Error> read(const FilePlace& sdf);
    explicit World(std::vector<Solid> solids, std::vector<std::string> warnings = {});
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;
    ~World();

    /// The nearest surface along a ray within `range_max_m`. Direction: unit vector. < 1 us for the shipped
    /// worlds. Safe from several threads at once.
    [[nodiscard]] std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                             double range_max_m) const;
    /// Many rays from one origin, for images: `t[i]` is the nearest surface's distance in lengths of
    /// `directions[i]` (any length: with z = 1 in camera coordinates it is the depth), infinity beyond
    /// `t_max`.
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                  std::span<double> t) const;
    /// The same with the whole hit, for unit vectors; range_m is infinity where nothing is hit.
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                  double range_max_m, std::span<RayHit> hits) const;
    [[nodiscard]] const std::vector<Solid>& solids() const noexcept;
    /// Its SDF with its includes expanded; empty if it includes nothing.
    [[nodiscard]] const std::string& written_out() const noexcept;
    /// The uris of its meshes, as in written_out(), or else as in its file.
    [[nodiscard]] const std::vector<std::string>& meshes() const noexcept;
    /// Elements skipped when it was read, each with the file's name.
    [[nodiscard]] const std::vector<std::string>& warnings() const noexcept;

    /// Calls `visit(point, solid index)` for points of the surface of all solids together, no two neighbours
    /// further apart than `pitch_m`. Points of a solid that are inside or touch another solid are left out:
    /// no sensor can see them. With `region`, only points within it. About 0.3 us a point.
    void sample_surfaces(double pitch_m,
                         const std::function<void(const Eigen::Vector3d&, std::uint32_t)>& visit) const;
    void sample_surfaces(double pitch_m, const Eigen::AlignedBox3d& region,
                         const std::function<void(const Eigen::Vector3d&, std::uint32_t)>& visit) const;
    /// About how many points sample_surfaces() examines, including those that it leaves out. About 0.5 us a
    /// triangle.
    [[nodiscard]] double samples_within(double pitch_m, const Eigen::AlignedBox3d& region) const;
    /// True if a point lies inside a closed solid. About 0.2 us outside all solids' bounding boxes, 1 us
    /// within.
    [[nodiscard]] bool is_inside(const Eigen::Vector3d& point) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octoskin::sim
