#include "hw/sim/experiment/rig_camera.hpp"

#include <cmath>
#include <utility>

#include "hw/sim/noise/noise.hpp"

namespace octoskin::sim {
namespace {

// Depth frames before START. They must not enter the map, so a recording contains some to test this.
constexpr int kFramesBeforeStart = 2;

}  // namespace

std::uint64_t noise_seed_of(std::uint64_t seed, std::size_t camera) noexcept {
    return camera == 0 ? seed : Noise(seed, NoiseSource::further_camera).bits(camera);
}

RigCamera::RigCamera(const CameraSurroundings& around, rig::Camera camera, const DepthNoise& noise,
                     std::uint64_t noise_seed, SimTime start)
    : around_(around), camera_(std::move(camera)), noise_(noise), noise_seed_(noise_seed), start_(start) {}

SimTime RigCamera::next() const {
    const double since_start_s = 1.0 / camera_.rate_hz * (static_cast<int>(frames_) - kFramesBeforeStart);
    return {start_.us + static_cast<std::int64_t>(std::llround(since_start_s * 1e6))};
}

rig::Camera RigCamera::placed_at(const Eigen::VectorXd& position) const {
    rig::Camera camera = camera_;
    if (!camera.link.empty())
        camera.T_link_camera = around_.arm.forward(position, camera.link) * camera.T_link_camera;
    return camera;
}

DepthCamera RigCamera::looking_at(SimTime time, const Eigen::VectorXd& position) const {
    return {around_.world_at ? around_.world_at(time) : around_.world, placed_at(position), noise_,
            noise_seed_};
}

std::vector<std::uint16_t> RigCamera::take() {
    const SimTime captured = next();
    const Eigen::VectorXd position = around_.trajectory.at(captured);
    if (!view_ || is_seeing_anew()) view_.emplace(looking_at(captured, position));
    return view_->render(around_.body.at(around_.arm.forward(position)), frames_++);
}

}  // namespace octoskin::sim
