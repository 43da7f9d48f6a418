// Reads a candump log line by line. Lines without a frame are counted by their fault; they are never fatal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/errors/error.hpp"
#include "host/io/candump/log_line.hpp"
#include "host/io/candump/stamp_kind.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/lines/line_stream.hpp"

namespace octoskin::candump {

/// Holds one line in memory. Speed: about 2 million lines a second. Text may be UTF-8 or UTF-16. Times that
/// are differences (`candump -t d`) are added up.
class LogReader {
  public:
    /// Reads the first few thousand lines to find the reference of the times.
    [[nodiscard]] static Result<LogReader, Error> open(const FilePlace& file);

    /// The next line with a frame; empty at the end of the file and at every later call. An error means that
    /// reading failed; earlier entries stay valid.
    [[nodiscard]] Result<std::optional<LogEntry>, Error> next();

    /// Counters of the lines.
    [[nodiscard]] const InputCounters<LineFault>& inputs() const noexcept { return inputs_; }
    /// The number, from 1, of the first line with this fault; 0 if there is none.
    [[nodiscard]] std::uint64_t first_line(LineFault fault) const noexcept {
        return inputs_.rejected(fault) == 0 ? 0 : static_cast<std::uint64_t>(inputs_.first_place(fault));
    }

    /// For a file that was read to its end and has lines, but no frame: the fault of the first line, and the
    /// remedy. For a log of another program that is the command that converts it.
    [[nodiscard]] std::optional<Error> foreign_file() const;
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
    std::string begin_;  ///< of the file, to recognise its format
    StampKind stamps_;
    WallTime newest_;  ///< sum of the differences so far
    std::optional<FirstFault> first_fault_;
    InputCounters<LineFault> inputs_;  ///< counters; the places are line numbers
};

}  // namespace octoskin::candump
