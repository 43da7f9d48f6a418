// Reads lines from a named pipe without blocking.
#pragma once

#include <optional>
#include <string>

namespace octoskin::test {

class LinePipe {
  public:
    /// Opens an existing pipe; throws std::runtime_error if it cannot.
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
