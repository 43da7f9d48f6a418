// Lines that others write to a named pipe, taken without waiting.
#pragma once

#include <optional>
#include <string>

namespace octoskin::test {

class LinePipe {
  public:
    /// Opens a pipe that is there; throws std::runtime_error if it cannot.
    explicit LinePipe(const std::string& path);
    ~LinePipe();
    LinePipe(const LinePipe&) = delete;
    LinePipe& operator=(const LinePipe&) = delete;

    /// The next whole line, if there is one.
    [[nodiscard]] std::optional<std::string> next();

  private:
    int pipe_ = -1;
    std::string read_;
};

}  // namespace octoskin::test
