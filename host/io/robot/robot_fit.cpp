#include "host/io/robot/robot_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "host/core/body_fit/fit_work.hpp"
#include "host/io/robot/surface_reader.hpp"
#include "hw/rigfile/fitted_urdf.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin {
namespace {

constexpr std::uint64_t kRobotWorkMost = 20 * FitWork::kMost;
/// The search of one link's capsules, which FitWork does not count: about a second.
constexpr std::uint64_t kSearchWork = FitWork::kMost / 16;

using rig::LinkShape;
using rig::ShapedLink;
using rig::ShapeKind;

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
    const auto& shapes = body_shapes(link);
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
    Fitting(const FilePlace& urdf, const MeshSearch& search, const OnLinkFit& on_link)
        : surfaces_(urdf, search), on_link_(on_link) {}

    LinkBody fit(const ShapedLink& link) {
        LinkBody body{.link = link.name, .is_moving = link.is_moving, .source = source_of(link)};
        body.shapes = counted(body_shapes(link));
        body.kept =
            static_cast<std::size_t>(std::ranges::count_if(body_shapes(link), [](const LinkShape& shape) {
                return rig::is_body(shape) && !is_fitted(shape);
            }));
        const bool has_work = surfaces_.faults().empty() && std::ranges::any_of(body_shapes(link), is_fitted);
        if (on_link_ && has_work) on_link_(link.name);
        const auto box = lone_box(link);
        const Eigen::Isometry3d T_link_surface = box ? box->T_link_shape : Eigen::Isometry3d::Identity();
        const auto surface = surfaces_.read(link, T_link_surface);
        // A robot that is refused is fitted no further, but all of its faults are named.
        if (!surface || surface->triangles.empty() || !surfaces_.faults().empty()) return body;
        body.triangles = surface->triangles.size();
        for (const LinkShape& shape : body_shapes(link)) {
            const auto file = surfaces_.mesh_files().find(shape.mesh);
            if (shape.kind != ShapeKind::mesh || file == surfaces_.mesh_files().end()) continue;
            if (std::ranges::find(body.files, file->second.string()) == body.files.end())
                body.files.push_back(file->second.string());
        }
        body.mesh = part_of(*surface, T_link_surface);
        const auto fit = box ? fit_of_box(box->size, *surface) : fit_capsules(*surface);
        if (!fit) {
            surfaces_.fail(link,
                           {.code = ErrorCode::too_large,
                            .what = "expected a surface that capsules can be fitted to",
                            .value = fmt::format("{} triangles, too many of them large and across each other",
                                                 body.triangles),
                            .remedy = "export the outer surface alone"},
                           "too much work");
            return body;
        }
        body.fit = moved(*fit, T_link_surface);
        work_ += fit->work + (box ? 0 : kSearchWork);
        if (work_ > kRobotWorkMost) {
            surfaces_.fail(link,
                           {.code = ErrorCode::too_large,
                            .what = "expected a robot whose links can be fitted in a few minutes",
                            .value = "more work up to this link",
                            .remedy = "export its meshes with fewer triangles, or give links capsules"},
                           "too much work");
        }
        return body;
    }

    [[nodiscard]] const SurfaceReader& surfaces() const noexcept { return surfaces_; }

  private:
    std::optional<BodyFit> fit_of_box(const Eigen::Vector3d& size, const SurfaceMesh& surface) {
        const std::array key{size.x(), size.y(), size.z()};
        if (const auto known = boxes_.find(key); known != boxes_.end()) return known->second;
        return boxes_.emplace(key, fit_capsules(surface)).first->second;
    }

    SurfaceReader surfaces_;
    const OnLinkFit& on_link_;
    std::uint64_t work_ = 0;  ///< of all links so far
    std::map<std::array<double, 3>, std::optional<BodyFit>> boxes_;
};

std::vector<rig::Capsule> capsules_of(const LinkBody& body) {
    std::vector<rig::Capsule> capsules;
    for (const PosedCapsule& capsule : body.fit->capsules)
        capsules.push_back({body.link, capsule.p_a, capsule.p_b, capsule.radius_m});
    return capsules;
}

}  // namespace

Result<RobotFit, Error> fit_robot(const RobotText& robot, const MeshSearch& search,
                                  const OnLinkFit& on_link) {
    RobotFit fit{.shapes = robot.shapes, .links = {}, .urdf = {}, .made_of = {}};
    Fitting fitting(robot.file, search, on_link);
    for (const ShapedLink& link : fit.shapes.links) fit.links.push_back(fitting.fit(link));
    if (const auto error = fitting.surfaces().error()) return unexpected(*error);
    std::map<std::string, rig::FittedBody> bodies;
    for (const LinkBody& body : fit.links) {
        rig::FittedBody& fitted = bodies[body.link];
        fitted.is_of_visual = body.source == BodySource::visual;
        if (body.fit) fitted.capsules = capsules_of(body);
    }
    auto fitted = rig::urdf_with_bodies(robot.file.shown(), robot.text, bodies);
    if (!fitted) return unexpected(fitted.error());
    const FilePlace written = FilePlace::held(*fitted, robot.file);
    if (const auto usable = rig::read_capsules(written, {}); !usable) return unexpected(usable.error());
    fit.urdf = *std::move(fitted);
    fit.made_of = {fit.shapes.base_link, robot.text, fitting.surfaces().mesh_sha256()};
    return fit;
}

}  // namespace octoskin
