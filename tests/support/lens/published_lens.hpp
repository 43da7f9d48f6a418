// The lens model of OpenCV's manual, and cameras with a published calibration: an oracle that shares no code
// with common/lens.
#pragma once

#include <array>

namespace octoskin::testing_support {

struct PublishedCamera {
    const char* name;
    double fx, fy, cx, cy;             ///< pixel centres have whole numbers, as OpenCV has them
    std::array<double, 5> distortion;  ///< k1 k2 p1 p2 k3
};

/// 640 x 480 pixels. Source: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats "Intrinsic Camera
/// Calibration of the Kinect"; the last is freiburg2's infrared camera, whose polynomial is not monotonic
/// within the picture.
inline constexpr std::array<PublishedCamera, 6> kTumCameras{
    {{"freiburg1 colour", 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}},
     {"freiburg2 colour", 520.9, 521.0, 325.1, 249.7, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}},
     {"freiburg3 colour", 535.4, 539.2, 320.1, 247.6, {0.0, 0.0, 0.0, 0.0, 0.0}},
     {"freiburg1 infrared", 591.1, 590.1, 331.0, 234.0, {-0.0410, 0.3286, 0.0087, 0.0051, -0.5643}},
     {"freiburg3 infrared", 567.6, 570.2, 324.7, 250.1, {0.0, 0.0, 0.0, 0.0, 0.0}},
     {"freiburg2 infrared", 580.8, 581.8, 308.8, 253.0, {-0.2297, 1.4766, 0.0005, -0.0075, -3.4194}}}};

/// All but the last, which has no inverse for every pixel.
inline constexpr std::size_t kInvertibleTumCameras = 5;

/// The projection of the point (x, y, 1) by OpenCV's projectPoints: u, v in pixels. Source:
/// https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html
[[nodiscard]] std::array<double, 2> project(const PublishedCamera& camera, double x, double y);

/// The point (x, y, 1) that OpenCV's undistortPoints finds for u, v: its fixed-point iteration, 200 rounds.
[[nodiscard]] std::array<double, 2> unproject(const PublishedCamera& camera, double u, double v);

}  // namespace octoskin::testing_support
