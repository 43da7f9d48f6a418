// How far a sensor that stands still has surely seen: as far as all of its readings of half a second.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/standing_model.hpp"

namespace octoskin {

/// Counting frees what is gone within a second at 30 readings a second. A zone that is ranged in turn with
/// others has not so many: what three of its readings see through is free.
class StandingSight {
  public:
    static constexpr std::size_t kReadingsMin = 3;

    explicit StandingSight(const StandingModel& model) : model_(model) {}

    /// Takes a beam that went into the map, in the order in which they do, and how far that freed space at
    /// most. The answer, as a rule none: the shortest of the zone's newest readings, as many as last
    /// `StandingModel::clears_after_s`, if all are of one place (StandingRanges). It is told when it is news:
    /// at first, when it is longer than what was told, and after something was nearer than that. O(readings
    /// of so long), below 1 us; 0.2 kB each. Throws std::bad_alloc.
    [[nodiscard]] std::optional<Beam> take(const Beam& beam, double frees_m);

    /// As if there had been no beam.
    void forget() noexcept { zones_.clear(); }

  private:
    struct Reading {
        Beam beam;
        double frees_m = 0.0;
    };
    struct Zone {
        std::vector<Reading> newest;  ///< of one place, the newest last
        std::optional<double> told_m;
    };

    /// Leaves out what is older than it need be.
    void keep_newest(std::vector<Reading>& readings) const;
    [[nodiscard]] bool lasts(const std::vector<Reading>& readings, std::size_t from) const;

    StandingModel model_;
    std::map<BeamSource, Zone> zones_;
};

}  // namespace octoskin
