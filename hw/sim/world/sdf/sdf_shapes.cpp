#include "hw/sim/world/sdf/sdf_shapes.hpp"

#include <cmath>
#include <ignition/math/eigen3/Conversions.hh>
#include <optional>
#include <sdf/sdf.hh>
#include <string_view>

#include "hw/mesh/mesh_file.hpp"
#include "hw/sim/world/model_folders.hpp"
#include "hw/sim/world/shapes.hpp"

namespace octoskin::sim {
namespace {

using ignition::math::eigen3::convert;
using MeshOrError = Result<TriangleMesh, std::string>;

/// Larger than a robot's cell. A ground plane has no limit.
constexpr double kSizeMax_m = 100.0;

bool is_positive(double value) {
    return std::isfinite(value) && value > 0.0;
}

bool is_size(double value) {
    return is_positive(value) && value <= kSizeMax_m;
}

MeshOrError checked(bool sizes_are_good, const TriangleMesh& mesh) {
    if (!sizes_are_good) {
        return unexpected(
            std::string("expected sizes in metres, above 0 and up to 100: is it written in millimetres?"));
    }
    return mesh;
}

MeshOrError box_of(const sdf::Box& box) {
    const Eigen::Vector3d size = convert(box.Size());
    return checked(is_size(size.x()) && is_size(size.y()) && is_size(size.z()), box_mesh(size));
}

MeshOrError plane_of(const sdf::Plane& plane) {
    const Eigen::Vector2d size(plane.Size().X(), plane.Size().Y());
    return checked(is_positive(size.x()) && is_positive(size.y()), plane_mesh(convert(plane.Normal()), size));
}

MeshOrError ellipsoid_of(const sdf::Ellipsoid& ellipsoid) {
    const Eigen::Vector3d radii = convert(ellipsoid.Radii());
    return checked(is_size(radii.x()) && is_size(radii.y()) && is_size(radii.z()), ellipsoid_mesh(radii));
}

MeshOrError mesh_file_of(const sdf::Mesh& mesh, const SdfInput& world) {
    if (!mesh.Submesh().empty()) {
        return unexpected("submesh '" + mesh.Submesh() +
                          "' is not supported; give it a mesh file of its own");
    }
    constexpr std::string_view kFileScheme = "file://";
    std::string uri = mesh.Uri();
    if (uri.starts_with(kFileScheme)) {
        uri.erase(0, kFileScheme.size());
    } else if (uri.starts_with(kModelScheme) && world.files == nullptr) {
        const auto found = find_model_file(uri);
        if (!found) {
            return unexpected("mesh uri '" + uri + "': no such file in any folder of " + kModelFoldersHint);
        }
        uri = std::filesystem::absolute(*found).string();
    } else if (uri.find("://") != std::string::npos) {
        return unexpected("mesh uri '" + uri +
                          "' is not supported; expected a path relative to the SDF file" +
                          (world.files == nullptr ? ", or model://; octoskin fetches nothing" : ""));
    }
    // Without an <include> every element is in this file. The path of a checked descriptor does not give its
    // name.
    const std::filesystem::path file =
        world.files == nullptr ? std::filesystem::path(mesh.FilePath()) : world.file;
    auto read = read_mesh(file.parent_path() / uri, world.files);
    if (!read) {
        return read;
    }
    const Eigen::Vector3d scale = convert(mesh.Scale());
    if (!scale.allFinite() || scale.prod() == 0.0) {
        return unexpected(std::string("expected a mesh scale that is finite and not zero"));
    }
    for (auto& vertex : read->vertices) {
        vertex = vertex.cwiseProduct(scale);
    }
    return read;
}

}  // namespace

Result<TriangleMesh, std::string> mesh_of(const sdf::Geometry& geometry, const SdfInput& world) {
    switch (geometry.Type()) {
        case sdf::GeometryType::BOX:
            return box_of(*geometry.BoxShape());
        case sdf::GeometryType::CYLINDER: {
            const auto& shape = *geometry.CylinderShape();
            return checked(is_size(shape.Radius()) && is_size(shape.Length()),
                           cylinder_mesh(shape.Radius(), shape.Length()));
        }
        case sdf::GeometryType::SPHERE: {
            const double radius = geometry.SphereShape()->Radius();
            return checked(is_size(radius), ellipsoid_mesh(Eigen::Vector3d::Constant(radius)));
        }
        case sdf::GeometryType::CAPSULE: {
            const auto& shape = *geometry.CapsuleShape();
            return checked(is_size(shape.Radius()) && is_size(shape.Length()),
                           capsule_mesh(shape.Radius(), shape.Length()));
        }
        case sdf::GeometryType::ELLIPSOID:
            return ellipsoid_of(*geometry.EllipsoidShape());
        case sdf::GeometryType::PLANE:
            return plane_of(*geometry.PlaneShape());
        case sdf::GeometryType::MESH:
            return mesh_file_of(*geometry.MeshShape(), world);
        case sdf::GeometryType::HEIGHTMAP:
        case sdf::GeometryType::EMPTY:
            break;
    }
    const auto element = geometry.Element();
    const auto shape = element ? element->GetFirstElement() : nullptr;
    // An element unknown to sdformat has no line.
    const auto line = element ? element->LineNumber() : std::nullopt;
    std::string what = line ? "line " + std::to_string(*line) + ": " : "";
    what += "unsupported shape '" + (shape ? shape->GetName() : "empty");
    return unexpected(what + "'; supported shapes are " + kSdfShapes);
}

}  // namespace octoskin::sim
