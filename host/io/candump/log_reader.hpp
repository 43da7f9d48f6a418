// Reads a candump log line by line. Lines that are no frames are counted under a name, never fatal.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/account/account.hpp"
#include "host/io/candump/log_line.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::candump {

/// The file itself fails: "can.log: cannot open: No such file or directory".
struct LogError {
    std::filesystem::path file;
    std::string what;
    [[nodiscard]] std::string message() const { return file.string() + ": " + what; }
};

/// Holds one line at a time, whatever the file's size. About 2 million lines a second.
class LogReader {
  public:
    [[nodiscard]] static Result<LogReader, LogError> open(const FilePlace& file);

    /// The next line that is a frame; empty at the end of the file, and then for ever. An error means that
    /// the file could not be read on: what came before it stays valid.
    [[nodiscard]] Result<std::optional<LogEntry>, LogError> next();

    /// Of lines.
    [[nodiscard]] const Account<LineFault>& account() const noexcept { return account_; }
    /// The 1-based number of the first line with this fault; 0 if there was none.
    [[nodiscard]] std::uint64_t first_line(LineFault fault) const noexcept {
        return first_line_[static_cast<std::size_t>(fault)];
    }

    /// Of a file that was read to its end: that it has lines and none of them is a frame, with the way out.
    [[nodiscard]] std::optional<LogError> foreign_file() const;

  private:
    enum class LineEnd : std::uint8_t { line_feed, end_of_file, nothing_left, too_long };

    LogReader(std::filesystem::path file, std::ifstream stream)
        : file_(std::move(file)), stream_(std::move(stream)) {}
    LineEnd read_line();
    Result<LogEntry, LineFault> parse(LineEnd end) const;

    std::filesystem::path file_;
    std::ifstream stream_;
    std::string line_;
    std::uint64_t line_number_ = 0;
    Account<LineFault> account_;
    std::array<std::uint64_t, Account<LineFault>::kReasons> first_line_{};
};

}  // namespace octoskin::candump
