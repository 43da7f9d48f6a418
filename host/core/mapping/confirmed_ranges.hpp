// Finds ranges to confirm at once: ranges on which the newest readings of a stationary sensor agree, after it
// has seen further or has only just stopped.
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

/// A single reading may be wrong and is never confirmed alone. Readings agree either within one zone, or
/// among several zones of a sensor that range in turn, because a new object is usually in front of many of
/// them.
class ConfirmedRanges {
  public:
    /// Two readings are from one place if the sensor has moved and turned no further between them. A sensor
    /// may therefore move by this much within `StationaryModel::readings` - 1 readings, and its ranges are
    /// still confirmed.
    static constexpr double kMovedMax_m = 0.01;
    static constexpr double kTurnedMax_rad = 0.0175;
    /// Ranges of one zone agree within this plus `kAgreementSigmas` of the larger sigma. Between two zones,
    /// the angle between them times the range is added, because a surface is seldom perpendicular to both.
    static constexpr double kAgreement_m = 0.02;
    static constexpr double kAgreementSigmas = 3.0;
    /// Number of a zone's readings before the window that are compared with those in it.
    static constexpr std::size_t kBefore = 3;

    [[nodiscard]] static bool are_of_one_place(const Beam& a, const Beam& b);

    explicit ConfirmedRanges(const StationaryModel& model) : model_(model) {}

    struct Answer {
        /// Ranges that are confirmed now, one for each zone: the zone's newest beam, with the mean of the
        /// ranges that agree. Usually empty; valid until the next call.
        std::span<const Beam> confirmed;
        /// Ranges that are no longer confirmed although the sensor has not moved. The hits that they left in
        /// their caps and that mark nothing are to be withdrawn (EvidenceRule::withdraw). Valid until the
        /// next call.
        std::span<const Beam> ended;
        /// The beam repeats a range that was confirmed before it. Readings from one place cannot locate the
        /// surface within the cap, so its hits go to the occupied voxels there.
        bool repeats_confirmed = false;
        /// The beam is from one place with the last `StationaryModel::window()` beams of its zone. It then
        /// marks voxels occupied only where it would also free space.
        bool is_stationary = false;
    };
    /// Takes a beam that goes into the map; call in the order of the map. A range is first confirmed while it
    /// is new: if none of the zone's `kBefore` readings before the window was from this place and as short.
    /// Each later reading of its zone that agrees with it confirms it again, and so does each reading of
    /// another zone that sees further. The confirmation ends when `kBefore` readings of the zone in a row
    /// disagree. If that many are missing, all readings of the zone are cleared. O(zones of the sensor),
    /// below 1 us. Throws std::bad_alloc.
    [[nodiscard]] Answer take(const Beam& beam, SensorHistories& histories);

    [[nodiscard]] const StationaryModel& model() const noexcept { return model_; }
    /// Maximum number of readings stored for a zone; none of them was captured after the last one. A zone
    /// with a confirmed range has at least one.
    [[nodiscard]] static std::size_t readings_max(const StationaryModel& model) noexcept {
        return model.window() + kBefore;
    }

  private:
    using Reading = ZoneHistory::Reading;
    /// The zones that have readings in a window, each with the index of its first reading there.
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
