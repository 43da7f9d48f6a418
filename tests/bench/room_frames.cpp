#include "tests/bench/room_frames.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "host/core/depth/pixel_rays.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::bench {
namespace {

constexpr double kSigma_m = 0.03;
constexpr double kFurthest_m = 20.0;

/// At `turn` of the way, 0 to 1: a loop in the middle of the room, looking east to the door.
Eigen::Isometry3d pose_at(double turn) {
    const double angle = 2.0 * std::numbers::pi * turn;
    const Eigen::Vector3d eye(-0.15 + 0.25 * std::cos(angle), 0.1 + 0.9 * std::sin(angle),
                              1.55 + 0.3 * std::sin(2.0 * angle));
    const Eigen::Vector3d seen(3.0, 0.1 + 0.7 * std::sin(angle), 1.0);
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d z = (seen - eye).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    T_map_camera.linear().col(0) = x;
    T_map_camera.linear().col(1) = z.cross(x);
    T_map_camera.linear().col(2) = z;
    T_map_camera.translation() = eye;
    return T_map_camera;
}

std::vector<Eigen::Vector3d> directions_of(const CameraIntrinsics& camera,
                                           const Eigen::Isometry3d& T_map_camera) {
    const PixelRays rays(camera);
    std::vector<Eigen::Vector3d> directions;
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
            const RaySlope ray = rays.at(u, v);
            directions.emplace_back(T_map_camera.linear() * Eigen::Vector3d(ray.x, ray.y, 1.0));
        }
    }
    return directions;
}

}  // namespace

Result<RoomFrames, sim::Error> render_room(const std::filesystem::path& sdf, const CameraIntrinsics& camera,
                                           unsigned count, double range_max_m) {
    const auto world = sim::World::read(sdf);
    if (!world) return unexpected(world.error());
    RoomFrames room{.camera = camera, .frames = {}};
    std::mt19937 random(1);
    std::normal_distribution<double> noise_m(0.0, kSigma_m);
    for (unsigned i = 0; i < count; ++i) {
        RoomFrame frame{.image = {.width = camera.width, .height = camera.height, .depth_m = {}},
                        .T_map_camera = pose_at(static_cast<double>(i) / count)};
        const auto directions = directions_of(camera, frame.T_map_camera);
        std::vector<double> depth_m(directions.size());
        world->cast_fan(frame.T_map_camera.translation(), directions, kFurthest_m, depth_m);
        for (std::size_t pixel = 0; pixel < depth_m.size(); ++pixel) {
            if (!std::isfinite(depth_m[pixel])) {
                ++room.without_return;
                frame.image.depth_m.push_back(std::numeric_limits<float>::quiet_NaN());
                continue;
            }
            const double measured_m = std::round(1000.0 * (depth_m[pixel] + noise_m(random))) / 1000.0;
            frame.image.depth_m.push_back(static_cast<float>(measured_m));
            room.mean_depth_m += measured_m;
            room.share_beyond += measured_m * directions[pixel].norm() > range_max_m ? 1.0 : 0.0;
        }
        room.frames.push_back(std::move(frame));
    }
    const std::size_t all = std::size_t{count} * camera.width * camera.height;
    const auto pixels = static_cast<double>(all - room.without_return);
    room.mean_depth_m /= pixels;
    room.share_beyond /= pixels;
    return room;
}

}  // namespace octoskin::bench
