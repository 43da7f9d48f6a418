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

std::string reason_of(const FolderError& error) {
    if (error.fault == FolderFault::not_a_file && error.what == "a folder")
        return "is a directory; give the log file itself";
    if (error.fault == FolderFault::not_a_file)
        return "is a pipe or a device; write the log into a regular file first";
    if (error.fault == FolderFault::link) return error.message();
    return std::string("cannot open: ") + std::strerror(error.error_number);
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

Result<LogReader, LogError> LogReader::open(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return unexpected(LogError{file.shown(), reason_of(opened.error())});
    const auto stream = [&] { return std::ifstream(opened->path_for_libraries(), std::ios::binary); };
    std::ifstream lines = stream();
    if (!lines)
        return unexpected(LogError{file.shown(), std::string("cannot open: ") + std::strerror(errno)});
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

Result<std::optional<LogEntry>, LogError> LogReader::next() {
    while (true) {  // until the end of the file
        const LineStream::End end = lines_.next();
        if (lines_.has_failed()) {
            return unexpected(
                LogError{file_, "reading failed after line " + std::to_string(lines_.number())});
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
        // A line that is cut off may look like a shorter frame; its checksum decides that later. If it cannot
        // be parsed, it counts as cut off.
        const bool is_cut_off = end == LineStream::End::end_of_file && entry.error() != LineFault::blank;
        note(is_cut_off ? LineFault::truncated : entry.error());
    }
}

std::optional<LogError> LogReader::foreign_file() const {
    if (inputs_.used() > 0 || !first_fault_) return std::nullopt;
    const std::string name = file_.filename().string();
    if (const ForeignFormat* const format = foreign_format_of(begin_)) {
        return LogError{file_,
                        "is a log in the format " + std::string(format->name) +
                            "; make one of candump's of it: " + conversion(*format, name, "candump.log") +
                            " (docs/reference/recording-folder.md has what each command needs)"};
    }
    return LogError{file_, "no line is a frame in candump's format: line " +
                               std::to_string(first_fault_->line) + " " + lack(first_fault_->fault) + ": '" +
                               first_fault_->text + "'; record with `candump -L can0 > can.log`"};
}

}  // namespace octoskin::candump
