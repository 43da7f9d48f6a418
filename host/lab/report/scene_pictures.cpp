#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "host/lab/report/pictures.hpp"
#include "host/lab/report/tracer.hpp"

namespace octoskin::report {
namespace {

constexpr float kLineRadius_m = 0.004F;

Eigen::AlignedBox3d bounds_of(const sim::Solid& solid) {
    Eigen::AlignedBox3d bounds;
    for (const auto& vertex : solid.vertices) {
        bounds.extend(vertex);
    }
    return bounds;
}

/// A solid as wide as a room and no higher than a step is a floor.
bool is_floor(const sim::Solid& solid) {
    const Eigen::Vector3d size = bounds_of(solid).sizes();
    return size.x() > 3.0 && size.y() > 3.0 && size.z() < 0.3;
}

void add_world(Geometry& geometry, const sim::World& world, const std::vector<std::string>& hidden_models) {
    for (const auto& solid : world.solids()) {
        const bool is_hidden = std::ranges::find(hidden_models, solid.model) != hidden_models.end();
        const Colour colour = colour_of(is_hidden         ? palette::kHiddenObject
                                        : is_floor(solid) ? palette::kFloor
                                                          : palette::kFurniture);
        for (const auto& triangle : solid.triangles) {
            const auto corner = [&](int i) -> Eigen::Vector3f {
                return solid.vertices[static_cast<std::size_t>(triangle[i])].cast<float>();
            };
            geometry.triangles.push_back({{corner(0), corner(1), corner(2)}, colour});
        }
    }
}

/// A camera as drawn: its housing, and the edges of its view up to `kReach_m`.
struct CameraGlyph {
    Eigen::Vector3d eye;
    Eigen::Vector3d right;
    std::array<Eigen::Vector3d, 4> corners;  ///< of the view, in turn

