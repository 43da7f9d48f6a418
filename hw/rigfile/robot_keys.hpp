// The keys of the robot, of its attached capsules and of a pose.
#pragma once

#include "hw/rigfile/key.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig::keys {

/// Greatest distance of a part of the rig from its base, per coordinate.
inline constexpr double kRoomReach_m = 100.0;
inline constexpr Range<double> kSelfMargin_m{0.0, 1.0};
inline constexpr Range<double> kPadding_m{0.0, 0.5};

namespace robot {
inline constexpr TextKey kUrdf{.path = "robot.urdf",
                               .kind = TextKind::path,
                               .meaning = "the robot's URDF: links, joints, collision bodies"};
inline constexpr TextKey kBaseLink{
    .path = "robot.base_link",
    .kind = TextKind::element_name,
    .meaning = "frame of `T_map_base` and the camera's pose; only links at or below it count"};
inline constexpr NumberKey kLinkPadding{
    .path = "robot.link_padding_m{}",
    .unit = "m",
    .range = kPadding_m,
    .fallback = {.text = "none"},
    .meaning = "by the name of a link: added to the radius of that link's capsules"};
inline constexpr FlagKey kFitsCapsules{.path = "robot.fits_capsules",
                                       .fallback = {false},
                                       .meaning =
                                           "a `<collision>` box becomes the capsule along its longest side, "
                                           "through its corners; else it is refused"};
inline constexpr ListKey kAttachedCapsules{
    .path = "robot.attached_capsules",
    .items = "capsules",
    .count = {0, 64},
    .fallback = {.text = "none"},
    .meaning = "[attached bodies](#attached-capsules): tool, grasped object, cable"};
inline constexpr ListKey kLinksWithoutBody{
    .path = "robot.links_without_body",
    .items = "links",
    .fallback = {.text = "none"},
    .meaning =
        "[links without a body](#links-without-a-body) on purpose; no name twice, none with a body "
        "that counts"};
inline constexpr ListKey kLinksIgnoredBySensors{
    .path = "robot.links_ignored_by_sensors",
    .items = "links",
    .fallback = {.text = "none"},
    .meaning = "links left out when the host predicts where a beam meets the robot: the sensor's mount"};
inline constexpr NumberKey kDepthSelfMargin{
    .path = "robot.depth_self_margin_m",
    .unit = "m",
    .range = kSelfMargin_m,
    .fallback = {kDepthSelfMarginDefault_m},
    .meaning = "depth points this close to a capsule's surface, or inside it, are the robot"};
inline constexpr NumberKey kRangeSelfMargin{
    .path = "robot.range_self_margin_m",
    .unit = "m",
    .range = kSelfMargin_m,
    .fallback = {kRangeSelfMarginDefault_m},
    .meaning = "a range is dropped if it exceeds the predicted distance to the robot minus this margin"};
}  // namespace robot

namespace capsule {
/// A larger coordinate is probably in millimetres.
inline constexpr Range<double> kReach_m{-2.0, 2.0};
inline constexpr TextKey kName{.path = "robot.attached_capsules[].name", .meaning = "unique"};
inline constexpr TextKey kLink{
    .path = "robot.attached_capsules[].link",
    .kind = TextKind::element_name,
    .meaning =
        "link that carries it, at or below `base_link`; if sensors ignore that link, they ignore this "
        "too"};
inline constexpr NumbersKey kFrom{.path = "robot.attached_capsules[].from_m",
                                  .unit = "m",
                                  .range = kReach_m,
                                  .meaning = "one end of its axis in the link's frame"};
inline constexpr NumbersKey kTo{.path = "robot.attached_capsules[].to_m",
                                .unit = "m",
                                .range = kReach_m,
                                .fallback = {.text = "`from_m`"},
                                .meaning = "the other end; without it the capsule is a ball"};
inline constexpr NumberKey kRadius{.path = "robot.attached_capsules[].radius_m",
                                   .unit = "m",
                                   .range = {0.001, 1.0},
                                   .meaning = "its radius"};
inline constexpr NumberKey kPadding{
    .path = "robot.attached_capsules[].padding_m",
    .unit = "m",
    .range = kPadding_m,
    .fallback = {0.0},
    .meaning = "added by the host, as is the link's padding; the simulator uses the real radius"};
}  // namespace capsule

/// Of `T_map_base`, `camera.pose` and `nodes[].sensors[].pose`.
namespace pose {
/// Of a sensor's position in its link. A larger coordinate is probably in millimetres.
inline constexpr double kSensorReach_m = 2.0;
inline constexpr double kQuaternionTolerance = 1e-6;
inline constexpr double kMatrixTolerance = 1e-9;
inline constexpr NumbersKey kPosition{.path = "pose.xyz_m",
                                      .unit = "m",
                                      .range = {-kRoomReach_m, kRoomReach_m},
                                      .meaning = "`[x, y, z]`; of a sensor from -2 to 2"};
inline constexpr NumbersKey kRollPitchYaw{
    .path = "pose.rpy_deg",
    .unit = "deg",
    .range = {-360.0, 360.0},
    .fallback = {.text = "one of these four"},
    .meaning = "`[roll, pitch, yaw]` about the parent's fixed x, then y, then z, as in URDF"};
inline constexpr NumbersKey kQuaternion{.path = "pose.quaternion_wxyz",
                                        .count = 4,
                                        .range = {-2.0, 2.0},
                                        .fallback = {.text = "one of these four"},
                                        .meaning = "of length 1 within 1e-6"};
inline constexpr TableKey kRotationRows{
    .path = "pose.rotation_rows",
    .expected = "3 rows of 3 numbers",
    .fallback = {.text = "one of these four"},
    .meaning = "the rotation matrix, orthonormal within 1e-9. Exact to the last bit; recordings use it"};
inline constexpr NumbersKey kLookingAt{
    .path = "pose.looking_at_m",
    .unit = "m",
    .range = {-kRoomReach_m, kRoomReach_m},
    .fallback = {.text = "one of these four"},
    .meaning =
        "cameras only: a point on the optical axis; the picture is upright (+z of the base, or of its link, "
        "is up)"};
}  // namespace pose

}  // namespace octoskin::rig::keys
