// Writes a candump log that candump's own companion tools read.
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
    /// Makes `file` anew, in place of one that is there. `interface`: the name on every line;
    /// an error that says so, if it is none (wire::is_interface_name).
    [[nodiscard]] static Result<LogWriter, LogError> create(const FilePlace& file,
                                                            std::string interface = "can0");

    /// Appends one line. Buffered: a full disk may show only in `close()`. Asserts as `format_line()` does.
    [[nodiscard]] Status<LogError> write(WallTime stamp, const wire::CanFrame& frame);

    /// Flushes and closes. Without it the log may be incomplete and nobody knows.
    [[nodiscard]] Status<LogError> close();

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
