#include "host/io/robot/surface_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "host/io/mesh/mesh_copy.hpp"
#include "host/io/mesh/mesh_process.hpp"
#include "host/io/robot/body_shapes.hpp"
#include "hw/rigfile/fitted_urdf.hpp"

namespace octoskin {
namespace {

using rig::LinkShape;
using rig::ShapedLink;
using rig::ShapeKind;

constexpr double kReachMax_m = 5.0;
constexpr double kExtentMin_m = 0.005;
constexpr std::size_t kShapesMax = 1000;  ///< limit of a URDF for the rig
constexpr std::size_t kLinkTrianglesMax = 2'000'000;
constexpr std::size_t kRobotTrianglesMax = 8'000'000;

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

Error too_many(const std::string& of, std::size_t most, std::size_t found) {
    return {.code = ErrorCode::too_large,
            .what = fmt::format("expected at most {} triangles of {}", most, of),
            .value = fmt::format("{} or more", found),
            .remedy = "export the meshes with fewer triangles"};
}

constexpr Nanoseconds kReadingMax = std::chrono::seconds(300);

/// Adds the time of its life to `sum`.
class Stopwatch {
  public:
    explicit Stopwatch(Nanoseconds& sum) : sum_(sum) {}
    ~Stopwatch() { sum_ += std::chrono::steady_clock::now() - begun_; }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    Nanoseconds& sum_;
    std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

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
        return Error{
            .code = ErrorCode::too_large,
            .what = fmt::format("expected a shape within {} m of its link's origin", kReachMax_m),
            .value = fmt::format("{:.4g} m", farthest_m),
            .remedy = "is it a mesh that is written in millimetres? Then add scale=\"0.001 0.001 0.001\""};
    }
    const double extent_m = box.sizes().maxCoeff();
    if (extent_m >= kExtentMin_m - 1e-9) return std::nullopt;
    return Error{
        .code = ErrorCode::out_of_range,
        .what = fmt::format("expected meshes and boxes of at least {} mm together", 1e3 * kExtentMin_m),
        .value = fmt::format("{:.4g} mm", 1e3 * extent_m),
        .remedy = "is it scaled twice? If the link is a frame, remove its shape"};
}

}  // namespace

SurfaceReader::SurfaceReader(const FilePlace& urdf, const MeshSearch& search)
    : urdf_(urdf.shown()), places_(urdf, search) {}

std::optional<SurfaceMesh> SurfaceReader::read(const ShapedLink& link,
                                               const Eigen::Isometry3d& T_link_surface) {
    std::erase_if(meshes_, [](const auto& mesh) { return mesh.second.has_value(); });
    auto surface = append_all(link, T_link_surface);
    if (!surface) {
        fail(link, surface.error(), "too large");
        return std::nullopt;
    }
    triangles_ += surface->triangles.size();
    if (auto fault = size_fault(*surface, T_link_surface)) {
        // A mark that shows where a frame is, and no body.
        const bool is_mark = fault->code == ErrorCode::out_of_range && source_of(link) == BodySource::visual;
        if (is_mark) return SurfaceMesh{};
        const char* const kind = fault->code == ErrorCode::too_large ? "too large" : "too small";
        fail(link, *std::move(fault), kind);
        return std::nullopt;
    }
    return *std::move(surface);
}

void SurfaceReader::fail(const ShapedLink& link, Error error, const std::string& kind) {
    error.file = urdf_;
    error.line = link.line;
    error.key = "link " + link.name;
    faults_.push_back({std::move(error), kind});
}

std::optional<Error> SurfaceReader::error() const {
    if (faults_.empty()) return std::nullopt;
    return rig::one_error_of(faults_);
}

