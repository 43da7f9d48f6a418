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
Error cannot_open(const FilePlace& file, const FolderError& error) {
    Error refused = in_file(to_error(error), file.shown());
    if (error.fault == FolderFault::not_a_file) {
        refused.what = "is a pipe or a device, not a regular file";
    } else if (error.fault == FolderFault::absent) {
        refused.what = "no such file";
        refused.remedy =
            "a data set has a list of its depth images and the poses of the camera, depth.txt and "
            "groundtruth.txt; unpack it again";
    } else if (error.fault != FolderFault::link && error.fault != FolderFault::outside) {
        refused.what = "cannot be opened";
    }
    return refused;
}

Result<LineStream, Error> open_lines(const FilePlace& place) {
    const auto opened = place.open();
    if (!opened) return unexpected(cannot_open(place, opened.error()));
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream) return unexpected(in_file({ErrorCode::system_error, "cannot be opened"}, place.shown()));
    return LineStream(std::move(stream), kLineBytesMax);
}

}  // namespace

Error line_error(const std::filesystem::path& file, std::uint64_t line, Error error) {
    return in_file(std::move(error), file, static_cast<int>(line));
}

Result<BadLines, Error> read_lines(const FilePlace& place, const TakeLine& take) {
    auto lines = open_lines(place);
    if (!lines) return unexpected(lines.error());
    const std::filesystem::path file = place.shown();
    BadLines bad;
    while (lines->next() != LineStream::End::nothing_left) {  // until the end of the file
        if (lines->is_cut()) {
            bad.add(line_error(file, lines->number(),
                               {ErrorCode::too_large, "longer than 4096 bytes: not a line of a data set"}));
        } else if (is_content(lines->line())) {
            if (const auto taken = take(lines->number(), lines->line()); !taken)
                bad.add(line_error(file, lines->number(), {ErrorCode::bad_syntax, taken.error()}));
        }
    }
    if (lines->has_failed()) return unexpected(in_file({ErrorCode::system_error, "reading failed"}, file));
    return bad;
}

Result<std::string, Error> read_small_file(const FilePlace& place) {
    auto lines = open_lines(place);
    if (!lines) return unexpected(lines.error());
    const auto refuse = [&place](ErrorCode code, const char* what) {
        return unexpected(in_file({code, what}, place.shown()));
    };
    std::string text;
    while (lines->next() != LineStream::End::nothing_left) {  // until the end of the file, or its limit
        text += lines->line() + '\n';
        if (lines->is_cut() || text.size() > kLineBytesMax)
            return refuse(ErrorCode::too_large, "longer than 4096 bytes: not a pose or a calibration");
    }
    if (lines->has_failed()) return refuse(ErrorCode::system_error, "reading failed");
    return text;
}

}  // namespace octoskin::tum
