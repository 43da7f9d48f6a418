#include "host/io/candump/log_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

#include "host/io/candump/foreign_format.hpp"

namespace octoskin::candump {
namespace {

Error cannot_open(const FilePlace& file, const FolderError& error) {
    Error refused = to_error(error);
    if (error.fault == FolderFault::link) return refused;
    refused.file = file.shown();
    if (error.fault != FolderFault::not_a_file) {
        refused.what = std::string("cannot open: ") + std::strerror(error.error_number);
        return refused;
    }
    const bool is_folder = error.what == "a directory";
    refused.what = is_folder ? "is a directory" : "is a pipe or a device";
    refused.remedy = is_folder ? "give the log file itself" : "write the log into a regular file first";
    return refused;
}

/// The beginning of a file: enough to recognise its format and the reference of its times.
struct Beginning {
    std::string text;
    StampKind stamps = StampKind::absolute;
};

Beginning beginning_of(std::ifstream stream) {
    constexpr std::size_t kTextBytes = 1024;
    constexpr std::uint64_t kLinesMax = 2 * StampKindFinder::kFramesEnough;
    Beginning beginning;
    StampKindFinder finder;
    LineStream lines(std::move(stream), kLineBytesMax);
    while (lines.number() < kLinesMax && !finder.has_enough() &&
           lines.next() != LineStream::End::nothing_left) {
        if (beginning.text.size() < kTextBytes) beginning.text += lines.line() + '\n';
        if (const auto entry = parse_line(lines.line())) finder.take(entry->stamp);
    }
    beginning.stamps = finder.kind();
    return beginning;
}

/// Differences with a larger sum are not valid: nanoseconds since 1970 have 63 bits.
constexpr WallTime kStampMax{std::numeric_limits<std::int64_t>::max()};

/// The fault of a line, as half a sentence.
const char* lack(LineFault fault) {
    switch (fault) {
        case LineFault::foreign:
            return "does not begin with a time in parentheses";
        case LineFault::timestamp:
            return "has no time with 3 to 9 decimals in its parentheses";
        case LineFault::interface:
            return "has no interface name after its time";
        case LineFault::identifier:
            return "has no identifier of 3 or 8 hexadecimal digits";
        case LineFault::data:
            return "has no bytes in hexadecimal digits after a # or a [length]";
        case LineFault::length:
            return "has more bytes than a frame of its kind";
        case LineFault::too_long:
            return "is longer than any line of candump";
        case LineFault::truncated:
            return "is cut off";
        case LineFault::blank:
            break;
    }
    return "is blank";
}

/// For a message: printable and short.
std::string shown(std::string_view line) {
    constexpr std::size_t kCharsMax = 60;
    std::string text(line.substr(0, kCharsMax));
    std::ranges::replace_if(
        text, [](char c) { return c < ' ' || c > '~'; }, '?');
    return text;
}

}  // namespace

Result<LogReader, Error> LogReader::open(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return unexpected(cannot_open(file, opened.error()));
    const auto stream = [&] { return std::ifstream(opened->path_for_libraries(), std::ios::binary); };
    std::ifstream lines = stream();
    if (!lines)
        return unexpected(in_file(
            {ErrorCode::system_error, std::string("cannot open: ") + std::strerror(errno)}, file.shown()));
    Beginning beginning = beginning_of(stream());
    return LogReader(file.shown(), LineStream(std::move(lines), kLineBytesMax), std::move(beginning.text),
                     beginning.stamps);
}

void LogReader::note(LineFault fault) {
    inputs_.now_at(static_cast<std::int64_t>(lines_.number()));
    inputs_.reject(fault);
    if (fault != LineFault::blank && !first_fault_)
        first_fault_ = FirstFault{lines_.number(), fault, shown(lines_.line())};
}

Result<std::optional<LogEntry>, Error> LogReader::next() {
    while (true) {  // until the end of the file
        const LineStream::End end = lines_.next();
        if (lines_.has_failed()) {
            return unexpected(in_file(
                {ErrorCode::system_error, "reading failed after line " + std::to_string(lines_.number())},
                file_));
        }
        if (end == LineStream::End::nothing_left) return std::optional<LogEntry>{};
        inputs_.count_in();
        if (lines_.is_cut()) {
            note(LineFault::too_long);
            continue;
        }
        Result<LogEntry, LineFault> entry = parse_line(lines_.line());
        if (entry && stamps_ == StampKind::difference) {
            // Both are 0 or more: no overflow.
            if (entry->stamp.ns > kStampMax.ns - newest_.ns) {
                note(LineFault::timestamp);
                continue;
            }
            entry->stamp = newest_ = {newest_.ns + entry->stamp.ns};
        }
        if (entry) {
            inputs_.use();
            return std::optional<LogEntry>(std::move(entry).value());
        }
        // A line that is cut off may look like a shorter frame; its checksum is checked later. A line that
        // cannot be parsed counts as cut off.
        const bool is_cut_off = end == LineStream::End::end_of_file && entry.error() != LineFault::blank;
        note(is_cut_off ? LineFault::truncated : entry.error());
    }
}

std::optional<Error> LogReader::foreign_file() const {
    if (inputs_.used() > 0 || !first_fault_) return std::nullopt;
    const std::string name = file_.filename().string();
    if (const ForeignFormat* const format = foreign_format_of(begin_)) {
        return Error{.code = ErrorCode::foreign_format,
                     .what = "is a log in the format " + std::string(format->name),
                     .remedy = "convert it to candump's format: " + conversion(*format, name, "candump.log") +
                               " (docs/reference/recording-folder.md explains the command)",
                     .file = file_};
    }
    return Error{
        .code = ErrorCode::foreign_format,
        .what = std::string("no line is a frame in candump's format; this one ") + lack(first_fault_->fault),
        .value = "'" + first_fault_->text + "'",
        .remedy = "record with `candump -L can0 > can.log`",
        .file = file_,
        .line = static_cast<int>(first_fault_->line)};
}

}  // namespace octoskin::candump
