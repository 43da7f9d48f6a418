// Writes the daemon's log in its own thread: a terminal, pipe or journal that takes no lines blocks only that
// thread.
#pragma once

#include <spdlog/sinks/sink.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/quiet_thread.hpp"

namespace octoskin {

struct LogRecord {
    std::uint64_t dropped = 0;            ///< lines, for lack of room
    std::size_t waiting = 0;              ///< lines not written yet
    std::optional<HostTime> stuck_since;  ///< since when one line is being written; empty: none is
};

/// Passes lines to other sinks, in their order. May be called from any thread, and never waits.
class LogQueue final : public spdlog::sinks::sink {
  public:
    /// Bytes that may wait: the lines of some hours. Beyond this a line is dropped, and before the next
    /// written line comes one with the number of dropped lines.
    static constexpr std::size_t kBytesMax = std::size_t{1} << 20U;
    /// Of a longer line the beginning is kept, and its length in bytes.
    static constexpr std::size_t kLineMax = 4096;
    /// How long waiting lines are written at the end.
    static constexpr Nanoseconds kEndPatience{1'000'000'000};

    /// Throws std::system_error if there is no thread left.
    explicit LogQueue(std::vector<std::shared_ptr<spdlog::sinks::sink>> sinks,
                      std::size_t bytes_max = kBytesMax, Nanoseconds end_patience = kEndPatience);
    /// Writes the waiting lines; a write that hangs is left behind after `end_patience`.
    ~LogQueue() override;
    LogQueue(const LogQueue&) = delete;
    LogQueue& operator=(const LogQueue&) = delete;

    void log(const spdlog::details::log_msg& message) override;
    void flush() override {}  // each line is flushed when it is written
    // These wait for a line being written: call them before the first.
    void set_pattern(const std::string& pattern) override;
    void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override;

    [[nodiscard]] LogRecord record() const;
    /// Number of waiting lines, for a signal handler.
    [[nodiscard]] const std::atomic<std::size_t>& waiting() const;

  private:
    class Work;
    std::shared_ptr<Work> work_;
    Nanoseconds end_patience_;
    LeavableThread thread_;
};

/// From now on the log of this process has the bounds of LogLimit and LogQueue; its format is set again. If a
/// defect ends the process, by a signal or std::terminate, the waiting lines are written before, for at most
/// kEndPatience, and the exception is logged. Throws std::system_error if there is no thread or descriptor
/// left.
[[nodiscard]] std::shared_ptr<const LogQueue> guard_log();

}  // namespace octoskin
