// What a parser's words for a mistake in writing mean to the person who made it.
#pragma once

#include <string>
#include <string_view>

namespace octoskin::rig {

/// For yaml-cpp's message about `line` (1-based) of `text`.
[[nodiscard]] std::string yaml_syntax_hint(const std::string& message, std::string_view text, int line);

/// For tinyxml2's error by its name ("XML_ERROR_PARSING"), on an element that may be empty.
[[nodiscard]] std::string xml_syntax_hint(const std::string& error_name, const std::string& element);

}  // namespace octoskin::rig
