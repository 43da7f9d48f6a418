#include "hw/rigfile/urdf_outline.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <map>
#include <utility>

#include "hw/rigfile/syntax_hint.hpp"

namespace octoskin::rig {
namespace {

std::string attribute(const tinyxml2::XMLElement* element, const char* name) {
    const char* text = element ? element->Attribute(name) : nullptr;
    return text ? text : "";
}

/// The element that tinyxml2 tells with its error, if any: "...: XMLElement name=link".
std::string element_of(const tinyxml2::XMLDocument& document) {
    constexpr std::string_view kMark = "XMLElement name=";
    const std::string text = document.ErrorStr();
    const auto at = text.find(kMark);
    return at == std::string::npos ? "" : text.substr(at + kMark.size());
}

}  // namespace

Result<UrdfOutline, RigError> UrdfOutline::read(const std::filesystem::path& file, const std::string& text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return unexpected(
            RigError{file, document.ErrorLineNum(), "",
                     "not XML: " + xml_syntax_hint(document.ErrorName(), element_of(document))});
    }
    const auto* robot = document.FirstChildElement("robot");
    if (!robot) return unexpected(RigError{file, 0, "", "expected a URDF with a <robot>, found none"});
    UrdfOutline outline;
    outline.file_ = file;
    for (const auto* element = robot->FirstChildElement(); element; element = element->NextSiblingElement()) {
        const std::string tag = element->Name();
        if (tag.starts_with("xacro:")) {
            return unexpected(RigError{file, element->GetLineNum(), tag,
                                       "a macro that is not expanded: run xacro first, and give its output"});
        }
        if (tag != "link" && tag != "joint") continue;
        outline.elements_.push_back({tag, attribute(element, "name"), element->GetLineNum(),
                                     attribute(element->FirstChildElement("parent"), "link"),
                                     attribute(element->FirstChildElement("child"), "link")});
    }
    if (auto loop = outline.find_loop()) return unexpected(std::move(*loop));
    return outline;
}

std::optional<RigError> UrdfOutline::find_loop() const {
    std::map<std::string_view, const Element*> joint_above;
    for (const Element& joint : elements_) {
        if (joint.tag != "joint") continue;
        const auto [first, is_new] = joint_above.try_emplace(joint.child_link, &joint);
        if (is_new) continue;
        return error("link", joint.child_link,
                     fmt::format("expected one joint to hang from, found {} and {}: remove one",
                                 first->second->name, joint.name));
    }
    for (const Element& link : elements_) {
        if (link.tag != "link") continue;
        std::size_t steps = 0;
        for (auto above = joint_above.find(link.name); above != joint_above.end();
             above = joint_above.find(above->second->parent_link)) {
            if (++steps > joint_above.size()) {
                return error("link", link.name,
                             "expected a way up to a root link, found a loop: remove one joint");
            }
        }
    }
    return std::nullopt;
}

RigError UrdfOutline::error(std::string_view tag, std::string_view name, std::string what) const {
    const auto found = std::find_if(elements_.begin(), elements_.end(), [&](const Element& element) {
        return element.tag == tag && element.name == name;
    });
    const int line = found == elements_.end() ? 0 : found->line;
    return {file_, line, fmt::format("{} {}", tag, name), std::move(what)};
}

}  // namespace octoskin::rig
