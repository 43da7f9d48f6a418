#include "hw/rigfile/robot_description.hpp"

#include <fmt/format.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/fitted_urdf.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "hw/rigfile/urdf_pose.hpp"

namespace octoskin::rig {
namespace {

constexpr double kRoundingM = 1e-9;
constexpr double kSameM = 1e-4;  ///< a sphere is a cylinder's end if place and radius differ by at most this
constexpr double kRadiusMaxM = 5.0;
constexpr std::size_t kCollisionsMax = 1000;  ///< of one link: each sphere is compared with each cylinder

/// A cylinder from face centre to face centre.
struct Cylinder {
    Capsule capsule;
    bool is_round_a = false;  ///< a sphere of the link forms this end
    bool is_round_b = false;
};

/// The capsule that encloses an element, and one that lies within it.
struct Fitted {
    Capsule around;
    Capsule within;
    bool is_from_mesh = false;  ///< fitted to a mesh, which it reaches beyond: nothing is known to lie within
};

/// The collision elements of one link, by shape.
struct Bodies {
    std::vector<Cylinder> cylinders;
    std::vector<Capsule> spheres;
    std::vector<Fitted> boxes;  ///< not combined with spheres
};

const char* shape_name(const urdf::Geometry& geometry) {
    switch (geometry.type) {
        case urdf::Geometry::SPHERE:
            return "sphere";
        case urdf::Geometry::BOX:
            return "box";
        case urdf::Geometry::CYLINDER:
            return "cylinder";
        case urdf::Geometry::MESH:
            return "mesh";
    }
    return "shape";
}

std::string name_of(const urdf::Collision& collision) {
    return collision.name.empty() ? "its <collision>"
                                  : fmt::format("<collision name=\"{}\">", collision.name);
}

/// Two capsules along the box's longest axis: the one through its corners, and the largest within it.
Fitted fit_box(const urdf::Vector3& size_m, const std::string& link, const Eigen::Isometry3d& T_link_body) {
    const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(size_m.x, size_m.y, size_m.z);
    Eigen::Index longest = 0;
    half.maxCoeff(&longest);
    const auto along = [&](double reach_m, double radius_m) {
        const Eigen::Vector3d to_end = reach_m * Eigen::Vector3d::Unit(longest);
        return Capsule{link, T_link_body * Eigen::Vector3d(-to_end), T_link_body * to_end, radius_m};
    };
    const Eigen::Vector3d across = half - half[longest] * Eigen::Vector3d::Unit(longest);
    return {along(half[longest], across.norm()), along(half[longest] - half.minCoeff(), half.minCoeff())};
}

/// The largest capsule along the axis that stays within the flat ends.
Capsule within_cylinder(const Cylinder& cylinder) {
    Capsule within = cylinder.capsule;
    const Eigen::Vector3d axis = within.p_link_b - within.p_link_a;
    const double length_m = axis.norm();
    const double flat_ends = (cylinder.is_round_a ? 0.0 : 1.0) + (cylinder.is_round_b ? 0.0 : 1.0);
    // At most half the length with the round ends: the capsule of a flat disc is a ball that touches both
    // ends.
    within.radius_m =
        std::min(within.radius_m, 0.5 * (length_m + (2.0 - flat_ends) * cylinder.capsule.radius_m));
    if (length_m == 0.0) return within;
    const auto moved_in = [&](bool is_round) -> Eigen::Vector3d {
        const double in_m = within.radius_m - (is_round ? cylinder.capsule.radius_m : 0.0);
        return in_m / length_m * axis;
    };
    within.p_link_a += moved_in(cylinder.is_round_a);
    within.p_link_b -= moved_in(cylinder.is_round_b);
    return within;
}

std::string remedy_for(const urdf::Geometry& refused) {
    if (refused.type == urdf::Geometry::MESH)
        return "fit capsules with `octoskin robot FILE --out FITTED.urdf` and use that file, or remove it";
    const std::string remedy = "replace it by one that encloses it, or remove it";
    return refused.type == urdf::Geometry::BOX ? remedy + "; or set `fits_capsules: true` in the rig"
                                               : remedy;
}

/// Adds one collision element to `bodies`. Returns an error if it is refused.
std::optional<Error> add_body(const urdf::Collision& collision, const std::string& link, BoxRule boxes,
                              Bodies& bodies) {
    if (!collision.geometry)
        return Error{ErrorCode::missing_key, fmt::format("{} has no geometry", name_of(collision))};
    const Eigen::Isometry3d T_link_body = urdf_isometry(collision.origin);
    Capsule body{link, T_link_body.translation(), T_link_body.translation(), 0.0};
    double length_m = 0.0;
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision.geometry.get())) {
        length_m = cylinder->length;
        body.radius_m = cylinder->radius;
        body.p_link_a = T_link_body * Eigen::Vector3d(0.0, 0.0, -length_m / 2.0);
        body.p_link_b = T_link_body * Eigen::Vector3d(0.0, 0.0, length_m / 2.0);
        bodies.cylinders.push_back({.capsule = body});
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision.geometry.get())) {
        body.radius_m = sphere->radius;
        bodies.spheres.push_back(body);
    } else if (const auto* box = dynamic_cast<const urdf::Box*>(collision.geometry.get());
               box != nullptr && boxes == BoxRule::fitted) {
        length_m = std::min({box->dim.x, box->dim.y, box->dim.z});
        bodies.boxes.push_back(fit_box(box->dim, link, T_link_body));
        body = bodies.boxes.back().around;
    } else {
        return Error{
            ErrorCode::unsupported,
            fmt::format("expected a cylinder or a sphere (two spheres and a cylinder are a capsule) as {}",
                        name_of(collision)),
            fmt::format("a {}", shape_name(*collision.geometry)), remedy_for(*collision.geometry)};
    }
    const bool is_sound = T_link_body.matrix().allFinite() && body.radius_m > 0.0 &&
                          body.radius_m <= kRadiusMaxM && length_m >= 0.0 && length_m <= kRadiusMaxM;
    if (is_sound) return std::nullopt;
    return Error{.code = ErrorCode::out_of_range,
                 .what = fmt::format("{} has a place that is not finite, or a size that is not within {} m",
                                     name_of(collision), kRadiusMaxM),
                 .remedy = "is it written in metres?"};
}

