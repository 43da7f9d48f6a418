#include "hw/rigfile/syntax_hint.hpp"

#include <fmt/format.h>

namespace octoskin::rig {
namespace {

std::string_view line_of(std::string_view text, int line) {
    for (int i = 1; i < line && !text.empty(); ++i) {
        const auto end = text.find('\n');
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
    }
    return text.substr(0, text.find('\n'));
}

bool is_indented_with_tab(std::string_view line) {
    return line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string_view::npos;
}

}  // namespace

std::string yaml_syntax_hint(const std::string& message, std::string_view text, int line) {
    if (is_indented_with_tab(line_of(text, line)))
        return "the line is indented with a tab: YAML takes spaces only";
    if (message == "illegal map value")
        return "a ':' where no key can be: is one missing on the line above, or a line indented wrongly?";
    if (message == "end of map not found" || message == "end of sequence not found")
        return "the line is indented unlike those that it belongs to";
    if (message == "end of sequence flow not found") return "a '[' above is not closed";
    if (message == "end of map flow not found") return "a '{' above is not closed";
    return message;
}

std::string xml_syntax_hint(const std::string& error_name, const std::string& element) {
    const std::string which = element.empty() ? "the element that begins here" : fmt::format("<{}>", element);
    if (error_name == "XML_ERROR_MISMATCHED_ELEMENT")
        return fmt::format("{} is not closed, or closed by another name", which);
    if (error_name == "XML_ERROR_PARSING") return fmt::format("{} is not closed before the file ends", which);
    if (error_name == "XML_ERROR_PARSING_ELEMENT") return fmt::format("the tag of {} has no end '>'", which);
    if (error_name == "XML_ERROR_PARSING_ATTRIBUTE")
        return fmt::format("an attribute of {} is not name=\"value\", with both quotes", which);
    if (error_name == "XML_ERROR_PARSING_DECLARATION")
        return "an <?xml ...?> that is not the first in the file, or not closed with ?>: remove the text "
               "before it";
    if (error_name == "XML_ERROR_PARSING_COMMENT") return "a comment is not closed with -->";
    return error_name;
}

}  // namespace octoskin::rig
