// Distances of a row's pixels from a capsule's axis, in single precision, several pixels at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// A capsule with its margin, in the camera's optical frame. For nearly every pixel, single precision is
/// sufficient to decide whether its point is inside.
struct RoughCapsule {
    /// `radius_m`: with the margin. All finite.
    RoughCapsule(const PosedCapsule& capsule, double radius_m);

    Eigen::Vector3f a;
    Eigen::Vector3f axis;                                  ///< from a to the other end
    Eigen::Vector3f per_length = Eigen::Vector3f::Zero();  ///< axis / |axis|^2: 1 at the other end
    float inside_m2 = 0.0F;   ///< a point with at most this squared distance to the axis is certainly inside
    float outside_m2 = 0.0F;  ///< a point with more than this is certainly outside
};

/// Arrays for the pixels of a row, with padding for one vector.
struct RowOfPixels {
    explicit RowOfPixels(std::size_t width);
    std::vector<float> x;  ///< slopes of the rays
    std::vector<float> y;
    std::vector<float> depth_m;  ///< NaN: no value
    std::vector<float> squared_m2;
};

struct RowOutcome {
    std::size_t removed = 0;  ///< pixels certainly in the capsule, set to NaN in `depth_m`
    bool is_unsure = false;   ///< other pixels have a `squared_m2` between the two bounds
};

/// Removes those of the first `count` pixels that are certainly in the capsule. Fills `squared_m2` with the
/// squared distance of each pixel's point to the axis, NaN without a value. About 0.5 ns per pixel with AVX2.
RowOutcome remove_certain(const RoughCapsule& capsule, std::size_t count, RowOfPixels& row);

}  // namespace octoskin
