// Sensors that do not move: what came before one is on the map at once, and what left is free at once.
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

/// From one pose no reading says where in its cone the surface is, so that shares of hits take long to mark
/// and long to free. Readings that agree do both at once. Not for two threads at once.
class StationarySensors {
  public:
    explicit StationarySensors(const MappingConfig& config)
        : confirmed_(config.standing), seen_(config.standing), cones_(config) {}

    /// Takes a cone's beam, in the order in which they are measured. O(zones of the sensor), below 1 us.
    /// Throws std::bad_alloc.
    [[nodiscard]] ConfirmedRanges::Answer take(const Beam& beam) { return confirmed_.take(beam, histories_); }
    /// What the beams up to this one say together, after it was counted: what the sensor sees through is
    /// cleared, what is confirmed no longer withdrawn, what is confirmed occupied. Throws std::bad_alloc.
    void conclude(const Beam& beam, const ConfirmedRanges::Answer& answer, EvidenceSink& sink);
    /// Takes a ray's beam that went into the map: what it ends on is not to be cleared.
    void take_ray(const Beam& beam) { (void)seen_.take(beam, cones_.length_m(beam), histories_); }

    /// As if there had been no beam.
    void forget() noexcept { histories_.clear(); }

    /// A copy of what was read. Throws std::bad_alloc.
    [[nodiscard]] SensorHistories histories() const { return histories_; }
    /// Goes on as if these had been read.
    void go_on_with(SensorHistories histories) noexcept { histories_ = std::move(histories); }

  private:
    void clear_seen_through(const Beam& beam, EvidenceSink& sink);
    void confirm(const Beam& confirmed, CapWidth width, EvidenceSink& sink);

    SensorHistories histories_;
    ConfirmedRanges confirmed_;
    SeenThrough seen_;
    ConeFinder cones_;
    Evidence evidence_;
};

/// How far off its axis a range marks: a sensor that does not move marks only where it would free space, too.
[[nodiscard]] inline CapWidth width_of(const ConfirmedRanges::Answer& answer) noexcept {
    return answer.is_stationary ? CapWidth::core : CapWidth::whole;
}

}  // namespace octoskin
