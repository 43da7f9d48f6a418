// Maps one node's clock to the host's clock: an affine map with an error bound that grows with silence. Nodes
// never adjust their clocks; the two clocks are related only here.
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
    /// Bound on the error of one exchange: the host's and the node's time stamp together.
    Nanoseconds stamp_error{100'000};
    /// Bound on the relative rate: two crystals of +-100 ppm, with a margin.
    double drift_max = 250e-6;
    /// Bound on how fast the rate changes, per second: a crystal of 0.5 ppm/K that warms by 1 K/s.
    double wander_per_s = 0.5e-6;
    /// The line uses at most this many exchanges.
    std::size_t window = 8;
    /// An exchange is used for instants from this long after it. Its report has arrived by then, so the
    /// mapping of an instant does not depend on the order in which two frames arrive.
    Microseconds settling{200'000};
    /// After this long without an exchange the time is not known.
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

/// Effect of an exchange on the map.
enum class SampleEffect : std::uint8_t {
    used,
    contradicts,  ///< the map is in doubt until the next exchange
    relocked,  ///< the second in a row that contradicts the map, and it agrees with the first: starts a new
               ///< map
};

/// An instant of a node on the host's clock.
struct MappedTime {
    HostTime time;
    Nanoseconds error_bound{0};
};

class ClockMap {
  public:
    explicit ClockMap(const ClockMapConfig& config = {}) : config_(config) {}

    /// Adds an exchange of the node, in the order of host times. O(window).
    SampleEffect add(const SyncSample& sample);
    /// True if the exchange continues the known ones. False if none is known, and while the clock is in
    /// doubt.
    [[nodiscard]] bool fits(const SyncSample& sample) const {
        return !points_.empty() && !suspect_ && is_consistent(sample);
    }
    /// The node restarted: clears the state of its clock.
    void forget();

    /// Finds the newest instant not after `now` (plus slack) at which the node clock reads `residue` modulo
    /// its span, on the host's clock: least squares over the last `window` exchanges that have settled by
    /// then. `error_bound` holds if the values of ClockMapConfig do. O(window), below 1 us.
    [[nodiscard]] Result<MappedTime, ClockFault> locate(const wire::TimeResidue& residue, HostTime now) const;

    /// Why `locate` fails at present; empty if it may succeed.
    [[nodiscard]] std::optional<ClockFault> fault(HostTime now) const;
    /// Error bound of `locate` for an instant at `now`; empty while there is none.
    [[nodiscard]] std::optional<Nanoseconds> error_bound(HostTime now) const;
    /// Relative rate of the node's clock, host seconds per node second - 1; empty before two exchanges.
    [[nodiscard]] std::optional<double> drift() const;
    /// How often two exchanges in a row agreed on a new map.
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
    std::vector<Point> points_;  ///< ascending; the newest points of the current run without contradiction
    NodeTime heard_last_;        ///< the counter at points_.back()
    std::optional<SyncSample> suspect_;
    std::uint64_t relocks_ = 0;
};

}  // namespace octoskin
