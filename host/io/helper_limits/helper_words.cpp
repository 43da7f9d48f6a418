#include "host/io/helper_limits/helper_words.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "host/core/text/printable.hpp"

namespace octoskin {

std::string helper_lines(std::string_view helper, std::string_view words) {
    const std::string begin = std::string(helper) + ": ";
    std::string lines;
    while (!words.empty()) {
        const std::string_view line = words.substr(0, words.find('\n'));
        words.remove_prefix(std::min(line.size() + 1, words.size()));
        if (line.empty()) continue;
        if (!line.starts_with(begin)) lines += begin;
        lines += printable(line) + "\n";
    }
    return lines;
}

void show_helper_words(std::string_view helper, int descriptor) {
    constexpr std::size_t kPipe = 64U << 10U;
    std::string words(kPipe, '\0');
    const ssize_t count = ::read(descriptor, words.data(), words.size());
    words.resize(count > 0 ? static_cast<std::size_t>(count) : 0U);
    std::fputs(helper_lines(helper, words).c_str(), stderr);
}

}  // namespace octoskin
