// Receives SIGINT and SIGTERM as readable events, so that a command stops its work in order and reports its
// results.
#pragma once

#include <chrono>
#include <csignal>
#include <initializer_list>
#include <optional>

namespace octoskin::app {

class EndSignals {
  public:
    /// From now on the signals in `wanted` are delivered here only. Throws std::system_error if no descriptor
    /// can be made.
    explicit EndSignals(std::initializer_list<int> wanted = {SIGINT, SIGTERM});
    ~EndSignals();
    EndSignals(const EndSignals&) = delete;
    EndSignals& operator=(const EndSignals&) = delete;

    /// Readable when a signal is pending.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Takes one pending signal; waits at most `patience`. Returns its number, or nothing.
    [[nodiscard]] std::optional<int> came(std::chrono::milliseconds patience) const;

  private:
    int descriptor_ = -1;
};

}  // namespace octoskin::app
