#include "hw/rigfile/urdf_outline.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "hw/rigfile/element_fault.hpp"
#include "hw/rigfile/xacro_remedy.hpp"

namespace octoskin::rig {
namespace {

/// A robot has a few dozen. urdfdom frees a chain of links by recursion as deep as the chain.
constexpr std::size_t kElementsMax = 4'000;

std::string attribute(const tinyxml2::XMLElement* element, const char* name) {
    const char* text = element ? element->Attribute(name) : nullptr;
    return text ? text : "";
}

/// An error if an `<origin rpy>` seems to be in degrees. urdfdom does not keep the angles.
std::optional<Error> turn_fault(const tinyxml2::XMLElement* origin) {
    constexpr double kOriginTurnMax_rad = 6.29;  // one turn, plus rounding
    std::istringstream turns(attribute(origin, "rpy"));
    for (double turn = 0.0; turns >> turn;) {
        if (std::abs(turn) > kOriginTurnMax_rad) {
            return Error{ErrorCode::out_of_range, "expected an rpy in radians, at most once round",
                         fmt::format("\"{}\"", attribute(origin, "rpy")), "is it written in degrees?"};
        }
    }
    return std::nullopt;
}

/// The error of the first element of a link or joint whose pose is used and whose rotation is too large.
std::optional<Error> find_turn_fault(const std::filesystem::path& file, const tinyxml2::XMLElement& element) {
    const auto fault_at = [&](const tinyxml2::XMLElement* origin) -> std::optional<Error> {
        auto error = turn_fault(origin);
        if (!error) return std::nullopt;
        error->file = file;
        error->line = origin->GetLineNum();
        error->key = fmt::format("{} {}", element.Name(), attribute(&element, "name"));
        return error;
    };
    if (auto fault = fault_at(element.FirstChildElement("origin"))) return fault;
    for (const auto* body = element.FirstChildElement("collision"); body;
         body = body->NextSiblingElement("collision")) {
        if (auto fault = fault_at(body->FirstChildElement("origin"))) return fault;
    }
    return std::nullopt;
}

}  // namespace

Result<UrdfOutline, Error> UrdfOutline::read(const std::filesystem::path& file,
                                             const tinyxml2::XMLElement& robot) {
    UrdfOutline outline;
    outline.file_ = file;
    std::vector<ElementFault> faults;
    for (const auto* element = robot.FirstChildElement(); element; element = element->NextSiblingElement()) {
        const std::string tag = element->Name();
        if (is_xacro_definition(tag)) continue;
        if (tag.starts_with("xacro:")) {
            return unexpected(Error{.code = ErrorCode::unsupported,
                                    .what = "an element of xacro that is not expanded",
                                    .remedy = xacro_remedy(file),
                                    .file = file,
                                    .line = element->GetLineNum(),
                                    .key = tag});
        }
        if (tag != "link" && tag != "joint") continue;
        if (outline.elements_.size() == kElementsMax) {
            return unexpected(Error{
                .code = ErrorCode::limit_exceeded,
                .what = fmt::format("expected a robot of at most {} links and joints together", kElementsMax),
                .value = "more",
                .file = file,
                .line = element->GetLineNum(),
                .key = tag});
        }
        if (auto fault = find_turn_fault(file, *element)) faults.push_back({std::move(*fault), "its rpy"});
        const auto* limit = element->FirstChildElement("limit");
        outline.elements_.push_back({tag, attribute(element, "name"), element->GetLineNum(),
                                     attribute(element->FirstChildElement("parent"), "link"),
                                     attribute(element->FirstChildElement("child"), "link"),
                                     limit != nullptr && limit->Attribute("upper") == nullptr});
    }
    if (!faults.empty()) return unexpected(one_error_of(std::move(faults)));
    if (auto loop = outline.find_loop()) return unexpected(std::move(*loop));
    return outline;
}

std::optional<Error> UrdfOutline::find_loop() const {
    std::map<std::string_view, const Element*> joint_above;
    for (const Element& joint : elements_) {
        if (joint.tag != "joint") continue;
        const auto [first, is_new] = joint_above.try_emplace(joint.child_link, &joint);
        if (is_new) continue;
        return error("link", joint.child_link,
                     {ErrorCode::duplicate, "expected one joint to hang from",
                      fmt::format("{} and {}", first->second->name, joint.name), "remove one"});
    }
    // Every path upwards ends at a root or at a link of an earlier path: each link is visited once.
    std::map<std::string_view, const Element*> passed_from;
    for (const Element& link : elements_) {
        if (link.tag != "link") continue;
        for (std::string_view at = link.name; passed_from.try_emplace(at, &link).second;) {
            const auto above = joint_above.find(at);
            if (above == joint_above.end()) break;
            at = above->second->parent_link;
            const auto before = passed_from.find(at);
            if (before == passed_from.end() || before->second != &link) continue;
            return error(
                "link", link.name,
                {ErrorCode::bad_value, "expected a way up to a root link", "a loop", "remove one joint"});
        }
    }
    return std::nullopt;
}

bool UrdfOutline::is_upper_missing(std::string_view joint) const {
    return std::any_of(elements_.begin(), elements_.end(), [&](const Element& element) {
        return element.tag == "joint" && element.name == joint && element.is_upper_missing;
    });
}

Error UrdfOutline::error(std::string_view tag, std::string_view name, Error error) const {
    const auto found = std::find_if(elements_.begin(), elements_.end(), [&](const Element& element) {
        return element.tag == tag && element.name == name;
    });
    error.file = file_;
    error.line = found == elements_.end() ? 0 : found->line;
    error.key = fmt::format("{} {}", tag, name);
    return error;
}

}  // namespace octoskin::rig
