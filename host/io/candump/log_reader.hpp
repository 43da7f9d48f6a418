// Reads a candump log line by line. Lines that are no frames are counted under a name, never fatal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/account/account.hpp"
#include "host/io/candump/log_line.hpp"
#include "host/io/candump/stamp_kind.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/lines/line_stream.hpp"

namespace octoskin::candump {

/// The file itself fails: "can.log: cannot open: No such file or directory".
struct LogError {
    std::filesystem::path file;
    std::string what;
    [[nodiscard]] std::string message() const { return file.string() + ": " + what; }
};

/// Holds one line at a time, whatever the file's size. About 2 million lines a second. Text may be UTF-8 or
/// UTF-16; times that are differences (`candump -t d`) are added up.
class LogReader {
  public:
    /// Reads the first few thousand lines to see what times count from.
    [[nodiscard]] static Result<LogReader, LogError> open(const FilePlace& file);

    /// The next line that is a frame; empty at the end of the file, and then for ever. An error means that
    /// the file could not be read on: what came before it stays valid.
    [[nodiscard]] Result<std::optional<LogEntry>, LogError> next();

    /// Of lines.
    [[nodiscard]] const Account<LineFault>& account() const noexcept { return account_; }
    /// The 1-based number of the first line with this fault; 0 if there was none.
    [[nodiscard]] std::uint64_t first_line(LineFault fault) const noexcept {
        return account_.rejected(fault) == 0 ? 0 : static_cast<std::uint64_t>(account_.first_place(fault));
    }

    /// Of a file that was read to its end: that it has lines and none of them is a frame, what the first of
    /// them lacks, and the way out: of another program's log the command that converts it.
    [[nodiscard]] std::optional<LogError> foreign_file() const;
    [[nodiscard]] StampKind stamps() const noexcept { return stamps_; }

  private:
    /// The first line that is neither a frame nor blank.
    struct FirstFault {
        std::uint64_t line = 0;
        LineFault fault = LineFault::foreign;
        std::string text;
    };

    LogReader(std::filesystem::path file, LineStream lines, std::string begin, StampKind stamps)
        : file_(std::move(file)), lines_(std::move(lines)), begin_(std::move(begin)), stamps_(stamps) {}
    void note(LineFault fault);

    std::filesystem::path file_;
    LineStream lines_;
    std::string begin_;  ///< of the file, for what format it is
    StampKind stamps_;
    WallTime newest_;  ///< of differences, what they add up to
    std::optional<FirstFault> first_fault_;
    Account<LineFault> account_;  ///< a place is the number of a line
};

}  // namespace octoskin::candump
