// Sees the measurements that go into the maps, without their voxels.
#pragma once

#include "host/core/beams/beam.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/can_intake.hpp"

namespace octoskin {

/// Called after each measurement was applied. References are valid during the call only.
class MeasurementObserver {
  public:
    virtual ~MeasurementObserver() = default;
    virtual void on_sample(const JointMeasurement& joints) noexcept = 0;
    virtual void on_beam(const Beam& beam) noexcept = 0;
    virtual void on_image(const DepthFrame& frame) noexcept = 0;
};

}  // namespace octoskin
