#include "hw/rigfile/urdf_counted.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/urdf_numbers.hpp"
#include "hw/rigfile/urdf_rotation.hpp"
#include "hw/rigfile/xacro_remedy.hpp"

namespace octoskin::rig {
namespace {

using Element = tinyxml2::XMLElement;
using Names = std::initializer_list<std::string_view>;

bool is_one_of(std::string_view name, Names names) {
    return std::ranges::find(names, name) != names.end();
}

bool is_xacro(const Element& element) {
    return std::string_view(element.Name()).starts_with("xacro:");
}

/// Removes all other children, except xacro elements, which are reported later.
void keep_children(Element& parent, Names names) {
    for (tinyxml2::XMLNode* child = parent.FirstChild(); child != nullptr;) {
        tinyxml2::XMLNode* const next = child->NextSibling();
        const Element* const element = child->ToElement();
        const bool is_kept = element != nullptr && !is_xacro_definition(element->Name()) &&
                             (is_one_of(element->Name(), names) || is_xacro(*element));
        if (!is_kept) parent.DeleteChild(child);
        child = next;
    }
}

bool has_known_size(const Element* geometry) {
    const Element* const shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
    if (shape == nullptr) return false;
    const std::string_view name = shape->Name();
    if (name == "box") return numbers_of<3>(*shape, "size").has_value();
    if (name == "sphere") return numbers_of<1>(*shape, "radius").has_value();
    return name == "cylinder" && numbers_of<1>(*shape, "radius") && numbers_of<1>(*shape, "length");
}

bool has_known_place(const Element* origin) {
    if (origin == nullptr) return true;
    const auto is_sound = [&](const char* name) {
        return origin->Attribute(name) == nullptr || numbers_of<3>(*origin, name);
    };
    return is_sound("xyz") && is_sound("rpy");
}

void make_mesh(Element& geometry) {
    geometry.DeleteChildren();
    geometry.InsertNewChildElement("mesh")->SetAttribute("filename", "not read");
}

/// A visual only affects warnings, not the robot's body.
void simplify_visual(Element& visual) {
    visual.DeleteAttribute("name");
    keep_children(visual, {"origin", "geometry"});
    if (has_known_size(visual.FirstChildElement("geometry")) &&
        has_known_place(visual.FirstChildElement("origin")))
        return;
    visual.DeleteChildren();
    make_mesh(*visual.InsertNewChildElement("geometry"));
}

/// A mesh keeps no data but its kind. A capsule, which urdfdom does not know, is a cylinder with a half-ball
/// at each end: the same body that a cylinder becomes here.
void simplify_collision(Element& collision) {
    keep_children(collision, {"origin", "geometry"});
    Element* const geometry = collision.FirstChildElement("geometry");
    if (geometry == nullptr) return;
    if (geometry->FirstChildElement("mesh") != nullptr) make_mesh(*geometry);
    Element* const shape = geometry->FirstChildElement();
    if (shape != nullptr && std::string_view(shape->Name()) == "capsule") shape->SetName("cylinder");
}

/// The first shape of a link's body that is unknown or has no size, with its line: urdfdom reports neither
/// the line nor a remedy.
std::optional<ElementFault> find_shape_fault(const std::filesystem::path& file, const Element& link) {
    for (const auto* body = link.FirstChildElement("collision"); body != nullptr;
         body = body->NextSiblingElement("collision")) {
        const auto* const geometry = body->FirstChildElement("geometry");
        const auto* const shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
        if (shape == nullptr) continue;
        const std::string name = shape->Name();
        const auto fault = [&](Error error) {
            const char* const of = link.Attribute("name");
            error.file = file;
            error.line = shape->GetLineNum();
            error.key = fmt::format("link {}", of == nullptr ? "" : of);
            return ElementFault{std::move(error), name};
        };
        if (!is_one_of(name, {"box", "sphere", "cylinder", "capsule", "mesh"})) {
            return fault({ErrorCode::unsupported,
                          "expected a cylinder, a sphere or a capsule as its <collision>",
                          fmt::format("a <{}>", name), "replace it by one that encloses it, or remove it"});
        }
        if (name == "capsule" && !(numbers_of<1>(*shape, "radius") && numbers_of<1>(*shape, "length")))
            return fault({ErrorCode::bad_value,
                          "expected a <capsule> with a radius and a length, each a finite number of metres"});
    }
    return std::nullopt;
}

/// Writes a `quat_xyzw` (URDF 1.2), which urdfdom ignores, as `rpy`. False if it is no unit quaternion, or if
/// there is an `rpy`, too.
bool make_rpy(Element& origin) {
    constexpr double kUnit = 1e-3;
    if (origin.Attribute("quat_xyzw") == nullptr) return true;
    const auto quat = numbers_of<4>(origin, "quat_xyzw");
    if (origin.Attribute("rpy") != nullptr || !quat) return false;
    const Eigen::Quaterniond rotation((*quat)[3], (*quat)[0], (*quat)[1], (*quat)[2]);
    if (std::abs(rotation.norm() - 1.0) > kUnit) return false;
    const Eigen::Vector3d rpy = rpy_of(rotation.normalized().toRotationMatrix());
    origin.SetAttribute("rpy", fmt::format("{:.17g} {:.17g} {:.17g}", rpy[0], rpy[1], rpy[2]).c_str());
    origin.DeleteAttribute("quat_xyzw");
    return true;
}

/// The first <origin> of a link or joint whose rotation cannot be read as a quaternion.
std::optional<ElementFault> make_all_rpy(const std::filesystem::path& file, Element& of) {
    const auto fault_of = [&](Element* origin) -> std::optional<ElementFault> {
        if (origin == nullptr || make_rpy(*origin)) return std::nullopt;
        const char* const name = of.Attribute("name");
        return ElementFault{{.code = ErrorCode::bad_value,
                             .what = "expected quat_xyzw with four numbers of length 1, without rpy",
                             .value = fmt::format("\"{}\"", origin->Attribute("quat_xyzw")),
                             .file = file,
                             .line = origin->GetLineNum(),
                             .key = fmt::format("{} {}", of.Name(), name == nullptr ? "" : name)},
                            "its quat_xyzw"};
    };
    if (auto fault = fault_of(of.FirstChildElement("origin"))) return fault;
    for (Element* part = of.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
        const bool has_place = is_one_of(part->Name(), {"collision", "visual"});
        if (auto fault = has_place ? fault_of(part->FirstChildElement("origin")) : std::nullopt) return fault;
    }
    return std::nullopt;
}

void simplify(Element& element) {
    if (std::string_view(element.Name()) == "joint") {
        keep_children(element, {"origin", "parent", "child", "axis", "limit", "mimic"});
        return;
    }
    keep_children(element, {"visual", "collision"});
    for (Element* part = element.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
        const std::string_view name = part->Name();
        if (name == "visual") simplify_visual(*part);
        if (name == "collision") simplify_collision(*part);
    }
}

/// Prints elements and attributes only.
class PlainPrinter final : public tinyxml2::XMLPrinter {
  public:
    PlainPrinter() : XMLPrinter(nullptr, true) {}
    bool Visit(const tinyxml2::XMLDeclaration& /*ignored*/) override { return true; }
    bool Visit(const tinyxml2::XMLText& /*ignored*/) override { return true; }
    bool Visit(const tinyxml2::XMLComment& /*ignored*/) override { return true; }
    bool Visit(const tinyxml2::XMLUnknown& /*ignored*/) override { return true; }
};

std::string printed_anew(const tinyxml2::XMLElement& robot) {
    PlainPrinter printer;
    robot.Accept(&printer);
    return printer.CStr();
}

/// Unexpanded xacro at or below an element of a link or joint.
std::optional<Error> find_xacro(const std::filesystem::path& file, const Element& part) {
    std::vector<const Element*> left{&part};
    while (!left.empty()) {
        const Element& element = *left.back();
        left.pop_back();
        if (is_xacro(element)) {
            return Error{.code = ErrorCode::unsupported,
                         .what = "an element of xacro that is not expanded",
                         .remedy = xacro_remedy(file),
                         .file = file,
                         .line = element.GetLineNum(),
                         .key = element.Name()};
        }
        for (const auto* at = element.FirstAttribute(); at != nullptr; at = at->Next()) {
            const std::string_view value = at->Value();
            if (value.find("${") == std::string_view::npos && value.find("$(") == std::string_view::npos)
                continue;
            return Error{.code = ErrorCode::unsupported,
                         .what = "expected a value, because xacro expressions are not evaluated",
                         .value = fmt::format("{}=\"{}\"", at->Name(), value),
                         .remedy = xacro_remedy(file),
                         .file = file,
                         .line = element.GetLineNum(),
                         .key = fmt::format("<{}>", element.Name())};
        }
        for (const auto* child = element.FirstChildElement(); child != nullptr;
             child = child->NextSiblingElement())
            left.push_back(child);
    }
    return std::nullopt;
}

}  // namespace

Result<std::string, Error> counted_urdf(const std::filesystem::path& file, tinyxml2::XMLElement& robot) {
    robot.DeleteAttribute("version");
    keep_children(robot, {"link", "joint"});
    std::vector<ElementFault> faults;
    for (Element* element = robot.FirstChildElement(); element != nullptr;
         element = element->NextSiblingElement()) {
        if (auto fault = find_shape_fault(file, *element)) faults.push_back(std::move(*fault));
        if (auto fault = make_all_rpy(file, *element)) faults.push_back(std::move(*fault));
        simplify(*element);
        if (auto fault = find_xacro(file, *element)) return unexpected(std::move(*fault));
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    return printed_anew(robot);
}

}  // namespace octoskin::rig
