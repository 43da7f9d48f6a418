// The geometry of a picture: painted faces, triangles and rods.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "host/lab/report/colour.hpp"

namespace octoskin::report {

/// A face of a voxel, drawn with its edges. Corners in order around it, anticlockwise from outside.
struct Face {
    std::array<Eigen::Vector3f, 4> corners;
    Colour colour;
};

struct Triangle {
    std::array<Eigen::Vector3f, 3> corners;
    Colour colour;
};

/// All points within `radius_m` of the segment from `a` to `b`.
struct Rod {
    Eigen::Vector3f a;
    Eigen::Vector3f b;
    float radius_m;
    Colour colour;
};

struct Geometry {
    std::vector<Face> faces;
    std::vector<Triangle> triangles;
    std::vector<Rod> bodies;  ///< shaded, and casting shadows
    std::vector<Rod> lines;   ///< drawn in their plain colour, casting none
    /// Triangles are drawn within it only (a floor may reach to the horizon). Empty: everywhere.
    std::optional<Eigen::AlignedBox3f> stage;
};

}  // namespace octoskin::report
