#include "host/io/robot/robot_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "host/io/mesh/mesh_process.hpp"
#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/fitted_urdf.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin {
namespace {

using rig::LinkShape;
using rig::ShapedLink;
using rig::ShapeKind;

constexpr double kReachMax_m = 5.0;
constexpr double kExtentMin_m = 0.005;

bool is_fitted(const LinkShape& shape) {
    return rig::is_body(shape) && (shape.kind == ShapeKind::mesh || shape.kind == ShapeKind::box);
}

SurfaceMesh box_surface(const Eigen::Vector3d& size_m) {
    constexpr std::array<std::array<int, 3>, 12> kTriangles{{{0, 2, 3},
                                                             {0, 3, 1},
                                                             {4, 5, 7},
                                                             {4, 7, 6},
                                                             {0, 1, 5},
                                                             {0, 5, 4},
                                                             {2, 6, 7},
                                                             {2, 7, 3},
                                                             {0, 4, 6},
                                                             {0, 6, 2},
                                                             {1, 3, 7},
                                                             {1, 7, 5}}};
    SurfaceMesh mesh;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner(i % 2 - 0.5, i / 2 % 2 - 0.5, i / 4 - 0.5);
        mesh.vertices.emplace_back(corner.cwiseProduct(size_m));
    }
    for (const auto& triangle : kTriangles)
        mesh.triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
    return mesh;
}

std::string counted(const std::vector<LinkShape>& shapes) {
    constexpr std::array kPlural{std::pair{ShapeKind::mesh, "meshes"}, std::pair{ShapeKind::box, "boxes"},
                                 std::pair{ShapeKind::cylinder, "cylinders"},
                                 std::pair{ShapeKind::sphere, "spheres"},
                                 std::pair{ShapeKind::capsule, "capsules"}};
    std::string text;
    for (const auto& [kind, plural] : kPlural) {
        const auto count = std::ranges::count(shapes, kind, &LinkShape::kind);
        if (count == 0) continue;
        text +=
            fmt::format("{}{} {}", text.empty() ? "" : ", ", count, count == 1 ? rig::name_of(kind) : plural);
    }
    return text;
}

BodySource source_of(const ShapedLink& link) {
    if (std::ranges::any_of(link.collisions, rig::is_body)) return BodySource::collision;
    if (rig::is_body_visual(link) && std::ranges::any_of(link.visuals, rig::is_body))
        return BodySource::visual;
    return BodySource::nothing;
}

/// Reads each file once.
class Meshes {
  public:
    Meshes(const FilePlace& urdf, const MeshSearch& search) : urdf_(urdf.shown()), places_(urdf_, search) {}

    /// Null, with a fault, if it cannot be read.
    const SurfaceMesh* find(const LinkShape& shape, const std::string& link) {
        if (failed_.contains(shape.mesh)) return nullptr;
        if (const auto known = meshes_.find(shape.mesh); known != meshes_.end()) return &known->second;
        auto place = places_.find(shape.mesh);
        if (!place) return fail(shape, link, place.error());
        auto read = read_mesh_in_process(*place);
        if (!read) {
            Error error = read.error();
            error.what = error.file.string() + ": " + error.what;
            return fail(shape, link, std::move(error));
        }
        return &meshes_
                    .emplace(shape.mesh, SurfaceMesh{std::move(read->vertices), std::move(read->triangles)})
                    .first->second;
    }

    std::vector<rig::ElementFault> faults;

  private:
    const SurfaceMesh* fail(const LinkShape& shape, const std::string& link, Error error) {
        failed_.emplace(shape.mesh, true);
        error.file = urdf_;
        error.line = shape.line;
        error.key = "link " + link;
        faults.push_back({std::move(error), shape.mesh});
        return nullptr;
    }

    std::filesystem::path urdf_;
    MeshPlaces places_;
    std::map<std::string, SurfaceMesh> meshes_;
    std::map<std::string, bool> failed_;
};

/// The surface of the link's meshes and boxes.
SurfaceMesh surface_of(const ShapedLink& link, Meshes& meshes) {
    SurfaceMesh surface;
    for (const LinkShape& shape : body_shapes(link)) {
        const Eigen::Affine3d T_link_shape(shape.T_link_shape);
        if (!rig::is_body(shape)) continue;
        if (shape.kind == ShapeKind::box) append(box_surface(shape.size), T_link_shape, surface);
        if (shape.kind != ShapeKind::mesh) continue;
        if (const SurfaceMesh* const mesh = meshes.find(shape, link.name))
            append(*mesh, T_link_shape * Eigen::Scaling(shape.size), surface);
    }
    return surface;
}

