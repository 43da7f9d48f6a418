#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "host/apps/report/pictures.hpp"
#include "host/apps/report/tracer.hpp"

namespace octoskin::report {
namespace {

constexpr float kLineRadius_m = 0.004F;

/// A solid as wide as a room and no higher than a step is a floor.
bool is_floor(const sim::Solid& solid) {
    Eigen::AlignedBox3d bounds;
    for (const auto& vertex : solid.vertices) {
        bounds.extend(vertex);
    }
    const Eigen::Vector3d size = bounds.sizes();
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

/// Its housing, and the edges of what it sees as far as `kReach_m`.
void add_camera(Geometry& geometry, const rig::Camera& camera) {
    constexpr double kReach_m = 0.3;
    const Colour colour = colour_of(palette::kCamera);
    const Eigen::Vector3f eye = camera.T_base_camera.translation().cast<float>();
    const auto corner = [&](double column, double row) -> Eigen::Vector3f {
        const Eigen::Vector3d p_camera =
            kReach_m * Eigen::Vector3d((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0);
        return (camera.T_base_camera * p_camera).cast<float>();
    };
    const std::array<Eigen::Vector3f, 4> corners = {
        corner(0, 0), corner(camera.width, 0), corner(camera.width, camera.height), corner(0, camera.height)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        geometry.lines.push_back({eye, corners[i], kLineRadius_m, colour});
        geometry.lines.push_back({corners[i], corners[(i + 1) % corners.size()], kLineRadius_m, colour});
    }
    const Eigen::Vector3f right = camera.T_base_camera.linear().col(0).cast<float>();
    // A line, since the shadow of a camera on the floor would puzzle whoever does not see it.
    geometry.lines.push_back({eye - 0.08F * right, eye + 0.08F * right, 0.035F, colour});
}

/// The part of a beam that begins in the stage and stays there.
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

/// The stage without the empty space above everything that stands on it.
Eigen::AlignedBox3d occupied_part(Eigen::AlignedBox3d stage, const Geometry& geometry) {
    constexpr double kHeadroom_m = 0.05;
    double highest = stage.min().z();
    for (const auto& triangle : geometry.triangles) {
        for (const auto& corner : triangle.corners) {
            highest = std::max(highest, static_cast<double>(corner.z()));
        }
    }
    for (const auto& body : geometry.bodies) {
        highest = std::max(highest, static_cast<double>(std::max(body.a.z(), body.b.z()) + body.radius_m));
    }
    stage.max().z() = std::min(stage.max().z(), highest + kHeadroom_m);
    return stage;
}

}  // namespace

ImagePair render_scene(const sim::World& world, const SceneDressing& dressing) {
    Geometry geometry;
    add_world(geometry, world, dressing.hidden_models);
    // Upwards and downwards everything is drawn: the stage is what a floor is cut to.
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
    // The camera stands behind what the front shows; only the back makes room for it.
    std::vector<Eigen::Vector3d> shown = corners_of(occupied_part(dressing.stage, geometry));
    const View front = views_of(shown, dressing.size).front;
    if (dressing.camera) {
        add_camera(geometry, *dressing.camera);
        const Eigen::Vector3d p_base_camera = dressing.camera->T_base_camera.translation();
        const Eigen::Vector3d housing = Eigen::Vector3d::Constant(0.14);
        std::ranges::copy(corners_of({p_base_camera - housing, p_base_camera + housing}),
                          std::back_inserter(shown));
    }
    const Tracer tracer(geometry);
    return {tracer.render(front), tracer.render(views_of(shown, dressing.size).back)};
}

}  // namespace octoskin::report
