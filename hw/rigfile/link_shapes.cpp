#include "hw/rigfile/link_shapes.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>
#include <urdf_model/model.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "hw/rigfile/urdf_numbers.hpp"
#include "hw/rigfile/urdf_rotation.hpp"
#include "hw/rigfile/urdf_xml.hpp"

namespace octoskin::rig {
namespace {

constexpr double kTurnMax_rad = 6.3;  ///< more are degrees

using Element = tinyxml2::XMLElement;

constexpr std::array kKinds{std::pair{"mesh", ShapeKind::mesh}, std::pair{"box", ShapeKind::box},
                            std::pair{"cylinder", ShapeKind::cylinder},
                            std::pair{"sphere", ShapeKind::sphere}, std::pair{"capsule", ShapeKind::capsule}};

std::string text_of(const Element& element, const char* name) {
    const char* const text = element.Attribute(name);
    return text == nullptr ? "" : text;
}

std::optional<Eigen::Isometry3d> place_of(const Element* origin) {
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    if (origin == nullptr) return place;
    if (origin->Attribute("xyz") != nullptr) {
        const auto xyz = numbers_of<3>(*origin, "xyz");
        if (!xyz) return std::nullopt;
        place.translation() = *xyz;
    }
    if (origin->Attribute("rpy") != nullptr) {
        const auto rpy = numbers_of<3>(*origin, "rpy");
        if (!rpy || rpy->cwiseAbs().maxCoeff() > kTurnMax_rad) return std::nullopt;
        place.linear() = rotation_of_rpy(*rpy);
    } else if (origin->Attribute("quat_xyzw") != nullptr) {
        const auto quat = numbers_of<4>(*origin, "quat_xyzw");
        if (!quat) return std::nullopt;
        place.linear() = Eigen::Quaterniond((*quat)[3], (*quat)[0], (*quat)[1], (*quat)[2])
                             .normalized()
                             .toRotationMatrix();
    }
    return place;
}

bool take_positive(const Element& element, const char* name, double& value) {
    const auto numbers = numbers_of<1>(element, name);
    if (!numbers || !((*numbers)[0] > 0.0)) return false;
    value = (*numbers)[0];
    return true;
}

bool take_size(const Element& element, LinkShape& shape) {
    switch (shape.kind) {
        case ShapeKind::mesh: {
            shape.mesh = text_of(element, "filename");
            if (element.Attribute("scale") == nullptr) return !shape.mesh.empty();
            const auto scale = numbers_of<3>(element, "scale");
            if (scale) shape.size = *scale;
            return scale && scale->cwiseAbs().minCoeff() > 0.0 && !shape.mesh.empty();
        }
        case ShapeKind::box: {
            const auto size = numbers_of<3>(element, "size");
            if (size) shape.size = *size;
            return size && size->minCoeff() >= 0.0;  // some vendors' frames have a box without size
        }
        case ShapeKind::cylinder:
            return take_positive(element, "radius", shape.radius_m) &&
                   take_positive(element, "length", shape.length_m);
        case ShapeKind::sphere:
            return take_positive(element, "radius", shape.radius_m);
        case ShapeKind::capsule: {
            const auto length = numbers_of<1>(element, "length");
            if (length) shape.length_m = (*length)[0];
            return take_positive(element, "radius", shape.radius_m) && length && shape.length_m >= 0.0;
        }
    }
    return false;
}

/// None if it cannot be read.
std::optional<LinkShape> shape_of(const Element& body) {
    const Element* const geometry = body.FirstChildElement("geometry");
    const Element* const element = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    const auto place = place_of(body.FirstChildElement("origin"));
    if (element == nullptr || !place) return std::nullopt;
    for (const auto& [name, kind] : kKinds) {
        if (std::string_view(element->Name()) != name) continue;
        LinkShape shape{.kind = kind, .T_link_shape = *place, .line = element->GetLineNum()};
        return take_size(*element, shape) ? std::optional(shape) : std::nullopt;
    }
    return std::nullopt;
}

/// Appends the elements of this name that can be read, and a fault for each other.
void read_shapes(const Element& link, const char* name, const FilePlace& urdf, std::vector<LinkShape>& shapes,
                 std::vector<ElementFault>& faults) {
    for (const auto* body = link.FirstChildElement(name); body != nullptr;
         body = body->NextSiblingElement(name)) {
        if (auto shape = shape_of(*body)) {
            shapes.push_back(*std::move(shape));
            continue;
        }
        Error error{.code = ErrorCode::bad_value,
                    .what = fmt::format("expected a <{}> with a shape whose place and size are finite "
                                        "numbers, turned by at most one turn of radians, and whose sizes are "
                                        "positive",
                                        name),
                    .file = urdf.shown(),
                    .line = body->GetLineNum(),
                    .key = "link " + text_of(link, "name")};
        faults.push_back({std::move(error), fmt::format("its <{}>", name)});
    }
}

const char* kind_name(const urdf::Joint& joint) {
    switch (joint.type) {
        case urdf::Joint::REVOLUTE:
            return "revolute";
        case urdf::Joint::CONTINUOUS:
            return "continuous";
        case urdf::Joint::PRISMATIC:
            return "prismatic";
        case urdf::Joint::FLOATING:
            return "floating";
        case urdf::Joint::PLANAR:
            return "planar";
        case urdf::Joint::FIXED:
            return "fixed";
        case urdf::Joint::UNKNOWN:
            break;
    }
    return "unknown";
}

bool is_moving(const UrdfDocument& document, const std::string& base_link, const std::string& link) {
    for (auto at = document.model().getLink(link); at && at->name != base_link;
         at = document.model().getLink(at->parent_joint->parent_link_name)) {
        if (at->parent_joint->type != urdf::Joint::FIXED) return true;
    }
    return false;
}

ShapedJoint joint_of(const UrdfDocument& document, const std::string& name) {
    const urdf::Joint& joint = *document.model().joints_.at(name);
    ShapedJoint shaped{name, kind_name(joint), {}, {}};
    if (joint.limits && joint.type != urdf::Joint::CONTINUOUS) {
        shaped.lower = joint.limits->lower;
        shaped.upper = joint.limits->upper;
    }
    return shaped;
}

}  // namespace

const char* name_of(ShapeKind kind) noexcept {
    for (const auto& [name, of_kind] : kKinds)
        if (of_kind == kind) return name;
    return "shape";
}

bool is_body(const LinkShape& shape) noexcept {
    return shape.kind != ShapeKind::box || shape.size.maxCoeff() > 0.0;
}

bool is_body_visual(const ShapedLink& link) noexcept {
    return link.is_moving && std::ranges::none_of(link.collisions, is_body);
}

Result<RobotShapes, Error> read_link_shapes(const FilePlace& urdf, const std::string& base_link) {
    const auto document = UrdfDocument::read(urdf);
    if (!document) return unexpected(document.error());
    RobotShapes robot;
    robot.base_link = base_link.empty() ? document->model().getRoot()->name : base_link;
    if (!document->model().getLink(robot.base_link)) {
        return unexpected(document->error("link", robot.base_link,
                                          {ErrorCode::unknown_name, "expected the name of a link"}));
    }
    const auto text = read_urdf_text(urdf);
    if (!text) return unexpected(text.error());
    tinyxml2::XMLDocument xml;
    const auto parsed = parse_robot(urdf.shown(), *text, xml);
    if (!parsed) return unexpected(parsed.error());
    std::vector<ElementFault> faults;
    for (const auto* link = (*parsed)->FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
        ShapedLink shaped{.name = text_of(*link, "name"), .line = link->GetLineNum()};
        if (!document->is_below(robot.base_link, shaped.name)) continue;
        shaped.is_moving = is_moving(*document, robot.base_link, shaped.name);
        read_shapes(*link, "collision", urdf, shaped.collisions, faults);
        // No body is made of the others: a tool may give a <visual> what only it can read.
        std::vector<ElementFault> of_visuals;
        read_shapes(*link, "visual", urdf, shaped.visuals, of_visuals);
        if (is_body_visual(shaped)) std::ranges::move(of_visuals, std::back_inserter(faults));
        robot.links.push_back(std::move(shaped));
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    for (const std::string& joint : document->moving_joints(robot.base_link))
        robot.joints.push_back(joint_of(*document, joint));
    return robot;
}

}  // namespace octoskin::rig
