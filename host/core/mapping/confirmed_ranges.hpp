// Which ranges are confirmed at once: those on which the newest readings of a sensor that does not move
// agree, after it has seen further, or has only just stopped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/sensor_history.hpp"
#include "host/core/mapping/stationary_model.hpp"

namespace octoskin {

/// One reading may be wrong, so that none is confirmed alone. What agrees are either readings of one zone, or
/// of several zones of a sensor, which are ranged in turn: what has come is before many of them.
class ConfirmedRanges {
  public:
    /// Two readings are of one place if the sensor has moved and turned no further between them. So it may
    /// move by as much within `StationaryModel::readings` - 1 readings, and its ranges are confirmed still.
    static constexpr double kMovedMax_m = 0.01;
    static constexpr double kTurnedMax_rad = 0.0175;
    /// Ranges of one zone agree to this and so many of the larger sigma; of two zones to the angle between
    /// them times the range more, for a surface is seldom square to both.
    static constexpr double kAgreement_m = 0.02;
    static constexpr double kAgreementSigmas = 3.0;
    /// Readings of a zone before the window that are held against those in it.
    static constexpr std::size_t kBefore = 3;

    [[nodiscard]] static bool are_of_one_place(const Beam& a, const Beam& b);

    explicit ConfirmedRanges(const StationaryModel& model) : model_(model) {}

    struct Answer {
        /// Which ranges are confirmed now, one for each zone: the zone's newest beam, with the mean of the
        /// ranges that agree. None as a rule; valid until the next call.
        std::span<const Beam> confirmed;
        /// Those that were, and are no more though the sensor is where it was: what they left in their caps
        /// that marks nothing is to be taken back (EvidenceRule::withdraw). Valid likewise.
        std::span<const Beam> ended;
        /// The beam repeats what was confirmed before it. From one place no number of readings localises that
        /// within the cap, so its hits go to what is occupied there.
        bool repeats_confirmed = false;
        /// The beam is of one place with the last `StationaryModel::window()` before it of its zone: then it
        /// marks only where it would free space, too.
        bool is_stationary = false;
    };
    /// Takes a beam that goes into the map, in the order in which they do. A range is confirmed first while
    /// it is new: if none of the `kBefore` readings of its zone before the window was of this place and as
    /// short. It stays confirmed, with each reading of its zone that agrees with it, and with those of other
    /// zones that see further, until `kBefore` in a row do not agree; or do not come: then all readings of
    /// the zone are forgotten. O(zones of the sensor), below 1 us. Throws std::bad_alloc.
    [[nodiscard]] Answer take(const Beam& beam, SensorHistories& histories);

    [[nodiscard]] const StationaryModel& model() const noexcept { return model_; }
    /// So many readings of a zone it keeps at most, none later than the last; where a range is confirmed, one
    /// at least.
    [[nodiscard]] static std::size_t readings_max(const StationaryModel& model) noexcept {
        return model.window() + kBefore;
    }

  private:
    using Reading = ZoneHistory::Reading;
    /// The first reading of a zone in a window.
    using Window = std::vector<std::pair<ZoneHistory*, std::size_t>>;

    void confirm(const Beam& newest, const Window& window);
    [[nodiscard]] bool is_stationary(const ZoneHistory& zone) const;
    void forget_silent(SensorHistory& sensor, const Beam& beam);
    [[nodiscard]] bool follow_confirmed(ZoneHistory& zone);
    void end(ZoneHistory& zone, const Beam& now);
    void add_persisting(const Beam& newest, const SensorHistory& sensor);

    StationaryModel model_;
    Window window_;
    std::vector<Reading*> agreeing_;
    std::vector<Beam> confirmed_;
    std::vector<Beam> ended_;
};

}  // namespace octoskin
