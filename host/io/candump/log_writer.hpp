// Writes a candump log that candump's companion programs can read.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "common/result.hpp"
#include "host/io/candump/log_line.hpp"
#include "host/io/candump/log_reader.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::candump {

class LogWriter {
  public:
    /// Creates `file` and replaces an existing one. `interface`: the name on every line; an error if it is
    /// not valid (wire::is_interface_name).
    [[nodiscard]] static Result<LogWriter, Error> create(const FilePlace& file,
                                                         std::string interface = "can0");

    /// Appends one line. Buffered: a full disk may be reported only by `close()`. Asserts as `format_line()`
    /// does.
    [[nodiscard]] Status<Error> write(WallTime stamp, const wire::CanFrame& frame);

    /// Flushes and closes. Without this call a write error may remain undetected.
    [[nodiscard]] Status<Error> close();

  private:
    LogWriter(std::filesystem::path file, std::ofstream stream, std::string interface)
        : file_(std::move(file)), stream_(std::move(stream)) {
        entry_.interface = std::move(interface);
    }
    std::filesystem::path file_;
    std::ofstream stream_;
    LogEntry entry_;
};

}  // namespace octoskin::candump
