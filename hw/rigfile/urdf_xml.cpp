#include "hw/rigfile/urdf_xml.hpp"

#include <tinyxml2.h>

#include <string_view>
#include <utility>

#include "hw/rigfile/nesting.hpp"
#include "hw/rigfile/syntax_hint.hpp"

namespace octoskin::rig {
namespace {

/// The element that tinyxml2's error names, if any: "...: XMLElement name=link".
std::string element_of(const tinyxml2::XMLDocument& document) {
    constexpr std::string_view kMark = "XMLElement name=";
    const std::string text = document.ErrorStr();
    const auto at = text.find(kMark);
    return at == std::string::npos ? "" : text.substr(at + kMark.size());
}

}  // namespace

Result<tinyxml2::XMLElement*, RigError> parse_robot(const std::filesystem::path& file,
                                                    const std::string& text, tinyxml2::XMLDocument& xml) {
    if (auto fault = crowded_element(text))
        return unexpected(RigError{file, fault->line, "", std::move(fault->what)});
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return unexpected(RigError{file, xml.ErrorLineNum(), "",
                                   "not XML: " + xml_syntax_hint(xml.ErrorName(), element_of(xml))});
    }
    if (auto* const robot = xml.FirstChildElement("robot")) return robot;
    return unexpected(RigError{file, 0, "", "expected a URDF with a <robot>, found none"});
}

}  // namespace octoskin::rig
