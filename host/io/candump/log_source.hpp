// A log as the pipeline's source of frames.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "host/core/pipeline/can_source.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin::candump {

class LogSource final : public CanSource {
  public:
    /// `interface`: only frames of this one are returned; empty: all.
    explicit LogSource(LogReader reader, std::string interface = "")
        : reader_(std::move(reader)), interface_(std::move(interface)) {}

    [[nodiscard]] Result<std::optional<StampedFrame>, Error> next() override {
        for (;;) {
            Result<std::optional<LogEntry>, Error> entry = reader_.next();
            if (!entry) return unexpected(entry.error());
            if (!*entry) return std::optional<StampedFrame>{};
            if (interface_.empty() || (*entry)->interface == interface_) {
                newest_interface_ = std::move((*entry)->interface);
                return std::optional(StampedFrame{(*entry)->stamp, (*entry)->frame});
            }
            ++other_interface_;
        }
    }

    /// For its line counters.
    [[nodiscard]] const LogReader& reader() const noexcept { return reader_; }
    /// The interface of the last returned frame.
    [[nodiscard]] const std::string& newest_interface() const noexcept { return newest_interface_; }
    /// Number of frames of other interfaces.
    [[nodiscard]] std::uint64_t other_interface() const noexcept { return other_interface_; }

  private:
    LogReader reader_;
    std::string interface_;
    std::string newest_interface_;
    std::uint64_t other_interface_ = 0;
};

}  // namespace octoskin::candump
