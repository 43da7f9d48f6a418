// A file's text, read no further than a limit: what a name leads to may be endless.
#pragma once

#include <algorithm>
#include <cstddef>
#include <istream>
#include <string>

namespace octoskin::rig {

/// What is left in `stream`, but at most `bytes_max` + 1 bytes: more than `bytes_max` says that it was too
/// much. Takes memory as the text grows.
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