    static constexpr double kReach_m = 0.3;
    static constexpr double kHousingHalf_m = 0.08;
    static constexpr double kHousingRadius_m = 0.035;
};

CameraGlyph glyph_of(const rig::Camera& camera) {
    const auto corner = [&](double column, double row) -> Eigen::Vector3d {
        return camera.T_link_camera *
               (CameraGlyph::kReach_m *
                Eigen::Vector3d((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0));
    };
    return {camera.T_link_camera.translation(),
            camera.T_link_camera.linear().col(0),
            {corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height),
             corner(0, camera.height)}};
}

/// Points that must be in the picture so that the camera is drawn whole.
std::vector<Eigen::Vector3d> outline_of(const CameraGlyph& glyph) {
    std::vector<Eigen::Vector3d> points(glyph.corners.begin(), glyph.corners.end());
    const Eigen::Vector3d housing =
        Eigen::Vector3d::Constant(CameraGlyph::kHousingHalf_m + CameraGlyph::kHousingRadius_m);
    std::ranges::copy(corners_of({glyph.eye - housing, glyph.eye + housing}), std::back_inserter(points));
    return points;
}

std::vector<Eigen::Vector3d> outline_of(const std::vector<rig::Camera>& cameras) {
    std::vector<Eigen::Vector3d> points;
    for (const rig::Camera& camera : cameras)
        std::ranges::copy(outline_of(glyph_of(camera)), std::back_inserter(points));
    return points;
}

void add_camera(Geometry& geometry, const CameraGlyph& glyph) {
    const Colour colour = colour_of(palette::kCamera);
    const Eigen::Vector3f eye = glyph.eye.cast<float>();
    for (std::size_t i = 0; i < glyph.corners.size(); ++i) {
        const Eigen::Vector3f corner = glyph.corners[i].cast<float>();
        const Eigen::Vector3f next = glyph.corners[(i + 1) % glyph.corners.size()].cast<float>();
        geometry.lines.push_back({eye, corner, kLineRadius_m, colour});
        geometry.lines.push_back({corner, next, kLineRadius_m, colour});
    }
    const Eigen::Vector3f half = (CameraGlyph::kHousingHalf_m * glyph.right).cast<float>();
    // Drawn as lines, which cast no shadow: the shadow of a camera outside the picture would be confusing.
    geometry.lines.push_back(
        {eye - half, eye + half, static_cast<float>(CameraGlyph::kHousingRadius_m), colour});
}

/// The part of a beam from its start, if that is in the stage, to where it leaves the stage.
void add_beam(Geometry& geometry, const Segment& beam, const Eigen::AlignedBox3d& stage) {
    const Eigen::Vector3d whole = beam.p_base_to - beam.p_base_from;
    double share = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double bound = whole[axis] > 0.0 ? stage.max()[axis] : stage.min()[axis];
        if (std::abs(whole[axis]) > 1e-9) {
            share = std::min(share, (bound - beam.p_base_from[axis]) / whole[axis]);
        }
    }
    if (share > 0.0) {
        geometry.lines.push_back({beam.p_base_from.cast<float>(),
                                  (beam.p_base_from + share * whole).cast<float>(), kLineRadius_m / 2.0F,
                                  colour_of(palette::kBeam)});
    }
}

/// The part of the stage that furniture and robot occupy; the whole stage if they are not in it.
Eigen::AlignedBox3d occupied_part(const sim::World& world, const SceneDressing& dressing) {
    Eigen::AlignedBox3d content;
    for (const auto& solid : world.solids()) {
        const Eigen::AlignedBox3d on_stage = bounds_of(solid).intersection(dressing.stage);
        if (!is_floor(solid) && !on_stage.isEmpty()) {
            content.extend(on_stage);
        }
    }
    for (const auto& capsule : dressing.robot) {
        const Eigen::Vector3d radius = Eigen::Vector3d::Constant(capsule.radius_m);
        for (const Eigen::Vector3d& end : {capsule.p_base_a, capsule.p_base_b}) {
            content.extend(Eigen::AlignedBox3d(end - radius, end + radius));
        }
    }
    if (content.isEmpty()) {
        return dressing.stage;
    }
    constexpr double kRoom_m = 0.05;
    return {content.min() - Eigen::Vector3d::Constant(kRoom_m),
            content.max() + Eigen::Vector3d::Constant(kRoom_m)};
}

/// A view pair from the front and from behind, in which each camera is either whole or absent.
ViewPair scene_views(const sim::World& world, const SceneDressing& dressing) {
    std::vector<Eigen::Vector3d> shown = corners_of(occupied_part(world, dressing));
    ViewPair views = views_of(shown, dressing.size);
    if (dressing.cameras.empty()) {
        return views;
    }
    const auto outline = outline_of(dressing.cameras);
    const bool is_in_front =
        std::ranges::any_of(outline, [&](const auto& point) { return shows(views.front, point); });
    // From the front a camera is usually out of view; the view from behind always includes all.
    std::ranges::copy(outline, std::back_inserter(shown));
    const ViewPair with_cameras = views_of(shown, dressing.size);
    return {is_in_front ? with_cameras.front : views.front, with_cameras.back};
}

}  // namespace

ImagePair render_scene(const sim::World& world, const SceneDressing& dressing) {
    Geometry geometry;
    add_world(geometry, world, dressing.hidden_models);
    // The stage clips floors in x and y only; in z everything is drawn.
    Eigen::AlignedBox3d stage = dressing.stage;
    stage.min().z() -= 1.0;
    stage.max().z() += 1.0;
    geometry.stage = stage.cast<float>();
    for (const auto& capsule : dressing.robot) {
        geometry.bodies.push_back({capsule.p_base_a.cast<float>(), capsule.p_base_b.cast<float>(),
                                   static_cast<float>(capsule.radius_m), colour_of(palette::kRobot)});
    }
    for (const auto& beam : dressing.beams) {
        add_beam(geometry, beam, stage);
    }
    for (const rig::Camera& camera : dressing.cameras) {
        add_camera(geometry, glyph_of(camera));
    }
    const ViewPair views = scene_views(world, dressing);
    const Tracer tracer(geometry);
    return {tracer.render(views.front), tracer.render(views.back)};
}

}  // namespace octoskin::report
