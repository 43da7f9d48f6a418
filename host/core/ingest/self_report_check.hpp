// Whether what a node reports about itself comes from two senders: one thing and the contrary, by turns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "common/time.hpp"
#include "host/core/ingest/rate_limit.hpp"

namespace octoskin {

/// What decides whether a node's readings count: whether it suspects its time, its node_hash, its build, and
/// of each sensor whether its times are certain enough. A node changes none of the first three while it runs.
/// It reports a sensor's bound once a second, and at once where that grows: its verdict changes up to three
/// times within a second. A damaged frame that passes CRC-8 makes two changes. More are two senders.
class SelfReportCheck {
  public:
    enum class Fact : std::uint8_t { time_suspect, hash_low, hash, build, certain };

    /// `sensor`: 0 where the fact is not of one. `now`: empty while unknown; then nothing is judged.
    /// Allocates at the first of each fact.
    void on_report(Fact fact, std::uint8_t sensor, std::uint32_t value, std::optional<HostTime> now);
    /// The node started anew, and may be another build.
    void forget() noexcept;

    /// One fact changed too often within the last kNamedFor.
    [[nodiscard]] bool hears_two(HostTime now) const noexcept;
    /// Changes that were one too many for their second.
    [[nodiscard]] std::uint64_t contradictions() const noexcept { return contradictions_; }

    static constexpr std::size_t kChangesMax = 3;  ///< within a second
    static constexpr Nanoseconds kNamedFor{2'500'000'000};

  private:
    struct Newest {
        std::optional<std::uint32_t> value;
        RateLimit changes{kChangesMax};
    };
    std::map<std::pair<Fact, std::uint8_t>, Newest> newest_;
    std::optional<HostTime> contradicted_;
    std::uint64_t contradictions_ = 0;
};

}  // namespace octoskin