/// The end of a cylinder is set to the centre of the first sphere at that end, which has no rounding from a
/// rotation. Further spheres there do not move it on.
bool absorb(const Capsule& sphere, Cylinder& cylinder) {
    if (std::abs(sphere.radius_m - cylinder.capsule.radius_m) > kSameM) return false;
    const auto is_end = [&](Eigen::Vector3d& end, bool& is_round) {
        if ((end - sphere.p_link_a).norm() > (is_round ? kRoundingM : kSameM)) return false;
        if (!is_round) end = sphere.p_link_a;
        is_round = true;
        return true;
    };
    return is_end(cylinder.capsule.p_link_a, cylinder.is_round_a) ||
           is_end(cylinder.capsule.p_link_b, cylinder.is_round_b);
}

std::vector<Fitted> to_capsules(Bodies bodies) {
    std::vector<Fitted> lone_spheres;
    for (const Capsule& sphere : bodies.spheres) {
        bool is_end = false;
        // A sphere may form the end of two cylinders that meet there.
        for (Cylinder& cylinder : bodies.cylinders) is_end = absorb(sphere, cylinder) || is_end;
        if (!is_end) lone_spheres.push_back({sphere, sphere});
    }
    std::vector<Fitted> all;
    for (const Cylinder& cylinder : bodies.cylinders)
        all.push_back({cylinder.capsule, within_cylinder(cylinder)});
    std::move(lone_spheres.begin(), lone_spheres.end(), std::back_inserter(all));
    std::move(bodies.boxes.begin(), bodies.boxes.end(), std::back_inserter(all));
    return all;
}

BoxRule box_rule(const Rig& rig) {
    return rig.fits_capsules ? BoxRule::fitted : BoxRule::refused;
}

