// Bounds the daemon's log, even if an input provokes the same line again and again.
#pragma once

#include <spdlog/sinks/sink.h>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/daemon/clocks.hpp"

namespace octoskin {

/// Passes lines on to other sinks: for each level a burst, and then one in each period. Lines of
/// spdlog::level::critical always pass: a process logs one in its life. May be called from any thread.
class LogLimit final : public spdlog::sinks::sink {
  public:
    static constexpr int kAtOnce = 60;
    static constexpr Nanoseconds kPeriod{2'000'000'000};

    explicit LogLimit(std::vector<std::shared_ptr<spdlog::sinks::sink>> sinks,
                      std::function<HostTime()> now = monotonic_now)
        : sinks_(std::move(sinks)), now_(std::move(now)) {}

    void log(const spdlog::details::log_msg& message) override;
    void flush() override;
    void set_pattern(const std::string& pattern) override;
    void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override;

  private:
    struct Level {
        int room = kAtOnce;
        std::optional<HostTime> grown;  ///< when there was room for one more
        std::uint64_t left_out = 0;     ///< since the newest line that passed
    };
    [[nodiscard]] bool takes(Level& level);
    void pass(const spdlog::details::log_msg& message);

    std::mutex mutex_;
    std::vector<std::shared_ptr<spdlog::sinks::sink>> sinks_;
    std::function<HostTime()> now_;
    std::array<Level, spdlog::level::n_levels> levels_;
};

}  // namespace octoskin
