// How far a sensor that does not move has surely seen: as far as all of its readings of half a second.
#pragma once

#include <algorithm>
#include <deque>
#include <iterator>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/sensor_history.hpp"
#include "host/core/mapping/stationary_model.hpp"

namespace octoskin {

/// Counting frees what is gone within a second at 30 readings a second. A zone that is ranged in turn with
/// others has not so many: what three of its readings see through is free, if no other reading ends there.
class SeenThrough {
  public:
    static constexpr std::size_t kReadingsMin = 3;

    explicit SeenThrough(const StationaryModel& model) : model_(model) {}

    /// Takes a beam, of a ray, too, that went into the map, and how far that frees space. The answer: the
    /// shortest of the zone's newest readings of this place (ConfirmedRanges), as many as last
    /// `StationaryModel::clears_after_s` and no longer than twice that; null while there are not three, or
    /// not of so long; valid until the next call. A beam that frees nothing is none. O(readings of so long),
    /// below 1 us; 0.2 kB each. Throws std::bad_alloc.
    [[nodiscard]] const Beam* take(const Beam& beam, double frees_m, SensorHistories& histories) const;

    /// Whether `ends_there` says so of one of the two newest readings of any zone, for the newest may be
    /// wrong, if that has a range and is no older than `now` by as long as readings count. O(zones).
    template <class EndsThere>
    [[nodiscard]] bool any_newest(HostTime now, const SensorHistories& histories,
                                  const EndsThere& ends_there) const {
        const auto says_so = [&](const Passage& passage) {
            const Beam& beam = passage.beam;
            return beam.range_m && counts(beam, now) && ends_there(beam);
        };
        const auto newest_say_so = [&](const auto& zone) {
            const Passages& passages = zone.second.passages;
            const auto newest = std::min<std::ptrdiff_t>(std::ssize(passages), 2);
            return std::any_of(passages.end() - newest, passages.end(), says_so);
        };
        return std::ranges::any_of(histories, [&](const auto& sensor) {
            return std::ranges::any_of(sensor.second.zones, newest_say_so);
        });
    }

  private:
    using Passage = ZoneHistory::Passage;
    using Passages = std::deque<Passage>;

    /// What was not measured for longer may have come and gone.
    [[nodiscard]] bool counts(const Beam& before, HostTime now) const {
        return seconds_since(before, now) <= 2.0 * model_.clears_after_s;
    }
    [[nodiscard]] bool lasts(const Passages& passages, std::size_t from) const;

    StationaryModel model_;
};

}  // namespace octoskin
