#include "hw/rigfile/camera_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "hw/rigfile/camera_pose_edit.hpp"
#include "hw/rigfile/fed_device.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/shell_word.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {
namespace {

LensDistortion read_distortion(const Value& value, const std::string& path) {
    const Table table(value, path, keys::kDistortion);
    return {.k1 = table.number(keys::distortion::kK1),
            .k2 = table.number(keys::distortion::kK2),
            .p1 = table.number(keys::distortion::kP1),
            .p2 = table.number(keys::distortion::kP2),
            .k3 = table.number(keys::distortion::kK3)};
}

/// The first pixel on the image border without a ray. If the border pixels have rays, the enclosed pixels
/// have them too.
struct Pixel {
    std::uint32_t u;
    std::uint32_t v;
};
std::optional<Pixel> pixel_without_ray(const Camera& camera) {
    const LensInverse inverse(camera.lens);
    const auto has_ray = [&](std::uint32_t u, std::uint32_t v) {
        return inverse.ray_of(picture_of(camera, u, v)).has_value();
    };
    for (std::uint32_t u = 0; u < camera.width; ++u) {
        for (const std::uint32_t v : {0U, camera.height - 1}) {
            if (!has_ray(u, v)) return Pixel{u, v};
        }
    }
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (const std::uint32_t u : {0U, camera.width - 1}) {
            if (!has_ray(u, v)) return Pixel{u, v};
        }
    }
    return std::nullopt;
}

/// Call after the intrinsics are read.
void read_lens(const Table& table, Camera& camera) {
    const Value* const distortion = table.find(keys::camera::kDistortion);
    if (distortion == nullptr) return;
    camera.lens = read_distortion(*distortion, table.path_of(keys::camera::kDistortion));
    const auto lost = pixel_without_ray(camera);
    if (!lost) return;
    table.fail(
        keys::camera::kDistortion,
        {ErrorCode::bad_value,
         fmt::format("expected coefficients that give each pixel one ray; pixel ({}, {}) has none before the "
                     "polynomial turns back, {:.3f} from the axis",
                     lost->u, lost->v, LensInverse(camera.lens).radius()),
         octoskin::describe(camera.lens),
         "calibrate again with views that reach the corners, or without k3"});
}

DataSetKeys read_data_set(const Value& value, const std::string& path) {
    const Table table(value, path, keys::kDataSet);
    DataSetKeys data_set;
    if (table.find(keys::data_set::kDepthUnits) != nullptr)
        data_set.units_per_m = table.number(keys::data_set::kDepthUnits);
    if (table.find(keys::data_set::kDepthNoValue) != nullptr)
        data_set.no_value = table.integer<std::uint16_t>(keys::data_set::kDepthNoValue);
    data_set.pose_gap_max_ms = table.number(keys::data_set::kPoseGapMax);
    return data_set;
}

CameraNoise read_noise(const Value& value, const std::string& path) {
    const Table table(value, path, keys::kCameraNoise);
    return {.noise_m = table.number(keys::noise::kNoise),
            .noise_per_m = table.number(keys::noise::kNoisePer),
            .noise_from_m = table.number(keys::noise::kNoiseFrom),
            .bias_per_m = table.number(keys::noise::kBiasPer)};
}

/// A file is absolute, so that it is the same from any working directory.
std::string read_device(const Table& table) {
    const Value& value = table.require(keys::camera::kDevice);
    std::string device = table.text(keys::camera::kDevice);
    std::error_code error;
    if (!is_good_device(device))
        table.fail(keys::camera::kDevice, {ErrorCode::bad_value, kGoodDevice, fmt::format("'{}'", device)});
    if (is_topic(device) && !std::filesystem::exists(device, error))
        table.fail(keys::camera::kDevice,
                   {ErrorCode::bad_value, "expected `ros:` before the topic of a camera's images",
                    fmt::format("'{}'", device), fmt::format("write ros:{}", device)});
    if (!device.ends_with(".oni")) return device;
    return std::filesystem::absolute(existing_file(value, table.path_of(keys::camera::kDevice)).shown())
        .lexically_normal()
        .string();
}

struct Body {
    const UrdfDocument& robot;
    const std::string& base_link;
};

std::string read_link(const Table& table, const Body& body) {
    const Value* const value = table.find(keys::camera::kLink);
    if (value == nullptr) return {};
    std::string link = table.text(keys::camera::kLink);
    if (!body.robot.is_below(body.base_link, link))
        fail(*value, table.path_of(keys::camera::kLink),
             {ErrorCode::unknown_name,
              fmt::format("expected a link of {} at or below {}", body.robot.file().filename().string(),
                          body.base_link),
              fmt::format("'{}'", link), "it has " + joined(body.robot.link_names())});
    return link;
}

void read_depths(const Table& table, Camera& camera) {
    camera.depth_min_m = table.number(keys::camera::kDepthMin);
    camera.depth_max_m = table.number(keys::camera::kDepthMax);
    if (!(camera.depth_min_m < camera.depth_max_m))
        table.fail(keys::camera::kDepthMax, {ErrorCode::out_of_range, "expected more than depth_min_m",
                                             fmt::format("{}", camera.depth_max_m)});
}

/// A rig says all that a map is made from: a pose is not taken from the network while a map is made.
void refuse_pose_of_frames(const Value& pose, const std::string& path) {
    if (pose.kind != Value::Kind::scalar || pose.text != kPoseOfFrames) return;
    fail(pose, path,
         {ErrorCode::bad_value, "expected a pose, not the word with which it is taken from ROS 2",
          fmt::format("'{}'", pose.text),
          fmt::format("octoskin bridge pose --rig {} prints the rig with the pose",
                      shell_word(pose.file->shown().string()))});
}

