// A robot description as XML.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace octoskin::rig {

/// The error for a file without a <robot>.
[[nodiscard]] Error no_robot_in(const std::filesystem::path& file);

/// Parses `text` into `xml` and returns its <robot>. Errors, with the line: not XML, nested deeper than 100,
/// an element with more than 100 attributes, no <robot>. `file` is for the messages only.
[[nodiscard]] Result<tinyxml2::XMLElement*, Error> parse_robot(const std::filesystem::path& file,
                                                               const std::string& text,
                                                               tinyxml2::XMLDocument& xml);

}  // namespace octoskin::rig
