#include "hw/rigfile/camera_reader.hpp"

#include <fmt/format.h>

#include "hw/rigfile/pose.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {
namespace {

LensDistortion read_distortion(const Value& value, const std::string& path) {
    // For cameras with a view of 60 degrees |k| is below 4 and |p| below 0.02; a long lens has larger values.
    constexpr Range<double> kRadial{-1000.0, 1000.0};
    constexpr Range<double> kTangential{-1.0, 1.0};
    const Table table(value, path, {"k1", "k2", "p1", "p2", "k3"});
    return {.k1 = table.number("k1", kRadial, 0.0),
            .k2 = table.number("k2", kRadial, 0.0),
            .p1 = table.number("p1", kTangential, 0.0),
            .p2 = table.number("p2", kTangential, 0.0),
            .k3 = table.number("k3", kRadial, 0.0)};
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
    const Value* const distortion = table.find("distortion");
    if (distortion == nullptr) return;
    camera.lens = read_distortion(*distortion, table.path_of("distortion"));
    const auto lost = pixel_without_ray(camera);
    if (!lost) return;
    table.fail(
        "distortion",
        fmt::format("expected coefficients that give each pixel one ray, found {}: pixel ({}, {}) has "
                    "none before the polynomial turns back, {:.3f} from the axis: calibrate again "
                    "with views that reach the corners, or without k3",
                    octoskin::describe(camera.lens), lost->u, lost->v, LensInverse(camera.lens).radius()));
}

DataSetKeys read_data_set(const Value& value, const std::string& path) {
    const Table table(value, path, {"depth_units_per_m", "depth_no_value", "pose_gap_max_ms"});
    DataSetKeys data_set;
    if (table.find("depth_units_per_m") != nullptr)
        data_set.units_per_m = table.number("depth_units_per_m", {1.0, 1e6});
    if (table.find("depth_no_value") != nullptr)
        data_set.no_value = table.integer<std::uint16_t>("depth_no_value", {0, 65'535});
    data_set.pose_gap_max_ms = table.number("pose_gap_max_ms", {1.0, 10'000.0}, data_set.pose_gap_max_ms);
    return data_set;
}

}  // namespace

Camera read_camera(const Value& value) {
    const Table table(value, "camera",
                      {"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "distortion", "rate_hz",
                       "depth_min_m", "depth_max_m", "data_set", "pose"});
    Camera camera;
    camera.width = table.integer<std::uint32_t>("width_px", {1, 4096});
    camera.height = table.integer<std::uint32_t>("height_px", {1, 4096});
    camera.fx = table.number("fx_px", {1.0, 100'000.0});
    camera.fy = table.number("fy_px", {1.0, 100'000.0});
    camera.cx = table.number("cx_px", {0.0, static_cast<double>(camera.width)});
    camera.cy = table.number("cy_px", {0.0, static_cast<double>(camera.height)});
    read_lens(table, camera);
    camera.rate_hz = table.number("rate_hz", {0.1, 1000.0});
    camera.depth_min_m = table.number("depth_min_m", {0.0, kDepthLargest_m}, camera.depth_min_m);
    camera.depth_max_m = table.number("depth_max_m", {0.0, kDepthLargest_m}, camera.depth_max_m);
    if (!(camera.depth_min_m < camera.depth_max_m))
        table.fail("depth_max_m", "expected more than depth_min_m");
    if (const Value* data_set = table.find("data_set"))
        camera.data_set = read_data_set(*data_set, table.path_of("data_set"));
    camera.T_base_camera = read_pose(table.require("pose"), table.path_of("pose"),
                                     {.reach_m = kRoomReachM, .may_look_at_point = true});
    return camera;
}

}  // namespace octoskin::rig
