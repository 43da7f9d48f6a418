#include "host/io/tum/data_set_camera.hpp"

#include <cmath>
#include <vector>

#include "host/io/tum/data_set_lines.hpp"
#include "host/io/tum/depth_png.hpp"
#include "host/io/tum/line_file.hpp"

namespace octoskin::tum {
namespace {

/// In these calibrations whole numbers are the centres of pixels; in octoskin they are the corners.
constexpr CameraIntrinsics intrinsics(double fx, double fy, double cx, double cy) {
    return {.width = 640, .height = 480, .fx = fx, .fy = fy, .cx = cx + 0.5, .cy = cy + 0.5};
}

/// The fault of a calibration's numbers; empty if a camera can have them.
const char* fault_of(const CameraIntrinsics& camera) {
    const auto is_focal = [](double pixels) { return pixels >= 1.0 && pixels <= 100'000.0; };
    if (!is_focal(camera.fx) || !is_focal(camera.fy)) return "focal lengths must be from 1 to 100000 pixels";
    const bool is_within =
        camera.cx >= 0.0 && camera.cx <= camera.width && camera.cy >= 0.0 && camera.cy <= camera.height;
    return is_within ? nullptr : "the principal point is outside the first image";
}

}  // namespace

std::optional<CameraIntrinsics> data_set_camera(std::string_view name) {
    // https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats "Intrinsic Camera Calibration of the
    // Kinect"
    if (name == "kinect") return intrinsics(525.0, 525.0, 319.5, 239.5);
    if (name == "freiburg1") return intrinsics(517.3, 516.5, 318.6, 255.3);
    if (name == "freiburg2") return intrinsics(520.9, 521.0, 325.1, 249.7);
    if (name == "freiburg3") return intrinsics(535.4, 539.2, 320.1, 247.6);
    // https://www.doc.ic.ac.uk/~ahanda/VaFRIC/codes.html; its fy is -480 because its y axis points up.
    if (name == "icl_nuim") return intrinsics(481.2, 480.0, 319.5, 239.5);
    // https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes: it names 320, 240 as the image
    // centre.
    if (name == "seven_scenes") return intrinsics(585.0, 585.0, 319.5, 239.5);
    return std::nullopt;
}

Result<CameraIntrinsics, Error> calibrated_camera(const FilePlace& calibration, const FilePlace& image) {
    constexpr std::size_t kRow = 4;
    constexpr std::size_t kMatrix = 9;
    const std::filesystem::path file = calibration.shown();
    const auto text = read_small_file(calibration);
    if (!text) return unexpected(text.error());
    const auto numbers = parse_numbers(*text, kMatrix);
    if (!numbers) return unexpected(in_file({ErrorCode::bad_syntax, numbers.error()}, file));
    if (numbers->size() != kRow && numbers->size() != kMatrix) {
        return unexpected(in_file({ErrorCode::bad_syntax, "expected fx fy cx cy, or a 3 x 3 matrix",
                                   std::to_string(numbers->size()) + " numbers"},
                                  file));
    }
    const auto first = read_depth_png(image);
    if (!first) return unexpected(in_file({ErrorCode::bad_syntax, first.error()}, image.shown()));
    const std::vector<double>& n = *numbers;
    CameraIntrinsics camera =
        n.size() == kRow ? intrinsics(n[0], n[1], n[2], n[3]) : intrinsics(n[0], n[4], n[2], n[5]);
    camera.width = first->width;
    camera.height = first->height;
    if (const char* const fault = fault_of(camera))
        return unexpected(in_file({ErrorCode::out_of_range, fault}, file));
    return camera;
}

}  // namespace octoskin::tum
