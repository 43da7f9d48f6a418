// The daemon's log is written by a thread of its own: a terminal, pipe or journal that takes nothing holds up
// that thread alone.
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
    std::uint64_t dropped = 0;            ///< lines, for want of room
    std::size_t waiting = 0;              ///< lines that are not written yet
    std::optional<HostTime> stuck_since;  ///< the line that is being written; empty: none is
};

/// Lines on their way to other sinks, in their order. May be called from any thread, and never waits.
class LogQueue final : public spdlog::sinks::sink {
  public:
    /// What may wait: the lines of some hours. Beyond, a line is dropped, and the next one that is written
    /// comes after one that tells how many were.
    static constexpr std::size_t kBytesMax = std::size_t{1} << 20U;
    /// Of a longer line the beginning is kept, and how many bytes it had.
    static constexpr std::size_t kLineMax = 4096;
    /// What waits at the end is written for so long.
    static constexpr Nanoseconds kEndPatience{1'000'000'000};

    /// Throws std::system_error if there is no thread to be had.
    explicit LogQueue(std::vector<std::shared_ptr<spdlog::sinks::sink>> sinks,
                      std::size_t bytes_max = kBytesMax, Nanoseconds end_patience = kEndPatience);
    /// Writes what waits; a write that hangs is left behind after the patience of the end.
    ~LogQueue() override;
    LogQueue(const LogQueue&) = delete;
    LogQueue& operator=(const LogQueue&) = delete;

    void log(const spdlog::details::log_msg& message) override;
    void flush() override {}  // each line is flushed as it is written
    // Wait for a line that is being written: to be called before the first.
    void set_pattern(const std::string& pattern) override;
    void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override;

    [[nodiscard]] LogRecord record() const;
    /// How many wait, for a signal handler.
    [[nodiscard]] const std::atomic<std::size_t>& waiting() const;

  private:
    class Work;
    std::shared_ptr<Work> work_;
    Nanoseconds end_patience_;
    LeavableThread thread_;
};

/// From now on the log of this process has the bounds of LogLimit and LogQueue; its format is set anew. What
/// waits when a defect ends the process, by a signal or std::terminate, is written before, for kEndPatience
/// at most; and what was thrown is logged. Throws std::system_error if there is no thread, or no descriptor,
/// to be had.
[[nodiscard]] std::shared_ptr<const LogQueue> guard_log();

}  // namespace octoskin
