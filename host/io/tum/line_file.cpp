#include "host/io/tum/line_file.hpp"

#include <fstream>
#include <utility>

#include "host/io/lines/line_stream.hpp"

namespace octoskin::tum {
namespace {

constexpr std::size_t kLineBytesMax = 4096;

bool is_content(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    return begin != std::string_view::npos && line[begin] != '#';
}

/// Why a list cannot be opened.
std::string reason_of(const FolderError& error) {
    switch (error.fault) {
        case FolderFault::not_a_file:
            return "is a pipe or a device, not a regular file";
        case FolderFault::absent:
            return "no such file: a data set has a list of its depth images and the poses of the camera, "
                   "depth.txt and groundtruth.txt; unpack it again";
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

Result<LineStream, DepthSourceError> open_lines(const FilePlace& place) {
    const std::string file = place.shown().string();
    const auto opened = place.open();
    if (!opened) return unexpected(DepthSourceError{file + ": " + reason_of(opened.error())});
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream) return unexpected(DepthSourceError{file + ": cannot be opened"});
    return LineStream(std::move(stream), kLineBytesMax);
}

}  // namespace

DepthSourceError line_error(const std::filesystem::path& file, std::uint64_t line, const std::string& what) {
    return {file.string() + ":" + std::to_string(line) + ": " + what};
}

Result<BadLines, DepthSourceError> read_lines(const FilePlace& place, const TakeLine& take) {
    auto lines = open_lines(place);
    if (!lines) return unexpected(lines.error());
    const std::filesystem::path file = place.shown();
    BadLines bad;
    while (lines->next() != LineStream::End::nothing_left) {  // until the end of the file
        if (lines->is_cut()) {
            bad.add(line_error(file, lines->number(), "longer than 4096 bytes: not a line of a data set"));
        } else if (is_content(lines->line())) {
            if (const auto taken = take(lines->number(), lines->line()); !taken)
                bad.add(line_error(file, lines->number(), taken.error()));
        }
    }
    if (lines->has_failed()) return unexpected(DepthSourceError{file.string() + ": reading failed"});
    return bad;
}

Result<std::string, DepthSourceError> read_small_file(const FilePlace& place) {
    auto lines = open_lines(place);
    if (!lines) return unexpected(lines.error());
    const auto refuse = [&place](const char* what) {
        return unexpected(DepthSourceError{place.shown().string() + ": " + what});
    };
    std::string text;
    while (lines->next() != LineStream::End::nothing_left) {  // until the end of the file, or its limit
        text += lines->line() + '\n';
        if (lines->is_cut() || text.size() > kLineBytesMax)
            return refuse("longer than 4096 bytes: not a pose or a calibration");
    }
    if (lines->has_failed()) return refuse("reading failed");
    return text;
}

}  // namespace octoskin::tum
