// Fits capsules to the links of a robot whose URDF has meshes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/body_fit/fit_capsules.hpp"
#include "host/core/body_fit/surface_mesh.hpp"
#include "host/io/robot/body_shapes.hpp"
#include "host/io/robot/fit_ingredients.hpp"

namespace octoskin {

inline constexpr std::size_t kDrawnTrianglesMax = 3000;

struct LinkBody {
    std::string link;
    bool is_moving = false;
    BodySource source = BodySource::nothing;
    std::string shapes = {};              ///< "2 meshes, 1 cylinder"
    std::size_t kept = 0;                 ///< cylinders, spheres and capsules, which stay as they are
    std::vector<std::string> files = {};  ///< the meshes, each once
    std::size_t triangles = 0;            ///< of meshes and boxes
    SurfaceMesh mesh = {};                ///< some of them, at most kDrawnTrianglesMax, link frame
    std::optional<BodyFit> fit = {};      ///< to all of them; none without meshes and boxes
};

struct RobotFit {
    rig::RobotShapes shapes;
    std::vector<LinkBody> links;  ///< at or below the base link, in the order of the file
    std::string urdf;             ///< the URDF with the fits in place of meshes (hw/rigfile/fitted_urdf.hpp)
    FitIngredients made_of;       ///< the files as they were when they were fitted
};

/// Called before each link that has something to fit.
using OnLinkFit = std::function<void(const std::string& link)>;

/// Reads each mesh in a process with limits, and fits each link. A link that does not move and has no
/// <collision> gets no body. Errors: those of SurfaceReader; too_large for a link that fit_capsules() gives
/// up, and for a robot of more work than twenty such links; what a rig would refuse of the result. About a
/// second for each link with a mesh.
[[nodiscard]] Result<RobotFit, Error> fit_robot(const RobotText& robot, const MeshSearch& search,
                                                const OnLinkFit& on_link = {});

}  // namespace octoskin
