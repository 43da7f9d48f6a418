// Converts one placed range to evidence for the maps, for every kind of sensor.
#pragma once

#include <utility>

#include "common/result.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/mapping/beam_rejection.hpp"
#include "host/core/mapping/cone_finder.hpp"
#include "host/core/mapping/evidence_sink.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/ray_model.hpp"
#include "host/core/mapping/stationary_sensors.hpp"

namespace octoskin {

/// Takes ranges in the order of measurement. Reuses its memory; not for concurrent use by two threads.
class RangeModel {
  public:
    /// `sees_any_cone`: true if any zone of the rig sees a cone. If all are rays, no stationary sensor
    /// clears.
    RangeModel(const MappingConfig& config, bool sees_any_cone)
        : ray_(config), cone_(config), stationary_(config), sees_any_cone_(sees_any_cone) {}

    /// Gives the beam's evidence to `sink`. Refuses the beam, and gives nothing, if it is not valid or leaves
    /// the octree. About 0.5 us a ray, 14 us a cone of 1 m at 0.04 m. Throws std::bad_alloc.
    [[nodiscard]] Status<BeamRejection> integrate(const Beam& beam, EvidenceSink& sink) {
        return beam.optics.is_cone() ? integrate_cone(beam, sink) : integrate_ray(beam, sink);
    }

    /// Clears the state, as if there had been no beam.
    void forget() noexcept { stationary_.forget(); }

    /// See StationarySensors.
    [[nodiscard]] SensorHistories histories() const { return stationary_.histories(); }
    void resume_with(SensorHistories histories) noexcept { stationary_.resume_with(std::move(histories)); }

  private:
    [[nodiscard]] Status<BeamRejection> integrate_ray(const Beam& beam, EvidenceSink& sink);
    [[nodiscard]] Status<BeamRejection> integrate_cone(const Beam& beam, EvidenceSink& sink);

    RayModel ray_;
    ConeFinder cone_;
    StationarySensors stationary_;
    bool sees_any_cone_;
    Evidence counts_;
};

}  // namespace octoskin
