// Everything that the fit of a robot follows from.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/io/robot/mesh_places.hpp"
#include "hw/rigfile/link_shapes.hpp"

namespace octoskin {

/// A URDF as it was when it was read.
struct RobotText {
    FilePlace file;
    std::string text;
    rig::RobotShapes shapes;  ///< in `text`
};

/// `base_link`: empty for the root. Errors: those of read_link_shapes().
[[nodiscard]] Result<RobotText, Error> read_robot_text(const FilePlace& urdf, const std::string& base_link);

/// Whether a <collision> at or below the base link is a mesh, which is no body without a fit.
[[nodiscard]] bool needs_fit(const rig::RobotShapes& shapes);

struct FitIngredients {
    std::string base_link;
    std::string urdf;                                ///< its text
    std::map<std::string, std::string> mesh_sha256;  ///< by the mesh's name in the URDF

    /// The name of the fit that `program`, with its version, makes of these: 64 hexadecimal digits, a
    /// SHA-256 of all of them.
    [[nodiscard]] std::string key(std::string_view program) const;
};

/// Reads the files of the meshes that fit_robot() would read, without reading triangles: 4 ms a megabyte.
/// Errors: all that are missing or cannot be read, in one error.
[[nodiscard]] Result<FitIngredients, Error> find_ingredients(const RobotText& robot,
                                                             const MeshSearch& search);

}  // namespace octoskin
