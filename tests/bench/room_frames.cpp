#include "tests/bench/room_frames.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "common/lens/lens_distortion.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "host/io/tum/data_set_reader.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::bench {
namespace {

constexpr double kSigma_m = 0.03;
constexpr double kFurthest_m = 20.0;
/// Of the way: what is seen here is as far as on the whole way in the mean.
constexpr double kStationaryAt = 0.3;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
const Eigen::Translation3d kOnTheTable(0.6, 0.4, 0.76);
const Eigen::AlignedBox3d kAsked(Eigen::Vector3d(-0.5, -2.6, 0.0), Eigen::Vector3d(3.2, 2.6, 2.6));

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
    std::vector<Eigen::Vector3d> directions;
    for_each_pixel_ray(camera, [&](std::uint32_t, std::uint32_t, const RaySlope& ray) {
        directions.emplace_back(T_map_camera.linear() * Eigen::Vector3d(ray.x, ray.y, 1.0));
    });
    return directions;
}

/// Works out what the images have in them, and the box of all ends.
Eigen::AlignedBox3d summarize(RoomFrames& room, double range_max_m) {
    Eigen::AlignedBox3d ends;
    std::size_t pixels = 0;
    for (const RoomFrame& frame : room.frames) {
        const auto directions = directions_of(room.camera, frame.T_map_camera);
        for (std::size_t pixel = 0; pixel < directions.size(); ++pixel) {
            const double depth_m = static_cast<double>(frame.image.depth_m[pixel]);
            if (!std::isfinite(depth_m)) {
                ++room.without_return;
                continue;
            }
            ++pixels;
            room.mean_depth_m += depth_m;
            room.share_beyond += depth_m * directions[pixel].norm() > range_max_m ? 1.0 : 0.0;
            ends.extend(frame.T_map_camera.translation() + depth_m * directions[pixel]);
        }
    }
    room.mean_depth_m /= static_cast<double>(pixels);
    room.share_beyond /= static_cast<double>(pixels);
    return ends;
}

Result<CameraIntrinsics, Error> camera_of(const tum::DataSetReader& reader) {
    if (const auto calibration = reader.calibration())
        return tum::calibrated_camera(*calibration, reader.first_image());
    return tum::data_set_camera(reader.layout().camera).value();
}

RoomFrame frame_of(const DepthFrame& read) {
    RoomFrame frame{.image = {.width = read.width, .height = read.height, .depth_m = {}},
                    .T_map_camera = read.T_map_camera.value()};
    for (const std::uint16_t depth_mm : read.depth_mm)
        frame.image.depth_m.push_back(depth_mm == 0 ? kNone : static_cast<float>(depth_mm / 1000.0));
    return frame;
}

}  // namespace

Eigen::Isometry3d arm_before_camera() {
    Eigen::Isometry3d T_camera_arm = Eigen::Isometry3d::Identity();
    T_camera_arm.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // its x is ahead, its z up
    T_camera_arm.translation() = Eigen::Vector3d(0.0, 0.5, 0.8);
    return T_camera_arm;
}

Result<RoomFrames, Error> render_room(const std::filesystem::path& sdf, const CameraIntrinsics& camera,
                                      bool is_stationary, unsigned count, double range_max_m) {
    const auto world = sim::World::read(sdf);
    if (!world) return unexpected(world.error());
    RoomFrames room{.camera = camera, .frames = {}, .is_stationary = is_stationary, .asked = kAsked};
    room.T_map_arm = kOnTheTable;
    std::mt19937 random(1);
    std::normal_distribution<double> noise_m(0.0, kSigma_m);
    for (unsigned i = 0; i < count; ++i) {
        RoomFrame frame{
            .image = {.width = camera.width, .height = camera.height, .depth_m = {}},
            .T_map_camera = pose_at(is_stationary ? kStationaryAt : static_cast<double>(i) / count)};
        const auto directions = directions_of(camera, frame.T_map_camera);
        std::vector<double> depth_m(directions.size());
        world->cast_fan(frame.T_map_camera.translation(), directions, kFurthest_m, depth_m);
        for (const double true_m : depth_m) {
            const double measured_m = std::round(1000.0 * (true_m + noise_m(random))) / 1000.0;
            frame.image.depth_m.push_back(std::isfinite(true_m) ? static_cast<float>(measured_m) : kNone);
        }
        room.frames.push_back(std::move(frame));
    }
    (void)summarize(room, range_max_m);
    return room;
}

Result<RoomFrames, Error> read_frames(const std::filesystem::path& folder, unsigned count,
                                      double range_max_m) {
    if (!tum::depth_images_of(NamedFolder(folder)))
        return unexpected(Error{
            .code = ErrorCode::not_found, .what = "expected a data set of depth images", .file = folder});
    auto reader = tum::DataSetReader::open(folder);
    if (!reader) return unexpected(reader.error());
    const auto camera = camera_of(*reader);
    if (!camera) return unexpected(camera.error());
    RoomFrames room{.camera = *camera, .frames = {}};
    const std::uint64_t images = reader->images_left();
    while (true) {
        const auto read = reader->next();
        if (!read) return unexpected(read.error());
        if (!*read) break;
        const std::uint64_t at = images - reader->images_left() - 1;
        // The first image of each of `count` equal parts.
        const bool is_next = room.frames.size() * images <= at * count && room.frames.size() < count;
        const bool is_whole = (*read)->width == camera->width && (*read)->height == camera->height;
        if (is_next && is_whole) room.frames.push_back(frame_of(**read));
    }
    if (room.frames.empty())
        return unexpected(Error{.code = ErrorCode::not_found,
                                .what = "no image of the camera's size has a pose",
                                .file = folder});
    room.T_map_arm = room.frames.front().T_map_camera * arm_before_camera();
    room.asked = summarize(room, range_max_m);
    return room;
}

}  // namespace octoskin::bench
