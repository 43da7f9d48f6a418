// Reads a file's text up to a limit: a path may lead to an endless file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <istream>
#include <string>

namespace octoskin::rig {

/// The rest of `stream`, at most `bytes_max` + 1 bytes: a result longer than `bytes_max` means that the text
/// is too long. Memory grows with the text.
[[nodiscard]] inline std::string read_bounded(std::istream& stream, std::size_t bytes_max) {
    constexpr std::size_t kStep = 16'384;
    std::string text;
    while (stream && text.size() <= bytes_max) {
        const std::size_t before = text.size();
        text.resize(std::min(before + kStep, bytes_max + 1));
        stream.read(text.data() + before, static_cast<std::streamsize>(text.size() - before));
        text.resize(before + static_cast<std::size_t>(stream.gcount()));
    }
    return text;
}

}  // namespace octoskin::rig
