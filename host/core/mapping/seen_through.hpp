// How far a sensor that does not move has surely seen: as far as all of its readings of half a second.
#pragma once

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <utility>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/stationary_model.hpp"

namespace octoskin {

/// Counting frees what is gone within a second at 30 readings a second. A zone that is ranged in turn with
/// others has not so many: what three of its readings see through is free, if no other reading ends there.
class SeenThrough {
  public:
    static constexpr std::size_t kReadingsMin = 3;

    struct Reading {
        Beam beam;
        double frees_m = 0.0;
    };
    using Readings = std::deque<Reading>;  ///< of a zone, the newest last; none if there was no memory
    using Zones = std::map<BeamSource, Readings>;

    explicit SeenThrough(const StationaryModel& model) : model_(model) {}

    /// Takes a beam, of a ray, too, that went into the map, and how far that frees space. The answer: the
    /// shortest of the zone's newest readings of this place (ConfirmedRanges), as many as last
    /// `StationaryModel::clears_after_s` and no longer than twice that; null while there are not three, or
    /// not of so long; valid until the next call. A beam that frees nothing is none. O(readings of so long),
    /// below 1 us; 0.2 kB each. Throws std::bad_alloc.
    [[nodiscard]] const Beam* take(const Beam& beam, double frees_m);

    /// Whether `ends_there` says so of one of the two newest readings of any zone, for the newest may be
    /// wrong, if that has a range and is no older than `now` by as long as readings count. O(zones).
    template <class EndsThere>
    [[nodiscard]] bool any_newest(HostTime now, const EndsThere& ends_there) const {
        const auto says_so = [&](const Reading& reading) {
            const Beam& beam = reading.beam;
            return beam.range_m && counts(beam, now) && ends_there(beam);
        };
        return std::ranges::any_of(zones_, [&](const auto& zone) {
            const Readings& readings = zone.second;
            const auto newest = std::min<std::ptrdiff_t>(std::ssize(readings), 2);
            return std::any_of(readings.end() - newest, readings.end(), says_so);
        });
    }

    /// As if there had been no beam.
    void forget() noexcept { zones_.clear(); }
    /// All that what comes next follows from, and how another one goes on with it.
    [[nodiscard]] const Zones& zones() const noexcept { return zones_; }
    void go_on_with(Zones zones) noexcept { zones_ = std::move(zones); }

  private:
    /// What was not measured for longer may have come and gone.
    [[nodiscard]] bool counts(const Beam& before, HostTime now) const {
        return seconds_since(before, now) <= 2.0 * model_.clears_after_s;
    }
    [[nodiscard]] bool lasts(const Readings& readings, std::size_t from) const;

    StationaryModel model_;
    Zones zones_;
};

}  // namespace octoskin
