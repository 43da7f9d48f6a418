// The robot's true body for ray-casting: capsules and meshes of its links.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/mesh/triangle_mesh.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/world/ray_caster.hpp"

namespace octoskin::sim {

/// All points within `radius_m` of the segment from p_base_a to p_base_b.
struct BodyCapsule {
    Eigen::Vector3d p_base_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// Where a ray enters a capsule, in lengths of `direction` (any length but 0): 0 if the origin is inside,
/// empty if it misses or the capsule lies behind. Solved in closed form.
[[nodiscard]] std::optional<double> cast_capsule(const BodyCapsule& capsule, const Eigen::Vector3d& origin,
                                                 const Eigen::Vector3d& direction);

/// The outward unit normal of a capsule at a point of its surface.
[[nodiscard]] Eigen::Vector3d outward_normal(const BodyCapsule& capsule, const Eigen::Vector3d& p_base);

/// The nearest of cast_capsule() over a body.
[[nodiscard]] std::optional<double> cast_body(const std::vector<BodyCapsule>& body,
                                              const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction);

/// A link's surface of triangles, link frame.
struct LinkMesh {
    std::string link;
    TriangleMesh mesh;
};

/// A link's mesh, prepared for rays. Copies share it.
class MeshBody {
  public:
    explicit MeshBody(const LinkMesh& surface);

    [[nodiscard]] const std::string& link() const noexcept { return link_; }
    /// A ball around the mesh, link frame.
    [[nodiscard]] const Eigen::Vector3d& p_link_middle() const noexcept { return p_link_middle_; }
    [[nodiscard]] double radius_m() const noexcept { return radius_m_; }
    [[nodiscard]] const RayCaster& rays() const noexcept { return *rays_; }

  private:
    std::string link_;
    Eigen::Vector3d p_link_middle_ = Eigen::Vector3d::Zero();
    double radius_m_ = 0.0;
    std::shared_ptr<const RayCaster> rays_;
};

/// A mesh at one pose in the frame of the rays. A ray from inside meets the surface where it leaves.
struct PosedMesh {
    const MeshBody* mesh = nullptr;
    Eigen::Isometry3d T_frame_link = Eigen::Isometry3d::Identity();

    [[nodiscard]] Eigen::Vector3d p_middle() const { return T_frame_link * mesh->p_link_middle(); }
    /// As RayCaster::cast_fan(): hits with t up to `t_max`, and infinity where there is none. Normals are in
    /// the frame of the rays.
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                  std::span<TriangleHit> hits) const;
};

/// A body at one instant, base frame. Valid as long as the Body.
struct PosedBody {
    std::vector<BodyCapsule> capsules = {};
    std::vector<PosedMesh> meshes = {};

    PosedBody() = default;
    PosedBody(std::vector<BodyCapsule> only_capsules) : capsules(std::move(only_capsules)) {}
    /// The nearest surface, as cast_capsule() for the capsules, within `t_max`.
    [[nodiscard]] std::optional<double> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                             double t_max) const;
};

class Body {
  public:
    explicit Body(std::vector<rig::Capsule> capsules, const std::vector<LinkMesh>& meshes = {});

    /// The capsules and meshes at the links' poses. Leaves out links in `ignored` and links that the arm does
    /// not have.
    [[nodiscard]] PosedBody at(const Arm::LinkPoses& poses,
                               const std::vector<std::string>& ignored = {}) const;

  private:
    std::vector<rig::Capsule> capsules_;
    std::vector<MeshBody> meshes_;
};

/// The capsules alone.
[[nodiscard]] std::vector<BodyCapsule> posed_body(const std::vector<rig::Capsule>& capsules,
                                                  const Arm::LinkPoses& poses,
                                                  const std::vector<std::string>& ignored = {});

}  // namespace octoskin::sim
