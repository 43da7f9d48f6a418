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

Error no_robot_in(const std::filesystem::path& file) {
    return {.code = ErrorCode::foreign_format,
            .what = "expected a URDF with a <robot>, found none",
            .file = file};
}

Result<tinyxml2::XMLElement*, Error> parse_robot(const std::filesystem::path& file, const std::string& text,
                                                 tinyxml2::XMLDocument& xml) {
    if (auto error = crowded_element(text)) {
        error->file = file;
        return unexpected(*std::move(error));
    }
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return unexpected(Error{.code = ErrorCode::bad_syntax,
                                .what = "not XML: " + xml_syntax_hint(xml.ErrorName(), element_of(xml)),
                                .file = file,
                                .line = xml.ErrorLineNum()});
    }
    if (auto* const robot = xml.FirstChildElement("robot")) return robot;
    return unexpected(no_robot_in(file));
}

}  // namespace octoskin::rig
