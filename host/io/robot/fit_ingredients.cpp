#include "host/io/robot/fit_ingredients.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>

#include "host/io/digest/sha256.hpp"
#include "host/io/mesh/mesh_copy.hpp"
#include "host/io/robot/body_shapes.hpp"
#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin {
namespace {

using rig::LinkShape;
using rig::ShapeKind;

constexpr std::uintmax_t kRobotBytesMax = std::uintmax_t{1} << 30U;

/// The digests of a robot's meshes. A file is read once, whatever names it has.
class Digests {
  public:
    explicit Digests(const RobotText& robot, const MeshSearch& search) : places_(robot.file, search) {}

    [[nodiscard]] Result<std::string, Error> of(const std::string& mesh) {
        const auto place = places_.find(mesh);
        if (!place) return unexpected(place.error());
        const auto known = of_files_.find(place->shown());
        return known != of_files_.end() ? known->second
                                        : of_files_.emplace(place->shown(), read(*place)).first->second;
    }

  private:
    [[nodiscard]] Result<std::string, Error> read(const FilePlace& place) {
        auto digest = mesh_sha256(place, bytes_left_);
        if (digest) return digest;
        Error error = digest.error();
        error.what = error.file.string() + ": " + error.what;
        return unexpected(std::move(error));
    }

    MeshPlaces places_;
    std::uintmax_t bytes_left_ = kRobotBytesMax;
    std::map<std::filesystem::path, Result<std::string, Error>> of_files_;
};

}  // namespace

Result<RobotText, Error> read_robot_text(const FilePlace& urdf, const std::string& base_link) {
    auto text = rig::read_urdf_text(urdf);
    if (!text) return unexpected(text.error());
    auto shapes = rig::read_link_shapes(FilePlace::held(*text, urdf), base_link);
    if (!shapes) return unexpected(shapes.error());
    return RobotText{urdf, *std::move(text), *std::move(shapes)};
}

bool needs_fit(const rig::RobotShapes& shapes) {
    return std::ranges::any_of(shapes.links, [](const rig::ShapedLink& link) {
        return std::ranges::find(link.collisions, ShapeKind::mesh, &LinkShape::kind) != link.collisions.end();
    });
}

std::string FitIngredients::key(std::string_view program) const {
    Sha256 digest;
    digest.add_field(program);
    digest.add_field(base_link);
    digest.add_field(urdf);
    for (const auto& [mesh, sha256] : mesh_sha256) {
        digest.add_field(mesh);
        digest.add_field(sha256);
    }
    return digest.hexadecimal();
}

Result<FitIngredients, Error> find_ingredients(const RobotText& robot, const MeshSearch& search) {
    FitIngredients found{robot.shapes.base_link, robot.text, {}};
    Digests digests(robot, search);
    std::vector<rig::ElementFault> faults;
    for (const rig::ShapedLink& link : robot.shapes.links) {
        for (const LinkShape& shape : body_shapes(link)) {
            if (shape.kind != ShapeKind::mesh || found.mesh_sha256.contains(shape.mesh)) continue;
            auto digest = digests.of(shape.mesh);
            if (!digest) {
                Error error = digest.error();
                error.file = robot.file.shown();
                error.line = shape.line;
                error.key = "link " + link.name;
                faults.push_back({std::move(error), shape.mesh});
            }
            found.mesh_sha256.emplace(shape.mesh, digest ? *std::move(digest) : std::string());
        }
    }
    if (!faults.empty()) return unexpected(rig::one_error_of(std::move(faults)));
    return found;
}

}  // namespace octoskin
