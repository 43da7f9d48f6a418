#include "host/io/tum/line_file.hpp"

#include <fstream>

namespace octoskin::tum {
namespace {

constexpr std::size_t kLineBytesMax = 4096;

/// False at the end; a line that is too long is cut just behind the limit.
bool read_line(std::ifstream& stream, std::string& line) {
    line.clear();
    for (char next = 0; line.size() <= kLineBytesMax && stream.get(next); line += next) {
        if (next == '\n') return true;
    }
    return !line.empty();
}

bool is_content(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t");
    return begin != std::string_view::npos && line[begin] != '#';
}

/// Why a list is not opened.
std::string reason_of(const FolderError& error) {
    switch (error.fault) {
        case FolderFault::not_a_file:
            return "is a pipe or a device, not an ordinary file";
        case FolderFault::absent:
            return "no such file: a data set has depth.txt and groundtruth.txt; unpack it anew";
        case FolderFault::link:
        case FolderFault::outside:
            return error.reason();
        case FolderFault::foreign_owner:
        case FolderFault::not_a_folder:
        case FolderFault::is_there:
        case FolderFault::not_permitted:
        case FolderFault::system:
            break;
    }
    return "cannot be opened";
}

}  // namespace

DepthSourceError line_error(const std::filesystem::path& file, std::uint64_t line, const std::string& what) {
    return {file.string() + ":" + std::to_string(line) + ": " + what};
}

Status<DepthSourceError> read_lines(const FilePlace& place, const TakeLine& take) {
    const std::filesystem::path file = place.shown();
    const auto opened = place.open();
    if (!opened) return unexpected(DepthSourceError{file.string() + ": " + reason_of(opened.error())});
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream) return unexpected(DepthSourceError{file.string() + ": cannot be opened"});
    std::string line;
    for (std::uint64_t number = 1; read_line(stream, line); ++number) {
        if (line.size() > kLineBytesMax)
            return unexpected(line_error(file, number, "longer than 4096 bytes: no list of a data set"));
        if (line.ends_with('\r')) line.pop_back();
        if (!is_content(line)) continue;
        if (const auto taken = take(number, line); !taken)
            return unexpected(line_error(file, number, taken.error()));
    }
    if (stream.bad()) return unexpected(DepthSourceError{file.string() + ": cannot be read on"});
    return Done{};
}

}  // namespace octoskin::tum
