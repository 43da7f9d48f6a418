// Takes the robot out of a depth image.
#pragma once

#include <cstddef>
#include <span>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Sets to NaN every pixel whose point lies within `margin_m` of a capsule's surface or inside it, and
/// returns how many. `body_camera`: capsules in the camera's optical frame (z forward), posed at the frame's
/// capture time. If any of them, or the margin, is not finite, every pixel goes: nobody knows where the robot
/// is. The image must be of the camera's size (asserted). Only pixels inside a capsule's bounds are
/// looked at: below 1 ms for 512 x 424.
std::size_t remove_robot(DepthImage& image, const PixelRays& pixel_rays,
                         std::span<const PosedCapsule> body_camera, double margin_m);

}  // namespace octoskin
