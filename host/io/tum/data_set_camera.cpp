#include "host/io/tum/data_set_camera.hpp"

namespace octoskin::tum {
namespace {

/// The benchmark's cx and cy are in pixels whose centres have whole numbers, ours in those whose corners
/// have.
constexpr CameraIntrinsics intrinsics(double fx, double fy, double cx, double cy) {
    return {.width = 640, .height = 480, .fx = fx, .fy = fy, .cx = cx + 0.5, .cy = cy + 0.5};
}

}  // namespace

std::optional<CameraIntrinsics> data_set_camera(std::string_view name) {
    if (name == "kinect") return intrinsics(525.0, 525.0, 319.5, 239.5);
    if (name == "freiburg1") return intrinsics(517.3, 516.5, 318.6, 255.3);
    if (name == "freiburg2") return intrinsics(520.9, 521.0, 325.1, 249.7);
    if (name == "freiburg3") return intrinsics(535.4, 539.2, 320.1, 247.6);
    return std::nullopt;
}

}  // namespace octoskin::tum
