// Removes the robot from a depth image.
#pragma once

#include <cstddef>
#include <span>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Sets to NaN each pixel whose point lies inside a capsule or within `margin_m` of its surface. Returns the
/// number of pixels removed. `body_camera`: capsules in the camera's optical frame (z forward), posed at the
/// frame's capture time. If one of them or the margin is not finite, the robot's position is unknown and all
/// pixels are removed. The image must have the camera's size (asserted). Only pixels inside a capsule's
/// bounds are tested: below 1 ms for 512 x 424.
std::size_t remove_robot(DepthImage& image, const PixelRays& pixel_rays,
                         std::span<const PosedCapsule> body_camera, double margin_m);

}  // namespace octoskin
