#include "hw/rigfile/robot_description.hpp"

#include <fmt/format.h>
#include <urdf_model/link.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "hw/rigfile/urdf_pose.hpp"

namespace octoskin::rig {
namespace {

constexpr double kSameM =
    1e-4;  ///< a sphere this close to a cylinder's end, and this close in radius, is its end
constexpr double kRadiusMaxM = 5.0;
constexpr std::size_t kCollisionsMax = 1000;  ///< of one link: each sphere is looked for at each cylinder

/// One link's collision elements, cylinders apart from spheres.
struct Bodies {
    std::vector<Capsule> cylinders;  ///< ends at the centres of the flat faces
    std::vector<Capsule> spheres;
    std::vector<Capsule> fitted;  ///< about boxes: ends of nothing else
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

/// The capsule about the box's longest side, through its middle, that its corners lie on.
Capsule around_box(const urdf::Vector3& size_m, const std::string& link,
                   const Eigen::Isometry3d& T_link_body) {
    const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(size_m.x, size_m.y, size_m.z);
    Eigen::Index longest = 0;
    half.maxCoeff(&longest);
    const Eigen::Vector3d to_end = half[longest] * Eigen::Vector3d::Unit(longest);
    return {link, T_link_body * Eigen::Vector3d(-to_end), T_link_body * to_end, (half - to_end).norm()};
}

/// Adds one collision element to `bodies`; returns what is wrong with it, or nothing.
std::string add_body(const urdf::Collision& collision, const std::string& link, BoxRule boxes,
                     Bodies& bodies) {
    if (!collision.geometry) return fmt::format("{} has no geometry", name_of(collision));
    const Eigen::Isometry3d T_link_body = urdf_isometry(collision.origin);
    Capsule body{link, T_link_body.translation(), T_link_body.translation(), 0.0};
    double length_m = 0.0;
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision.geometry.get())) {
        length_m = cylinder->length;
        body.radius_m = cylinder->radius;
        body.p_link_a = T_link_body * Eigen::Vector3d(0.0, 0.0, -length_m / 2.0);
        body.p_link_b = T_link_body * Eigen::Vector3d(0.0, 0.0, length_m / 2.0);
        bodies.cylinders.push_back(body);
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision.geometry.get())) {
        body.radius_m = sphere->radius;
        bodies.spheres.push_back(body);
    } else if (const auto* box = dynamic_cast<const urdf::Box*>(collision.geometry.get());
               box != nullptr && boxes == BoxRule::fitted) {
        length_m = std::min({box->dim.x, box->dim.y, box->dim.z});
        body = around_box(box->dim, link, T_link_body);
        bodies.fitted.push_back(body);
    } else {
        return fmt::format(
            "{} is a {}: expected a cylinder or a sphere (two spheres and a cylinder are a capsule); put one "
            "around it in its place, or remove it{}",
            name_of(collision), shape_name(*collision.geometry),
            collision.geometry->type == urdf::Geometry::BOX ? "; or let the rig have `fits_capsules: true`"
                                                            : "");
    }
    const bool is_sound = T_link_body.matrix().allFinite() && body.radius_m > 0.0 &&
                          body.radius_m <= kRadiusMaxM && length_m >= 0.0 && length_m <= kRadiusMaxM;
    return is_sound ? ""
                    : fmt::format("{} has a size or place that is not finite and within {} m: metres?",
                                  name_of(collision), kRadiusMaxM);
}

/// A cylinder takes its end from the sphere at that end: the sphere's centre is written without a rotation.
bool absorb(const Capsule& sphere, Capsule& cylinder) {
    if (std::abs(sphere.radius_m - cylinder.radius_m) > kSameM) return false;
    for (Eigen::Vector3d* end : {&cylinder.p_link_a, &cylinder.p_link_b}) {
        if ((*end - sphere.p_link_a).norm() > kSameM) continue;
        *end = sphere.p_link_a;
        return true;
    }
    return false;
}

std::vector<Capsule> to_capsules(Bodies bodies) {
    std::vector<Capsule> capsules = std::move(bodies.cylinders);
    const std::size_t cylinders = capsules.size();
    for (const Capsule& sphere : bodies.spheres) {
        bool is_end = false;
        // A sphere may end two cylinders that meet in it.
        for (std::size_t i = 0; i < cylinders; ++i) is_end = absorb(sphere, capsules[i]) || is_end;
        if (!is_end) capsules.push_back(sphere);
    }
    std::move(bodies.fitted.begin(), bodies.fitted.end(), std::back_inserter(capsules));
    return capsules;
}

BoxRule box_rule(const Rig& rig) {
    return rig.fits_capsules ? BoxRule::fitted : BoxRule::refused;
}

}  // namespace

Result<std::vector<Capsule>, RigError> real_body(const Rig& rig) {
    auto body = read_capsules(rig.urdf, {}, box_rule(rig));
    if (!body) return body;
    for (const AttachedCapsule& capsule : rig.attached_capsules)
        body->push_back({capsule.link, capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
    return body;
}

Result<std::vector<Capsule>, RigError> padded_body(const Rig& rig) {
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

Result<std::vector<Capsule>, RigError> read_capsules(const FilePlace& urdf,
                                                     const std::map<std::string, double>& link_padding_m,
                                                     BoxRule boxes) {
    auto document = UrdfDocument::read(urdf);
    if (!document) return unexpected(document.error());
    const auto& links = document->model().links_;
    for (const auto& [link, padding_m] : link_padding_m) {
        if (!links.contains(link)) {
            return unexpected(
                document->error("link", link, "padded in the rig, but the robot has no such link"));
        }
    }
    std::vector<Capsule> all;
    std::vector<ElementFault> faults;
    for (const auto& [name, link] : links) {
        Bodies bodies;
        if (link->collision_array.size() > kCollisionsMax) {
            return unexpected(document->error(
                "link", name,
                fmt::format("expected at most {} <collision> elements, found {}: take simpler shapes",
                            kCollisionsMax, link->collision_array.size())));
        }
        for (const auto& collision : link->collision_array) {
            auto fault = add_body(*collision, name, boxes, bodies);
            if (fault.empty()) continue;
            faults.push_back({document->error("link", name, std::move(fault)),
                              collision->geometry ? shape_name(*collision->geometry) : "no geometry"});
            break;
        }
        const auto padding = link_padding_m.find(name);
        for (Capsule& capsule : to_capsules(std::move(bodies))) {
            if (padding != link_padding_m.end()) capsule.radius_m += padding->second;
            all.push_back(std::move(capsule));
        }
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    return all;
}

}  // namespace octoskin::rig
