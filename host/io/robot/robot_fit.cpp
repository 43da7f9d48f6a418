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
constexpr std::size_t kLinkTrianglesMax = 2'000'000;
constexpr std::size_t kRobotTrianglesMax = 8'000'000;

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

/// The shapes that a link's body is made of.
const std::vector<LinkShape>& shapes_of(const ShapedLink& link) {
    return source_of(link) == BodySource::visual ? link.visuals : link.collisions;
}

/// Reads a file once for a link: all meshes of a robot may not fit in memory.
class Meshes {
  public:
    Meshes(const FilePlace& urdf, const MeshSearch& search) : urdf_(urdf.shown()), places_(urdf, search) {}

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

    void forget() { meshes_.clear(); }

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

Error too_many(const std::string& of, std::size_t most, std::size_t found) {
    return {.code = ErrorCode::too_large,
            .what = fmt::format("expected at most {} triangles of {}", most, of),
            .value = fmt::format("{} or more", found),
            .remedy = "export the meshes with fewer triangles"};
}

/// The surface of the link's meshes and boxes, in the frame of `T_link_surface`. Error (too_large): too many
/// triangles, of the link or of the robot with `before`.
Result<SurfaceMesh, Error> surface_of(const ShapedLink& link, const Eigen::Isometry3d& T_link_surface,
                                      std::size_t before, Meshes& meshes) {
    SurfaceMesh surface;
    for (const LinkShape& shape : shapes_of(link)) {
        if (!is_fitted(shape)) continue;
        const Eigen::Affine3d T_surface_shape(T_link_surface.inverse() * shape.T_link_shape);
        if (shape.kind == ShapeKind::box) append(box_surface(shape.size), T_surface_shape, surface);
        if (shape.kind != ShapeKind::mesh) continue;
        const SurfaceMesh* const mesh = meshes.find(shape, link.name);
        if (mesh == nullptr) continue;
        const std::size_t count = surface.triangles.size() + mesh->triangles.size();
        if (count > kLinkTrianglesMax) return unexpected(too_many("a link", kLinkTrianglesMax, count));
        if (before + count > kRobotTrianglesMax)
            return unexpected(too_many("all links together", kRobotTrianglesMax, before + count));
        append(*mesh, T_surface_shape * Eigen::Scaling(shape.size), surface);
    }
    return surface;
}

std::optional<Error> size_fault(const SurfaceMesh& surface, const Eigen::Isometry3d& T_link_surface) {
    if (surface.vertices.empty()) return std::nullopt;
    double farthest_m = 0.0;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& at : surface.vertices) {
        const double distance_m = (T_link_surface * at).norm();
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

/// Evenly spread triangles of a surface.
SurfaceMesh part_of(const SurfaceMesh& surface, const Eigen::Isometry3d& T_link_surface) {
    SurfaceMesh part;
    const std::size_t step = 1 + (surface.triangles.size() - 1) / kDrawnTrianglesMax;
    for (std::size_t i = 0; i < surface.triangles.size(); i += step) {
        const auto first = static_cast<int>(part.vertices.size());
        for (const Eigen::Vector3d& corner : surface.corners(i))
            part.vertices.push_back(T_link_surface * corner);
        part.triangles.emplace_back(first, first + 1, first + 2);
    }
    return part;
}

/// The place of the box that alone is fitted, so that the same box elsewhere has the same fit.
std::optional<LinkShape> lone_box(const ShapedLink& link) {
    const auto& shapes = shapes_of(link);
    const auto first = std::ranges::find_if(shapes, is_fitted);
    if (first == shapes.end() || first->kind != ShapeKind::box ||
        std::ranges::count_if(shapes, is_fitted) > 1)
        return std::nullopt;
    return *first;
}

BodyFit moved(BodyFit fit, const Eigen::Isometry3d& T_link_surface) {
    for (PosedCapsule& capsule : fit.capsules) {
        capsule.p_a = T_link_surface * capsule.p_a;
        capsule.p_b = T_link_surface * capsule.p_b;
    }
    return fit;
}

/// Fits one link after the other.
class Fitting {
  public:
    Fitting(const FilePlace& urdf, const MeshSearch& search) : urdf_(urdf.shown()), meshes_(urdf, search) {}

    LinkBody fit(const ShapedLink& link) {
        LinkBody body{.link = link.name, .is_moving = link.is_moving, .source = source_of(link)};
        body.shapes = counted(shapes_of(link));
        body.kept =
            static_cast<std::size_t>(std::ranges::count_if(shapes_of(link), [](const LinkShape& shape) {
                return rig::is_body(shape) && !is_fitted(shape);
            }));
        meshes_.forget();
        const auto box = lone_box(link);
        const Eigen::Isometry3d T_link_surface = box ? box->T_link_shape : Eigen::Isometry3d::Identity();
        const auto surface = surface_of(link, T_link_surface, triangles_, meshes_);
        if (!surface) {
            fail(link, surface.error(), "too large");
            return body;
        }
        triangles_ += surface->triangles.size();
        if (auto fault = size_fault(*surface, T_link_surface)) {
            const char* const kind = fault->code == ErrorCode::too_large ? "too large" : "too small";
            fail(link, *std::move(fault), kind);
            return body;
        }
        // A robot that is refused is fitted no further, but all of its faults are named.
        if (surface->triangles.empty() || !faults().empty()) return body;
        body.triangles = surface->triangles.size();
        body.mesh = part_of(*surface, T_link_surface);
        const auto fit = box ? fit_of_box(box->size, *surface) : fit_capsules(*surface);
        if (!fit) {
            fail(link,
                 {.code = ErrorCode::too_large,
                  .what = "expected a surface that capsules can be fitted to",
                  .value = fmt::format("{} triangles, too many of them large and across each other",
                                       body.triangles),
                  .remedy = "export the outer surface alone"},
                 "too much work");
            return body;
        }
        body.fit = moved(*fit, T_link_surface);
        return body;
    }

    std::vector<rig::ElementFault>& faults() { return meshes_.faults; }

  private:
    void fail(const ShapedLink& link, Error error, const char* kind) {
        error.file = urdf_;
        error.line = link.line;
        error.key = "link " + link.name;
        faults().push_back({std::move(error), kind});
    }

    std::optional<BodyFit> fit_of_box(const Eigen::Vector3d& size, const SurfaceMesh& surface) {
        const std::array key{size.x(), size.y(), size.z()};
        if (const auto known = boxes_.find(key); known != boxes_.end()) return known->second;
        return boxes_.emplace(key, fit_capsules(surface)).first->second;
    }

    std::filesystem::path urdf_;
    Meshes meshes_;
    std::size_t triangles_ = 0;  ///< of all links so far
    std::map<std::array<double, 3>, std::optional<BodyFit>> boxes_;
};

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

Result<RobotFit, Error> fit_robot(const FilePlace& urdf, const std::string& base_link,
                                  const MeshSearch& search) {
    auto shapes = rig::read_link_shapes(urdf, base_link);
    if (!shapes) return unexpected(shapes.error());
    RobotFit robot{.shapes = *std::move(shapes), .links = {}, .urdf = {}};
    Fitting fitting(urdf, search);
    for (const ShapedLink& link : robot.shapes.links) robot.links.push_back(fitting.fit(link));
    if (!fitting.faults().empty()) return unexpected(rig::one_error_of(std::move(fitting.faults())));
    std::map<std::string, rig::FittedBody> bodies;
    for (const LinkBody& body : robot.links) {
        rig::FittedBody& fitted = bodies[body.link];
        fitted.is_of_visual = body.source == BodySource::visual;
        if (body.fit) fitted.capsules = capsules_of(body);
    }
    const auto text = rig::read_urdf_text(urdf);
    if (!text) return unexpected(text.error());
    auto fitted = rig::urdf_with_bodies(urdf.shown(), *text, bodies);
    if (!fitted) return unexpected(fitted.error());
    robot.urdf = *std::move(fitted);
    return robot;
}

}  // namespace octoskin
