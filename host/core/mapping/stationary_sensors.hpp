// Stationary sensors: a new object is on the map at once, and the space of one that has left is free at once.
#pragma once

#include <utility>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/cone_finder.hpp"
#include "host/core/mapping/confirmed_ranges.hpp"
#include "host/core/mapping/evidence.hpp"
#include "host/core/mapping/evidence_sink.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/seen_through.hpp"
#include "host/core/mapping/sensor_history.hpp"

namespace octoskin {

/// Readings from one pose do not show where in the cone the surface is. The hits that the voxels of the cap
/// share therefore mark and free them slowly. Readings that agree do both at once. Not for concurrent use by
/// two threads.
class StationarySensors {
  public:
    explicit StationarySensors(const MappingConfig& config)
        : confirmed_(config.standing), seen_(config.standing), cones_(config) {}

    /// Takes a cone's beam, in the order of measurement. O(zones of the sensor), below 1 us. Throws
    /// std::bad_alloc.
    [[nodiscard]] ConfirmedRanges::Answer take(const Beam& beam) { return confirmed_.take(beam, histories_); }
    /// Applies what the beams up to this one state together; call after the beam was counted. Clears what the
    /// sensor sees through, withdraws ranges that are no longer confirmed, and marks confirmed ranges
    /// occupied. Throws std::bad_alloc.
    void conclude(const Beam& beam, const ConfirmedRanges::Answer& answer, EvidenceSink& sink);
    /// Takes a ray's beam that went into the map: the voxel where it ends must not be cleared.
    void take_ray(const Beam& beam) { (void)seen_.take(beam, cones_.length_m(beam), histories_); }

    /// Clears the state, as if there had been no beam.
    void forget() noexcept { histories_.clear(); }

    /// A copy of the histories. Throws std::bad_alloc.
    [[nodiscard]] SensorHistories histories() const { return histories_; }
    /// Continues from these histories, as if their readings had been taken here.
    void resume_with(SensorHistories histories) noexcept { histories_ = std::move(histories); }

  private:
    void clear_seen_through(const Beam& beam, EvidenceSink& sink);
    void confirm(const Beam& confirmed, CapWidth width, EvidenceSink& sink);

    SensorHistories histories_;
    ConfirmedRanges confirmed_;
    SeenThrough seen_;
    ConeFinder cones_;
    Evidence evidence_;
};

/// How far off its axis a range marks voxels: a stationary sensor marks only where it would also free space.
[[nodiscard]] inline CapWidth width_of(const ConfirmedRanges::Answer& answer) noexcept {
    return answer.is_stationary ? CapWidth::core : CapWidth::whole;
}

}  // namespace octoskin
