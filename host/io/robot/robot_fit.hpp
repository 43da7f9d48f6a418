// Fits capsules to the links of a robot whose URDF has meshes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/body_fit/fit_capsules.hpp"
#include "host/core/body_fit/surface_mesh.hpp"
#include "host/io/robot/mesh_places.hpp"
#include "hw/rigfile/link_shapes.hpp"

namespace octoskin {

/// What the body of a link is made of.
enum class BodySource : std::uint8_t {
    nothing,    ///< the link has no shape; a box of no size is none
    collision,  ///< its <collision> elements
    visual,     ///< its <visual> elements: it moves, and has no <collision>
};
[[nodiscard]] const char* name_of(BodySource source) noexcept;

inline constexpr std::size_t kDrawnTrianglesMax = 3000;

struct LinkBody {
    std::string link;
    bool is_moving = false;
    BodySource source = BodySource::nothing;
    std::string shapes = {};          ///< "2 meshes, 1 cylinder"
    std::size_t kept = 0;             ///< cylinders, spheres and capsules, which stay as they are
    std::size_t triangles = 0;        ///< of meshes and boxes
    SurfaceMesh mesh = {};            ///< some of them, at most kDrawnTrianglesMax, link frame
    std::optional<BodyFit> fit = {};  ///< to all of them; none without meshes and boxes
};

struct RobotFit {
    rig::RobotShapes shapes;
    std::vector<LinkBody> links;  ///< at or below the base link, in the order of the file
    std::string urdf;             ///< the URDF with the fits in place of meshes (hw/rigfile/fitted_urdf.hpp)
};

/// Reads each mesh in a process with limits, and fits each link. `base_link`: empty for the root. A link that
/// does not move and has no <collision> gets no body. Errors: those of read_link_shapes(); all meshes that
/// are missing or cannot be read, in one error; too_large beyond 5 m, beyond two million triangles of a link
/// or eight of the robot, or what fit_capsules() gives up; out_of_range below 5 mm. About a second for each
/// link with a mesh.
[[nodiscard]] Result<RobotFit, Error> fit_robot(const FilePlace& urdf, const std::string& base_link,
                                                const MeshSearch& search);

}  // namespace octoskin
