#include "hw/rigfile/nesting.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::rig {
namespace {

constexpr int kBracketsMax = 64;
constexpr int kAttributesMax = 100;

int line_of(std::string_view text, std::size_t at) {
    return 1 + static_cast<int>(std::ranges::count(text.substr(0, at), '\n'));
}

/// The position after the construct at `at`, which begins with `begin` and ends with `end`; npos if it does
/// not begin so. A construct without an end extends to the end of the text.
std::size_t behind(std::string_view text, std::size_t at, std::string_view begin, std::string_view end) {
    if (!text.substr(at).starts_with(begin)) return std::string_view::npos;
    const std::size_t found = text.find(end, at + begin.size());
    return found == std::string_view::npos ? text.size() : found + end.size();
}

/// The position after a comment, a CDATA section or a declaration at `at`; npos if there is none.
std::size_t behind_no_element(std::string_view text, std::size_t at) {
    for (const auto& [begin, end] :
         {std::pair<std::string_view, std::string_view>{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}}) {
        const std::size_t next = behind(text, at, begin, end);
        if (next != std::string_view::npos) return next;
    }
    return std::string_view::npos;
}

/// The position after the tag at `at`; `attributes` is set to its number of attributes.
std::size_t behind_tag(std::string_view text, std::size_t at, int& attributes) {
    attributes = 0;
    for (; at < text.size() && text[at] != '>'; ++at) {
        if (text[at] == '=') ++attributes;
        if (text[at] == '"' || text[at] == '\'') {
            at = text.find(text[at], at + 1);
            if (at == std::string_view::npos) return text.size();
        }
    }
    return std::min(at + 1, text.size());
}

}  // namespace

std::optional<Error> deep_brackets(std::string_view yaml) {
    int open = 0;
    for (std::size_t at = 0; at < yaml.size(); ++at) {
        const char c = yaml[at];
        if (c == '[' || c == '{') ++open;
        if (c == ']' || c == '}') open = std::max(0, open - 1);
        if (open > kBracketsMax)
            return Error{.code = ErrorCode::limit_exceeded,
                         .what = fmt::format("expected at most {} brackets within each other", kBracketsMax),
                         .value = "more",
                         .line = line_of(yaml, at)};
    }
    return std::nullopt;
}

std::optional<Error> crowded_element(std::string_view xml) {
    for (std::size_t at = xml.find('<'); at < xml.size(); at = xml.find('<', at)) {
        const std::size_t next = behind_no_element(xml, at);
        if (next != std::string_view::npos) {
            at = next;
            continue;
        }
        const std::size_t begin = at;
        int attributes = 0;
        at = behind_tag(xml, at + 1, attributes);
        if (attributes > kAttributesMax)
            return Error{.code = ErrorCode::limit_exceeded,
                         .what = fmt::format("expected at most {} attributes in an element", kAttributesMax),
                         .value = std::to_string(attributes),
                         .line = line_of(xml, begin)};
    }
    return std::nullopt;
}

}  // namespace octoskin::rig
