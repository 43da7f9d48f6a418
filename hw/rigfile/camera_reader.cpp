#include "hw/rigfile/camera_reader.hpp"

#include <fmt/format.h>

#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/rig_keys.hpp"
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

}  // namespace

Camera read_camera(const Value& value, const UrdfDocument& robot, const std::string& base_link) {
    const Table table(value, std::string(name_of(keys::kCameraTable)), keys::kCamera);
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
    camera.depth_min_m = table.number(keys::camera::kDepthMin);
    camera.depth_max_m = table.number(keys::camera::kDepthMax);
    if (!(camera.depth_min_m < camera.depth_max_m))
        table.fail(keys::camera::kDepthMax, {ErrorCode::out_of_range, "expected more than depth_min_m",
                                             fmt::format("{}", camera.depth_max_m)});
    if (const Value* data_set = table.find(keys::camera::kDataSet))
        camera.data_set = read_data_set(*data_set, table.path_of(keys::camera::kDataSet));
    if (const Value* link = table.find(keys::camera::kLink)) {
        camera.link = table.text(keys::camera::kLink);
        if (!robot.is_below(base_link, camera.link))
            fail(*link, table.path_of(keys::camera::kLink),
                 {ErrorCode::unknown_name,
                  fmt::format("expected a link of {} at or below {}", robot.file().filename().string(),
                              base_link),
                  fmt::format("'{}'", camera.link), "it has " + joined(robot.link_names())});
    }
    camera.T_link_camera = read_pose(table.require(keys::camera::kPose), table.path_of(keys::camera::kPose),
                                     {.reach_m = keys::kRoomReach_m, .may_look_at_point = true});
    return camera;
}

}  // namespace octoskin::rig
