// The keys of a camera, of its lens distortion, its noise and the data set with its images.
#pragma once

#include <cstdint>

#include "hw/rigfile/key.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig::keys {

namespace camera {
inline constexpr std::int64_t kSideMax_px = 4096;
inline constexpr Range<double> kFocalLength_px{1.0, 100'000.0};
inline constexpr Range<double> kDepth_m{0.0, kDepthLargest_m};
inline constexpr std::size_t kNameMax = 32;
inline constexpr TextKey kName{.path = "camera.name",
                               .kind = TextKind::folder_name,
                               .fallback = {.text = "required in `cameras`"},
                               .meaning =
                                   "only in `cameras`: a unique name of up to 32 characters, with which "
                                   "messages and files of a recording name the camera"};
inline constexpr TextKey kDevice{
    .path = "camera.device",
    .kind = TextKind::path,
    .fallback = {.text = "the first device"},
    .meaning =
        "OpenNI2 URI (`octoskin cameras`), `.oni` file, or `ros:` and the topic of its images, which another "
        "program feeds (`octoskin bridge`), for `octoskin run`; `--camera` overrides it. "
        "With several cameras, each needs one of its own"};
inline constexpr IntegerKey kWidth{.path = "camera.width_px",
                                   .unit = "px",
                                   .range = {1, kSideMax_px},
                                   .meaning =
                                       "of a live camera, width and height of one of its modes "
                                       "(`octoskin cameras`), which is then set"};
inline constexpr IntegerKey kHeight{
    .path = "camera.height_px", .unit = "px", .range = {1, kSideMax_px}, .meaning = "as above"};
inline constexpr NumberKey kFx{
    .path = "camera.fx_px", .unit = "px", .range = kFocalLength_px, .meaning = "focal length"};
inline constexpr NumberKey kFy{
    .path = "camera.fy_px", .unit = "px", .range = kFocalLength_px, .meaning = "focal length"};
inline constexpr NumberKey kCx{
    .path = "camera.cx_px",
    .unit = "px",
    .range = {0.0, kSideMax_px},
    .meaning = "principal point, at most the width; a pixel's centre is at its index plus 0.5"};
inline constexpr NumberKey kCy{.path = "camera.cy_px",
                               .unit = "px",
                               .range = {0.0, kSideMax_px},
                               .meaning = "principal point, at most the height"};
inline constexpr TableKey kDistortion{
    .path = "camera.distortion",
    .fallback = {.text = "none"},
    .meaning = "[lens distortion](#distortion), model of Brown and Conrady"};
inline constexpr NumberKey kRate{
    .path = "camera.rate_hz", .unit = "Hz", .range = {0.1, 1000.0}, .meaning = "frames a second"};
inline constexpr NumberKey kDepthMin{.path = "camera.depth_min_m",
                                     .unit = "m",
                                     .range = kDepth_m,
                                     .fallback = {kDepthMinDefault_m},
                                     .meaning = "smaller depths, along the optical axis, are no value"};
inline constexpr NumberKey kDepthMax{
    .path = "camera.depth_max_m",
    .unit = "m",
    .range = kDepth_m,
    .fallback = {kDepthMaxDefault_m},
    .meaning = "larger depths are no value; more than `depth_min_m`. Images have 16 bits, millimetres"};
inline constexpr TableKey kNoise{
    .path = "camera.noise",
    .fallback = {.text = "that of the mapping"},
    .meaning = "[the noise of its depth](#noise), which its filter follows, too"};
inline constexpr TableKey kDataSet{
    .path = "camera.data_set",
    .fallback = {.text = "as its layout has it"},
    .meaning = "of a [data set](how-to/record-and-replay.md#replay-a-public-data-set): keys below"};
inline constexpr TextKey kLink{.path = "camera.link",
                               .kind = TextKind::element_name,
                               .fallback = {.text = "the base link"},
                               .meaning =
                                   "the URDF link that carries it, at or below the base link: then each "
                                   "image has the pose of its own time"};
inline constexpr TableKey kPose{.path = "camera.pose",
                                .expected = "a [pose](#poses)",
                                .meaning =
                                    "T_link_camera of the optical frame: z forward, x right, y down. "
                                    "Images are never mirrored. `tf`: to be taken [from ROS 2](#pose-tf)"};
}  // namespace camera

/// The same values as `depth_denoiser` of a mapping.
namespace noise {
inline constexpr NumberKey kNoise{.path = "camera.noise.noise_m",
                                  .unit = "m",
                                  .range = {1e-4, 1.0},
                                  .fallback = {CameraNoise{}.noise_m},
                                  .meaning = "one standard deviation of a pixel at `noise_from_m`"};
inline constexpr NumberKey kNoisePer{.path = "camera.noise.noise_per_m",
                                     .unit = "1/m",
                                     .range = {0.0, 1.0},
                                     .fallback = {CameraNoise{}.noise_per_m},
                                     .meaning = "times the square of the distance from `noise_from_m`"};
inline constexpr NumberKey kNoiseFrom{.path = "camera.noise.noise_from_m",
                                      .unit = "m",
                                      .range = camera::kDepth_m,
                                      .fallback = {CameraNoise{}.noise_from_m},
                                      .meaning = "depth with the least noise"};
inline constexpr NumberKey kBiasPer{.path = "camera.noise.bias_per_m",
                                    .unit = "1/m",
                                    .range = {0.0, 1.0},
                                    .fallback = {CameraNoise{}.bias_per_m},
                                    .meaning =
                                        "error that no mean removes, times the square of the depth; .0015 "
                                        "for a Kinect"};
}  // namespace noise

namespace data_set {
inline constexpr NumberKey kDepthUnits{.path = "camera.data_set.depth_units_per_m",
                                       .unit = "1/m",
                                       .range = {1.0, 1e6},
                                       .fallback = {.text = "as the layout has it"},
                                       .meaning = "units per 1 m along the optical axis in its images"};
inline constexpr IntegerKey kDepthNoValue{.path = "camera.data_set.depth_no_value",
                                          .range = {0, 65'535},
                                          .fallback = {.text = "as the layout has it"},
                                          .meaning = "number of a pixel without depth"};
inline constexpr NumberKey kPoseGapMax{.path = "camera.data_set.pose_gap_max_ms",
                                       .unit = "ms",
                                       .range = {1.0, 10'000.0},
                                       .fallback = {DataSetKeys{}.pose_gap_max_ms},
                                       .meaning = "no pose between two poses farther apart than this"};
}  // namespace data_set

/// For cameras with a view of 60 degrees |k| is below 4 and |p| below 0.02; a long lens has larger values.
namespace distortion {
inline constexpr Range<double> kRadial{-1000.0, 1000.0};
inline constexpr Range<double> kTangential{-1.0, 1.0};
inline constexpr NumberKey kK1{
    .path = "camera.distortion.k1", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
inline constexpr NumberKey kK2{
    .path = "camera.distortion.k2", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
inline constexpr NumberKey kP1{
    .path = "camera.distortion.p1", .range = kTangential, .fallback = {0.0}, .meaning = "tangential"};
inline constexpr NumberKey kP2{
    .path = "camera.distortion.p2", .range = kTangential, .fallback = {0.0}, .meaning = "tangential"};
inline constexpr NumberKey kK3{
    .path = "camera.distortion.k3", .range = kRadial, .fallback = {0.0}, .meaning = "radial"};
}  // namespace distortion

}  // namespace octoskin::rig::keys
