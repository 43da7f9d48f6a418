// SIGINT and SIGTERM, taken in order to end a command's work rather than its process: what it has to tell is
// told.
#pragma once

#include <chrono>
#include <csignal>
#include <initializer_list>
#include <optional>

namespace octoskin::app {

class EndSignals {
  public:
    /// From now on those that are `wanted` are kept for this. Throws std::system_error if there is no
    /// descriptor to be had.
    explicit EndSignals(std::initializer_list<int> wanted = {SIGINT, SIGTERM});
    ~EndSignals();
    EndSignals(const EndSignals&) = delete;
    EndSignals& operator=(const EndSignals&) = delete;

    /// Readable once one came.
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
    /// Takes one, for which it waits so long at most; which one, if one came.
    [[nodiscard]] std::optional<int> came(std::chrono::milliseconds patience) const;

  private:
    int descriptor_ = -1;
};

}  // namespace octoskin::app