/// The collision elements of every link.
Result<std::vector<Fitted>, Error> read_fitted(const FilePlace& urdf,
                                               const std::map<std::string, double>& link_padding_m,
                                               BoxRule boxes) {
    auto document = UrdfDocument::read(urdf);
    if (!document) return unexpected(document.error());
    const auto& links = document->model().links_;
    for (const auto& [link, padding_m] : link_padding_m) {
        if (!links.contains(link)) {
            return unexpected(document->error(
                "link", link,
                {ErrorCode::unknown_name, "padded in the rig, but the robot has no such link"}));
        }
    }
    std::vector<Fitted> all;
    std::vector<ElementFault> faults;
    for (const auto& [name, link] : links) {
        Bodies bodies;
        if (link->collision_array.size() > kCollisionsMax) {
            return unexpected(
                document->error("link", name,
                                {ErrorCode::limit_exceeded,
                                 fmt::format("expected at most {} <collision> elements", kCollisionsMax),
                                 std::to_string(link->collision_array.size()), "use fewer, larger shapes"}));
        }
        for (const auto& collision : link->collision_array) {
            auto fault = add_body(*collision, name, boxes, bodies);
            if (!fault) continue;
            faults.push_back({document->error("link", name, *std::move(fault)),
                              collision->geometry ? shape_name(*collision->geometry) : "no geometry"});
            break;
        }
        const bool is_from_mesh = std::ranges::any_of(link->collision_array, [](const auto& collision) {
            return std::string_view(collision->name).starts_with(kFittedName);
        });
        const auto padding = link_padding_m.find(name);
        for (Fitted& element : to_capsules(std::move(bodies))) {
            element.is_from_mesh = is_from_mesh;
            if (padding != link_padding_m.end()) element.around.radius_m += padding->second;
            all.push_back(std::move(element));
        }
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    return all;
}

Result<std::vector<Capsule>, Error> all_of(const Result<std::vector<Fitted>, Error>& elements,
                                           Capsule Fitted::*which) {
    if (!elements) return unexpected(elements.error());
    std::vector<Capsule> capsules;
    for (const Fitted& element : *elements) capsules.push_back(element.*which);
    return capsules;
}

/// With the capsules that the rig attaches, without padding.
Result<std::vector<Capsule>, Error> with_attached(Result<std::vector<Capsule>, Error> body, const Rig& rig) {
    if (!body) return body;
    for (const AttachedCapsule& capsule : rig.attached_capsules)
        body->push_back({capsule.link, capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
    return body;
}

}  // namespace

Result<std::vector<Capsule>, Error> real_body(const Rig& rig) {
    return with_attached(read_capsules(rig.urdf, {}, box_rule(rig)), rig);
}

Result<std::vector<Capsule>, Error> certain_body(const Rig& rig) {
    return with_attached(read_inner_capsules(rig.urdf, box_rule(rig)), rig);
}

Result<std::vector<Capsule>, Error> padded_body(const Rig& rig) {
    auto body = read_capsules(rig.urdf, rig.link_padding_m, box_rule(rig));
    if (!body) return body;
    for (const AttachedCapsule& capsule : rig.attached_capsules) {
        const auto of_link = rig.link_padding_m.find(capsule.link);
        const double link_padding_m = of_link == rig.link_padding_m.end() ? 0.0 : of_link->second;
        body->push_back({capsule.link, capsule.p_link_a, capsule.p_link_b,
                         capsule.radius_m + capsule.padding_m + link_padding_m});
    }
    return body;
}

Result<std::vector<Capsule>, Error> read_capsules(const FilePlace& urdf,
                                                  const std::map<std::string, double>& link_padding_m,
                                                  BoxRule boxes) {
    return all_of(read_fitted(urdf, link_padding_m, boxes), &Fitted::around);
}

Result<std::vector<Capsule>, Error> read_inner_capsules(const FilePlace& urdf, BoxRule boxes) {
    auto elements = read_fitted(urdf, {}, boxes);
    if (elements) std::erase_if(*elements, &Fitted::is_from_mesh);
    return all_of(elements, &Fitted::within);
}

}  // namespace octoskin::rig
