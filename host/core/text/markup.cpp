#include "host/core/text/markup.hpp"

#include <algorithm>

#include "host/core/text/utf8.hpp"

namespace octoskin {
namespace {

constexpr std::string_view kReplacement = "\ufffd";

/// XML allows only these three control characters.
bool is_printable(unsigned char byte) {
    return byte >= 0x20 || byte == '\n' || byte == '\t' || byte == '\r';
}

std::string_view entity_of(char character) {
    switch (character) {
        case '&':
            return "&amp;";
        case '<':
            return "&lt;";
        case '>':
            return "&gt;";
        case '"':
            return "&quot;";
        case '\'':
            return "&#39;";
        default:
            return {};
    }
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string safe;
    safe.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text.substr(i));
        const std::string_view entity = entity_of(text[i]);
        if (length == 0 || !is_printable(static_cast<unsigned char>(text[i]))) {
            safe += kReplacement;
        } else if (!entity.empty()) {
            safe += entity;
        } else {
            safe += text.substr(i, length);
        }
        i += std::max<std::size_t>(length, 1);
    }
    return safe;
}

}  // namespace octoskin
