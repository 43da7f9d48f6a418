#include "host/lab/depth_study/noisy_camera.hpp"

#include <cmath>
#include <numbers>

namespace octoskin::depth_study {
namespace {

/// Arbitrary: the host's clock has any start.
constexpr HostTime kFirst{1'000'000'000};
constexpr double kCircleRadius_m = 0.1;
constexpr double kTurn_s = 5.0;
constexpr double kLooksAt_m = 2.0;

}  // namespace

DepthFrame NoisyCamera::frame(std::uint32_t index) const {
    const auto since_first = static_cast<std::int64_t>(std::llround(1e9 * index / camera_.rate_hz));
    return {.captured = kFirst + Nanoseconds(since_first),
            .width = camera_.width,
            .height = camera_.height,
            .depth_mm = images_.render({}, index)};
}

std::uint32_t frame_at(double t_s, double rate_hz) noexcept {
    constexpr double kRounding = 1e-9;  // 0.3 s at 10 Hz is frame 3
    return static_cast<std::uint32_t>(std::ceil(t_s * rate_hz - kRounding));
}

Eigen::Isometry3d circling(const Eigen::Isometry3d& T_base_camera, double t_s) {
    const double angle_rad = 2.0 * std::numbers::pi * t_s / kTurn_s;
    const Eigen::Vector3d p_camera(kCircleRadius_m * std::cos(angle_rad),
                                   kCircleRadius_m * std::sin(angle_rad), 0.0);
    const Eigen::Vector3d axis_camera = Eigen::Vector3d(0.0, 0.0, kLooksAt_m) - p_camera;
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis_camera);
    return T_base_camera * Eigen::Translation3d(p_camera) * turn;
}

}  // namespace octoskin::depth_study
