// The surfaces of a robot's links, from the files that its URDF names.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/body_fit/surface_mesh.hpp"
#include "host/io/robot/fit_ingredients.hpp"
#include "hw/rigfile/element_fault.hpp"

namespace octoskin {

/// Reads one link after the other, and collects the faults of all. A mesh is read once for a link: all meshes
/// of a robot may not fit in memory.
class SurfaceReader {
  public:
    SurfaceReader(const FilePlace& urdf, const MeshSearch& search);

    /// The meshes and boxes that become the link's body, in the frame of `T_link_surface`; without triangles
    /// if there are none. Nullopt, with a fault, if they are too large or too small. A mesh that cannot be
    /// read is a fault, too, and left out.
    [[nodiscard]] std::optional<SurfaceMesh> read(
        const rig::ShapedLink& link, const Eigen::Isometry3d& T_link_surface = Eigen::Isometry3d::Identity());

    /// A fault of a link. `kind`: for ElementFault.
    void fail(const rig::ShapedLink& link, Error error, const std::string& kind);
    [[nodiscard]] const std::vector<rig::ElementFault>& faults() const noexcept { return faults_; }
    /// All faults in one error: meshes that are missing or cannot be read; mismatch if a mesh changed
    /// meanwhile; limit_exceeded beyond 1000 shapes of a link; too_large beyond 5 m, beyond two million
    /// triangles of a link or eight of the robot, or 300 s of reading; out_of_range below 5 mm.
    [[nodiscard]] std::optional<Error> error() const;

    /// The file of each mesh so far, by its name in the URDF.
    [[nodiscard]] const std::map<std::string, std::filesystem::path>& mesh_files() const noexcept {
        return files_;
    }
    /// The digests of all meshes so far, by their names in the URDF.
    [[nodiscard]] const std::map<std::string, std::string>& mesh_sha256() const noexcept { return sha256_; }

  private:
    [[nodiscard]] const SurfaceMesh* find(const rig::LinkShape& shape, const std::string& link);
    [[nodiscard]] Result<SurfaceMesh, Error> read_mesh(const rig::LinkShape& shape);
    [[nodiscard]] Result<SurfaceMesh, Error> append_all(const rig::ShapedLink& link,
                                                        const Eigen::Isometry3d& T_link_surface);

    std::filesystem::path urdf_;
    MeshPlaces places_;
    std::map<std::string, std::optional<SurfaceMesh>> meshes_;  ///< of the link, and all that failed
    std::map<std::string, std::string> sha256_;
    std::map<std::string, std::filesystem::path> files_;
    std::map<std::filesystem::path, Error> unreadable_;  ///< by file: it may have several names
    std::size_t triangles_ = 0;                          ///< of all links so far
    Nanoseconds reading_{0};                             ///< time of reading all meshes so far
    std::vector<rig::ElementFault> faults_;
};

/// A link's surface, link frame.
struct LinkSurface {
    std::string link;
    SurfaceMesh mesh;
};

/// The true body of a robot that is fitted: what the fit is an approximation of.
struct RobotSurfaces {
    std::vector<LinkSurface> meshes;  ///< meshes and boxes, of each link that has some
    std::string urdf;                 ///< the rest: the URDF without them
};

/// Errors: those of SurfaceReader.
[[nodiscard]] Result<RobotSurfaces, Error> read_surfaces(const RobotText& robot, const MeshSearch& search);

}  // namespace octoskin
