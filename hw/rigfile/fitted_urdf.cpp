#include "hw/rigfile/fitted_urdf.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>

#include "hw/rigfile/urdf_rotation.hpp"
#include "hw/rigfile/urdf_xml.hpp"

namespace octoskin::rig {
namespace {

using Element = tinyxml2::XMLElement;

constexpr double kGrid_m = 1e-6;

std::string triple(const Eigen::Vector3d& numbers) {
    return fmt::format("{:.9g} {:.9g} {:.9g}", numbers.x(), numbers.y(), numbers.z());
}

Eigen::Vector3d rounded(const Eigen::Vector3d& point) {
    return (point / kGrid_m).array().round() * kGrid_m;
}

Element& add_collision(Element& link, const std::string& name, const Eigen::Vector3d& xyz) {
    Element& collision = *link.InsertNewChildElement("collision");
    collision.SetAttribute("name", name.c_str());
    collision.InsertNewChildElement("origin")->SetAttribute("xyz", triple(xyz).c_str());
    return collision;
}

void add_ball(Element& link, const std::string& name, const Eigen::Vector3d& centre,
              const std::string& radius) {
    add_collision(link, name, centre)
        .InsertNewChildElement("geometry")
        ->InsertNewChildElement("sphere")
        ->SetAttribute("radius", radius.c_str());
}

void add_capsule(Element& link, std::size_t number, const Capsule& capsule) {
    const std::string name = fmt::format("{}{}", kFittedName, number);
    const Eigen::Vector3d a = rounded(capsule.p_link_a);
    const Eigen::Vector3d b = rounded(capsule.p_link_b);
    // The ends move by less than a step of the grid.
    const std::string radius = fmt::format("{:.6f}", std::ceil(capsule.radius_m / kGrid_m + 1.0) * kGrid_m);
    const Eigen::Vector3d axis = b - a;
    const double length_m = axis.norm();
    add_ball(link, name + "_a", a, radius);
    if (length_m < kGrid_m) return;
    add_ball(link, name + "_b", b, radius);
    Element& wall = add_collision(link, name, 0.5 * (a + b));
    const Eigen::Matrix3d rotation =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis / length_m).toRotationMatrix();
    wall.FirstChildElement("origin")->SetAttribute("rpy", triple(rpy_of(rotation)).c_str());
    Element& cylinder = *wall.InsertNewChildElement("geometry")->InsertNewChildElement("cylinder");
    cylinder.SetAttribute("radius", radius.c_str());
    cylinder.SetAttribute("length", fmt::format("{:.9g}", length_m).c_str());
}

bool has_shape(const Element& part, std::string_view shape) {
    const Element* const geometry = part.FirstChildElement("geometry");
    const Element* const element = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    return element != nullptr && element->Name() == shape;
}

/// The <visual> as a <collision>.
void add_collision_of(const Element& visual, Element& link) {
    Element& collision = *link.InsertNewChildElement("collision");
    for (const char* const part : {"origin", "geometry"}) {
        if (const Element* const element = visual.FirstChildElement(part))
            collision.InsertEndChild(element->DeepClone(link.GetDocument()));
    }
}

void remove_replaced(Element& link, bool is_of_visual) {
    const Element* const last = link.LastChildElement();
    for (Element* part = link.FirstChildElement(); part != nullptr;) {
        Element* const next = part == last ? nullptr : part->NextSiblingElement();
        const std::string_view name = part->Name();
        const bool is_fitted = has_shape(*part, "mesh") || has_shape(*part, "box");
        if (is_of_visual && name == "visual" && !is_fitted) add_collision_of(*part, link);
        const bool is_replaced = (name == "collision" && is_fitted) ||
                                 (is_of_visual && name == "visual" && has_shape(*part, "mesh"));
        if (is_replaced) link.DeleteChild(part);
        part = next;
    }
}

}  // namespace

Result<std::string, Error> urdf_with_bodies(const std::filesystem::path& file, const std::string& text,
                                            const std::map<std::string, FittedBody>& bodies) {
    tinyxml2::XMLDocument xml;
    const auto robot = parse_robot(file, text, xml);
    if (!robot) return unexpected(robot.error());
    for (Element* link = (*robot)->FirstChildElement("link"); link != nullptr;
         link = link->NextSiblingElement("link")) {
        const char* const name = link->Attribute("name");
        const auto body = bodies.find(name == nullptr ? "" : name);
        if (body == bodies.end()) continue;
        remove_replaced(*link, body->second.is_of_visual);
        const std::vector<Capsule>& capsules = body->second.capsules;
        for (std::size_t i = 0; i < capsules.size(); ++i) add_capsule(*link, i, capsules[i]);
    }
    tinyxml2::XMLPrinter printer;
    xml.Print(&printer);
    return std::string(printer.CStr());
}

}  // namespace octoskin::rig
