// Words of OpenNI2 and of helpers on one line, for a log and a status.
#pragma once

#include <string>
#include <string_view>

namespace octoskin::openni2 {

/// Each run of blanks, tabs, line ends and other control characters as one blank, none at either end, and no
/// colon at the end behind which nothing comes.
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