Result<SurfaceMesh, Error> SurfaceReader::append_all(const ShapedLink& link,
                                                     const Eigen::Isometry3d& T_link_surface) {
    SurfaceMesh surface;
    if (body_shapes(link).size() > kShapesMax) {
        return unexpected(Error{.code = ErrorCode::limit_exceeded,
                                .what = fmt::format("expected at most {} shapes of a link", kShapesMax),
                                .value = std::to_string(body_shapes(link).size()),
                                .remedy = "merge its meshes"});
    }
    for (const LinkShape& shape : body_shapes(link)) {
        if (!is_fitted(shape)) continue;
        const Eigen::Affine3d T_surface_shape(T_link_surface.inverse() * shape.T_link_shape);
        if (shape.kind == ShapeKind::box) append(box_surface(shape.size), T_surface_shape, surface);
        if (shape.kind != ShapeKind::mesh) continue;
        const SurfaceMesh* const mesh = find(shape, link.name);
        if (mesh == nullptr) continue;
        const std::size_t count = surface.triangles.size() + mesh->triangles.size();
        if (count > kLinkTrianglesMax) return unexpected(too_many("a link", kLinkTrianglesMax, count));
        if (triangles_ + count > kRobotTrianglesMax)
            return unexpected(too_many("all links together", kRobotTrianglesMax, triangles_ + count));
        append(*mesh, T_surface_shape * Eigen::Scaling(shape.size), surface);
    }
    return surface;
}

/// Null, with a fault the first time, if it cannot be read.
const SurfaceMesh* SurfaceReader::find(const LinkShape& shape, const std::string& link) {
    auto known = meshes_.find(shape.mesh);
    if (known == meshes_.end()) {
        auto mesh = read_mesh(shape);
        if (!mesh) {
            Error error = mesh.error();
            // The URDF is named as the file of the error, and the mesh in its sentence.
            if (!error.file.empty()) error.what = error.file.string() + ": " + error.what;
            error.file = urdf_;
            error.line = shape.line;
            error.key = "link " + link;
            faults_.push_back({std::move(error), shape.mesh});
        }
        known = meshes_.emplace(shape.mesh, mesh ? std::optional(*std::move(mesh)) : std::nullopt).first;
    }
    return known->second ? &*known->second : nullptr;
}

Result<SurfaceMesh, Error> SurfaceReader::read_mesh(const LinkShape& shape) {
    const auto place = places_.find(shape.mesh);
    if (!place) {
        Error error = place.error();
        error.file.clear();
        return unexpected(std::move(error));
    }
    // Each link reads its meshes anew, and a file may have any number of names.
    if (reading_ > kReadingMax) {
        return unexpected(Error{.code = ErrorCode::limit_exceeded,
                                .what = "expected meshes that are read within 300 s together",
                                .remedy = "export them with fewer triangles"});
    }
    const Stopwatch watch(reading_);
    if (const auto failed = unreadable_.find(place->shown()); failed != unreadable_.end())
        return unexpected(failed->second);
    const auto copy = copy_mesh(*place);
    if (!copy) return unexpected(copy.error());
    const auto [known, is_new] = sha256_.emplace(shape.mesh, copy->sha256);
    if (!is_new && known->second != copy->sha256) {
        return unexpected(Error{.code = ErrorCode::mismatch,
                                .what = "changed while the robot was read",
                                .remedy = "try again",
                                .file = place->shown()});
    }
    auto read = read_mesh_in_process(*copy);
    if (!read) {
        unreadable_.emplace(place->shown(), read.error());
        return unexpected(read.error());
    }
    files_[shape.mesh] = place->shown();
    return SurfaceMesh{std::move(read->vertices), std::move(read->triangles)};
}

Result<RobotSurfaces, Error> read_surfaces(const RobotText& robot, const MeshSearch& search) {
    RobotSurfaces found;
    SurfaceReader reader(robot.file, search);
    std::map<std::string, rig::FittedBody> rest;
    for (const ShapedLink& link : robot.shapes.links) {
        rest[link.name].is_of_visual = source_of(link) == BodySource::visual;
        auto surface = reader.read(link);
        if (surface && !surface->triangles.empty()) found.meshes.push_back({link.name, *std::move(surface)});
    }
    if (const auto error = reader.error()) return unexpected(*error);
    auto urdf = rig::urdf_with_bodies(robot.file.shown(), robot.text, rest);
    if (!urdf) return unexpected(urdf.error());
    found.urdf = *std::move(urdf);
    return found;
}

}  // namespace octoskin
