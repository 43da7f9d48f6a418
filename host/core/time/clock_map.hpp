// From one node's clock to the host's: an affine map with an error bound that grows with silence. Nodes never
// adjust their clocks; this is the only place where the two meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/time/sync_exchange.hpp"

namespace octoskin {

struct ClockMapConfig {
    /// Bound on the error of one exchange: the host's stamp and the node's together.
    Nanoseconds stamp_error{100'000};
    /// Bound on the relative rate: two crystals of +-100 ppm, and some margin.
    double drift_max = 250e-6;
    /// Bound on how fast the rate changes, per second: a crystal of 0.5 ppm/K that warms by 1 K/s.
    double wander_per_s = 0.5e-6;
    /// The line goes through this many exchanges at most.
    std::size_t window = 8;
    /// An exchange counts for instants from this long after it. By then its report has arrived, so that the
    /// map of an instant does not depend on which of two frames came first.
    Microseconds settling{200'000};
    /// No exchange for this long: no time.
    Microseconds silence_max{5'000'000};
    /// "Now" may be this much too early (HostClockConfig::back_tolerance).
    Microseconds now_slack{5'000};
};

enum class ClockFault : std::uint8_t {
    not_ready,  ///< fewer than two exchanges
    in_doubt,   ///< the newest exchange contradicts those before: the node's clock jumped, or one of them is
                ///< wrong
    silent,     ///< no exchange within `silence_max`
};

/// What an exchange did to the map.
enum class SampleVerdict : std::uint8_t {
    used,
    contradicts,  ///< the map is in doubt until the next exchange
    relocked,     ///< the second in a row that contradicts the map, and agrees with the first: a new map
};

/// An instant of a node, on the host's clock.
struct MappedTime {
    HostTime time;
    Nanoseconds error_bound{0};
};

class ClockMap {
  public:
    explicit ClockMap(const ClockMapConfig& config = {}) : config_(config) {}

    /// The exchanges of one node in the order of their host times. O(window).
    SampleVerdict add(const SyncSample& sample);
    /// Whether it goes on where those before it were, as far as any are known: false while the clock is in
    /// doubt.
    [[nodiscard]] bool fits(const SyncSample& sample) const {
        return !points_.empty() && !suspect_ && is_consistent(sample);
    }
    /// The node restarted: whatever was known of its clock is void.
    void forget();

    /// The newest instant not after `now` (plus slack) whose node clock reads `residue` modulo its span, on
    /// the host's clock: least squares over the last `window` exchanges that have settled by then.
    /// `error_bound` holds if the figures of ClockMapConfig do. O(window), below 1 us.
    [[nodiscard]] Result<MappedTime, ClockFault> locate(const wire::TimeResidue& residue, HostTime now) const;

    /// What "now" is good for at the moment; empty if `locate` may succeed.
    [[nodiscard]] std::optional<ClockFault> fault(HostTime now) const;
    /// Bound on the error of an instant that is `now`, as `locate` would tell it; empty while it cannot.
    [[nodiscard]] std::optional<Nanoseconds> error_bound(HostTime now) const;
    /// Relative rate of the node's clock, host seconds per node second - 1; empty before two exchanges.
    [[nodiscard]] std::optional<double> drift() const;
    /// How often two exchanges in a row agreed on another map than before.
    [[nodiscard]] std::uint64_t relocks() const noexcept { return relocks_; }

  private:
    /// Node time without wrap: congruent to the counter modulo 2^32.
    struct Point {
        std::int64_t node_us = 0;
        HostTime host;
    };
    struct Line;

    [[nodiscard]] bool is_plausible_step(const SyncSample& from, const SyncSample& to) const;
    [[nodiscard]] bool is_consistent(const SyncSample& sample) const;
    /// Through the last `window` of the first `count` points.
    [[nodiscard]] Line line(std::size_t count) const;
    [[nodiscard]] std::int64_t unwrap(const wire::TimeResidue& residue, HostTime now) const;

    ClockMapConfig config_;
    std::vector<Point> points_;  ///< ascending; the last few of the current run without contradiction
    NodeTime heard_last_;        ///< the counter at points_.back()
    std::optional<SyncSample> suspect_;
    std::uint64_t relocks_ = 0;
};

}  // namespace octoskin
