// Explanations of parser messages for the author of a file.
#pragma once

#include <string>
#include <string_view>

namespace octoskin::rig {

/// For yaml-cpp's message about `line` (1-based) of `text`.
[[nodiscard]] std::string yaml_syntax_hint(const std::string& message, std::string_view text, int line);

/// For tinyxml2's error by its name ("XML_ERROR_PARSING") in `element`, which may be empty.
[[nodiscard]] std::string xml_syntax_hint(const std::string& error_name, const std::string& element);

}  // namespace octoskin::rig
