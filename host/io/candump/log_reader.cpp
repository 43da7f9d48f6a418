#include "host/io/candump/log_reader.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

namespace octoskin::candump {
namespace {

std::string reason_of(const FolderError& error) {
    if (error.fault == FolderFault::not_a_file && error.what == "a folder")
        return "is a directory; give the log file itself";
    if (error.fault == FolderFault::not_a_file)
        return "is a pipe or a device; write the log into an ordinary file first";
    if (error.fault == FolderFault::link) return error.message();
    return std::string("cannot open: ") + std::strerror(error.error_number);
}

}  // namespace

Result<LogReader, LogError> LogReader::open(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) return unexpected(LogError{file.shown(), reason_of(opened.error())});
    std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
    if (!stream)
        return unexpected(LogError{file.shown(), std::string("cannot open: ") + std::strerror(errno)});
    return LogReader(file.shown(), std::move(stream));
}

LogReader::LineEnd LogReader::read_line() {
    constexpr int kEnd = std::char_traits<char>::eof();
    line_.clear();
    bool is_too_long = false;
    while (true) {  // at most the rest of the file; memory stays at kLineBytesMax
        const int byte = stream_.get();
        if (byte == kEnd) {
            const LineEnd end = line_.empty() ? LineEnd::nothing_left : LineEnd::end_of_file;
            return is_too_long ? LineEnd::too_long : end;
        }
        if (byte == '\n') {
            return is_too_long ? LineEnd::too_long : LineEnd::line_feed;
        }
        if (line_.size() < kLineBytesMax) {
            line_.push_back(static_cast<char>(byte));
        } else {
            is_too_long = true;
        }
    }
}

Result<LogEntry, LineFault> LogReader::parse(LineEnd end) const {
    if (end == LineEnd::too_long) {
        return unexpected(LineFault::too_long);
    }
    Result<LogEntry, LineFault> entry = parse_line(line_);
    // A cut line may still look like a shorter frame; its checksum decides then. What makes no sense was cut.
    if (!entry && end == LineEnd::end_of_file && entry.error() != LineFault::blank) {
        return unexpected(LineFault::truncated);
    }
    return entry;
}

Result<std::optional<LogEntry>, LogError> LogReader::next() {
    while (true) {  // ends with the file
        const LineEnd end = read_line();
        if (stream_.bad()) {
            return unexpected(LogError{file_, "reading failed after line " + std::to_string(line_number_)});
        }
        if (end == LineEnd::nothing_left) {
            return std::optional<LogEntry>{};
        }
        ++line_number_;
        account_.take_in();
        Result<LogEntry, LineFault> entry = parse(end);
        if (entry) {
            account_.use();
            return std::optional<LogEntry>(std::move(entry).value());
        }
        account_.reject(entry.error());
        std::uint64_t& first = first_line_[static_cast<std::size_t>(entry.error())];
        first = first == 0 ? line_number_ : first;
    }
}

std::optional<LogError> LogReader::foreign_file() const {
    const bool has_lines = account_.in() > account_.rejected(LineFault::blank);
    if (account_.used() > 0 || !has_lines) return std::nullopt;
    return LogError{file_, "no line is in candump's log format; record with `candump -L can0 > can.log`"};
}

}  // namespace octoskin::candump
