// Checks whether two senders report about one node: contradicting values that alternate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "common/time.hpp"
#include "host/core/ingest/rate_limit.hpp"

namespace octoskin {

/// Covers the reports that decide whether a node's readings count: whether it suspects its time, its
/// node_hash, its build, and for each sensor whether its times are certain enough. A node does not change the
/// first three while it runs. It reports a sensor's bound once a second, and at once when the bound grows:
/// that result changes at most three times within a second. A damaged frame that passes CRC-8 causes two
/// changes. More changes come from two senders.
class SelfReportCheck {
  public:
    enum class Fact : std::uint8_t { time_suspect, hash_low, hash, build, certain };

    /// `sensor`: 0 if the fact is not about a sensor. `now`: empty while unknown; then nothing is decided.
    /// Allocates at the first report of each fact.
    void on_report(Fact fact, std::uint8_t sensor, std::uint32_t value, std::optional<HostTime> now);
    /// The node restarted, perhaps with another build.
    void forget() noexcept;

    /// True if one fact changed too often within the last kNamedFor.
    [[nodiscard]] bool hears_two(HostTime now) const noexcept;
    /// Number of changes beyond the limit.
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
