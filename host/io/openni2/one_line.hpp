// Puts texts of OpenNI2 and of helpers on one line, for logs and the status.
#pragma once

#include <string>
#include <string_view>

namespace octoskin::openni2 {

/// Replaces each sequence of blanks, tabs, line ends and other control characters by one blank, and removes
/// blanks at both ends and a colon at the end.
[[nodiscard]] inline std::string one_line(std::string_view words) {
    std::string line;
    for (const char c : words) {
        const bool is_blank = static_cast<unsigned char>(c) <= ' ' || c == '\x7F';
        if (!is_blank) {
            line += c;
        } else if (!line.empty() && line.back() != ' ') {
            line += ' ';
        }
    }
    while (line.ends_with(' ') || line.ends_with(':')) line.pop_back();
    return line;
}

}  // namespace octoskin::openni2