std::optional<Error> size_fault(const SurfaceMesh& surface) {
    if (surface.vertices.empty()) return std::nullopt;
    double farthest_m = 0.0;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& at : surface.vertices) {
        const double distance_m = at.norm();
        if (!(distance_m <= farthest_m)) farthest_m = distance_m;
        if (!(farthest_m <= kReachMax_m)) break;  // not a number, too
        box.extend(at);
    }
    if (!(farthest_m <= kReachMax_m)) {
        return Error{.code = ErrorCode::too_large,
                     .what = fmt::format("expected a mesh within {} m of its link's origin", kReachMax_m),
                     .value = fmt::format("{:.4g} m", farthest_m),
                     .remedy = "is it written in millimetres? Then add scale=\"0.001 0.001 0.001\""};
    }
    const double extent_m = box.sizes().maxCoeff();
    if (extent_m >= kExtentMin_m) return std::nullopt;
    return Error{
        .code = ErrorCode::out_of_range,
        .what = fmt::format("expected meshes and boxes of at least {} mm together", 1e3 * kExtentMin_m),
        .value = fmt::format("{:.4g} mm", 1e3 * extent_m),
        .remedy = "is it scaled twice? If the link is a frame, remove its shape"};
}

std::vector<rig::Capsule> capsules_of(const LinkBody& body) {
    std::vector<rig::Capsule> capsules;
    for (const PosedCapsule& capsule : body.fit->capsules)
        capsules.push_back({body.link, capsule.p_a, capsule.p_b, capsule.radius_m});
    return capsules;
}

}  // namespace

const char* name_of(BodySource source) noexcept {
    switch (source) {
        case BodySource::nothing:
            return "nothing";
        case BodySource::collision:
            return "collision";
        case BodySource::visual:
            return "visual";
    }
    return "nothing";
}

const std::vector<LinkShape>& body_shapes(const ShapedLink& link) {
    return source_of(link) == BodySource::visual ? link.visuals : link.collisions;
}

bool needs_fit(const rig::RobotShapes& shapes) {
    return std::ranges::any_of(shapes.links, [](const ShapedLink& link) {
        return std::ranges::find(link.collisions, ShapeKind::mesh, &LinkShape::kind) != link.collisions.end();
    });
}

Result<RobotFit, Error> fit_robot(const FilePlace& urdf, const std::string& base_link,
                                  const MeshSearch& search) {
    auto shapes = rig::read_link_shapes(urdf, base_link);
    if (!shapes) return unexpected(shapes.error());
    RobotFit robot{.shapes = *std::move(shapes), .links = {}, .urdf = {}};
    Meshes meshes(urdf, search);
    for (const ShapedLink& link : robot.shapes.links) {
        LinkBody body{.link = link.name, .is_moving = link.is_moving, .source = source_of(link)};
        body.shapes = counted(body_shapes(link));
        body.kept =
            static_cast<std::size_t>(std::ranges::count_if(body_shapes(link), [](const LinkShape& shape) {
                return rig::is_body(shape) && !is_fitted(shape);
            }));
        body.mesh = surface_of(link, meshes);
        if (auto fault = size_fault(body.mesh)) {
            fault->file = urdf.shown();
            fault->line = link.line;
            fault->key = "link " + link.name;
            const char* const kind = fault->code == ErrorCode::too_large ? "too large" : "too small";
            meshes.faults.push_back({*std::move(fault), kind});
        }
        robot.links.push_back(std::move(body));
    }
    if (!meshes.faults.empty()) return unexpected(rig::one_error_of(std::move(meshes.faults)));
    std::map<std::string, rig::FittedBody> bodies;
    for (LinkBody& body : robot.links) {
        rig::FittedBody& fitted = bodies[body.link];
        fitted.is_of_visual = body.source == BodySource::visual;
        if (body.mesh.triangles.empty()) continue;
        body.fit = fit_capsules(body.mesh);
        fitted.capsules = capsules_of(body);
    }
    const auto text = rig::read_urdf_text(urdf);
    if (!text) return unexpected(text.error());
    auto fitted = rig::urdf_with_bodies(urdf.shown(), *text, bodies);
    if (!fitted) return unexpected(fitted.error());
    robot.urdf = *std::move(fitted);
    return robot;
}

}  // namespace octoskin