Eigen::Isometry3d read_camera_pose(const Table& table) {
    const Value& pose = table.require(keys::camera::kPose);
    const std::string path = table.path_of(keys::camera::kPose);
    refuse_pose_of_frames(pose, path);
    return read_pose(pose, path, {.reach_m = keys::kRoomReach_m, .may_look_at_point = true});
}

Camera read_camera(const Table& table, const Body& body) {
    Camera camera;
    camera.width = table.integer<std::uint32_t>(keys::camera::kWidth);
    camera.height = table.integer<std::uint32_t>(keys::camera::kHeight);
    camera.fx = table.number(keys::camera::kFx);
    camera.fy = table.number(keys::camera::kFy);
    camera.cx =
        table.number(keys::camera::kCx, {keys::camera::kCx.range.min, static_cast<double>(camera.width)});
    camera.cy =
        table.number(keys::camera::kCy, {keys::camera::kCy.range.min, static_cast<double>(camera.height)});
    read_lens(table, camera);
    camera.rate_hz = table.number(keys::camera::kRate);
    read_depths(table, camera);
    if (const Value* noise = table.find(keys::camera::kNoise))
        camera.noise = read_noise(*noise, table.path_of(keys::camera::kNoise));
    if (const Value* data_set = table.find(keys::camera::kDataSet))
        camera.data_set = read_data_set(*data_set, table.path_of(keys::camera::kDataSet));
    if (table.find(keys::camera::kDevice) != nullptr) camera.device = read_device(table);
    camera.link = read_link(table, body);
    camera.T_link_camera = read_camera_pose(table);
    return camera;
}

/// It is part of the name of a file, and of `--camera NAME=DEVICE`.
std::string read_camera_name(const Table& table, const std::vector<Camera>& cameras) {
    std::string name = table.text(keys::camera::kName);
    if (name.size() > keys::camera::kNameMax || name.front() == '.' || name.front() == '-')
        table.fail(keys::camera::kName,
                   {ErrorCode::bad_name,
                    fmt::format("expected at most {} characters, the first a letter, a digit or _",
                                keys::camera::kNameMax),
                    fmt::format("'{}'", name)});
    if (std::ranges::find(cameras, name, &Camera::name) != cameras.end())
        table.fail(keys::camera::kName,
                   {ErrorCode::duplicate, "expected each name once", fmt::format("'{}' again", name)});
    return name;
}

void refuse_shared_device(const Table& table, const Camera& camera, const std::vector<Camera>& cameras) {
    if (camera.device.empty()) return;
    const auto other = std::ranges::find(cameras, camera.device, &Camera::device);
    if (other == cameras.end()) return;
    table.fail(keys::camera::kDevice,
               {ErrorCode::duplicate, "expected a device of its own", fmt::format("'{}'", camera.device),
                fmt::format("camera '{}' has it", other->name)});
}

void refuse_too_many_pixels(const Table& table, const std::vector<Camera>& cameras) {
    std::uint64_t pixels = 0;
    for (const Camera& camera : cameras) pixels += std::uint64_t{camera.width} * camera.height;
    if (pixels > kCameraPixelsMax)
        table.fail(keys::camera::kWidth,
                   {ErrorCode::limit_exceeded,
                    fmt::format("expected at most {} pixels of all cameras together", kCameraPixelsMax),
                    fmt::format("{}", pixels), "use modes with fewer pixels"});
}

std::vector<Camera> read_list_of_cameras(const Value& value, const Body& body) {
    const std::string path(name_of(keys::kCameras));
    const std::vector<Value>& items = read_list(value, path);
    if (items.empty() || items.size() > kCamerasMax)
        fail(value, path,
             {ErrorCode::limit_exceeded, fmt::format("expected 1 to {} cameras", kCamerasMax),
              std::to_string(items.size())});
    std::vector<Camera> cameras;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table table(items[i], fmt::format("{}[{}]", path, i), keys::kCamera);
        std::string name = read_camera_name(table, cameras);
        Camera camera = read_camera(table, body);
        camera.name = std::move(name);
        refuse_shared_device(table, camera, cameras);
        cameras.push_back(std::move(camera));
        refuse_too_many_pixels(table, cameras);
    }
    return cameras;
}

}  // namespace

std::vector<Camera> read_cameras(const Table& top, const UrdfDocument& robot, const std::string& base_link) {
    const Value* const one = top.find(keys::kCameraTable);
    const Value* const several = top.find(keys::kCameras);
    if (one != nullptr && several != nullptr)
        top.fail(keys::kCameras,
                 {.code = ErrorCode::conflict,
                  .what = "expected `camera` or `cameras`, found both",
                  .remedy = "put all cameras into `cameras` (`camera: ~` removes an inherited one)"});
    const Body body{robot, base_link};
    if (several != nullptr) return read_list_of_cameras(*several, body);
    if (one == nullptr) return {};
    const Table table(*one, std::string(name_of(keys::kCameraTable)), keys::kCamera);
    if (table.find(keys::camera::kName) != nullptr)
        table.fail(keys::camera::kName, {.code = ErrorCode::conflict,
                                         .what = "expected none in `camera`, the only camera",
                                         .remedy = "remove it, or write `cameras` with this item"});
    return {read_camera(table, body)};
}

}  // namespace octoskin::rig
