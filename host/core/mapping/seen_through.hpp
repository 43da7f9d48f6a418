// How far a stationary sensor has reliably seen: as far as all of its readings within half a second.
#pragma once

#include <algorithm>
#include <deque>
#include <iterator>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/sensor_history.hpp"
#include "host/core/mapping/stationary_model.hpp"

namespace octoskin {

/// At 30 readings a second, counting frees the space of an object that has left within a second. A zone that
/// ranges in turn with others has fewer readings: what three of its readings see through is free, if no other
/// reading ends there.
class SeenThrough {
  public:
    static constexpr std::size_t kReadingsMin = 3;

    explicit SeenThrough(const StationaryModel& model) : model_(model) {}

    /// Takes a beam that went into the map (a cone's or a ray's) and the length over which it frees space.
    /// Returns the shortest of the zone's newest readings from this place (ConfirmedRanges) that span at
    /// least `StationaryModel::clears_after_s` and at most twice that. Null if there are fewer than three, or
    /// they span less; valid until the next call. A beam that frees nothing is ignored. O(readings in that
    /// time), below 1 us; 0.2 kB each. Throws std::bad_alloc.
    [[nodiscard]] const Beam* take(const Beam& beam, double frees_m, SensorHistories& histories) const;

    /// True if `ends_there` holds for one of the two newest readings of any zone; two, because the newest may
    /// be wrong. Only readings with a range count, and only if they are recent enough at `now`. O(zones).
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

    /// A space that was not measured for longer may have been occupied meanwhile.
    [[nodiscard]] bool counts(const Beam& before, HostTime now) const {
        return seconds_since(before, now) <= 2.0 * model_.clears_after_s;
    }
    [[nodiscard]] bool lasts(const Passages& passages, std::size_t from) const;

    StationaryModel model_;
};

}  // namespace octoskin
