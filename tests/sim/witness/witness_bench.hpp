// The experiment's arm, sensors, camera and world without buses and boards: what the witness is told of a
// revolution, in milliseconds.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/core/witness/sensor_witness.hpp"

namespace octoskin::testing_support {

/// A sensor by its place in the rig: node by node, 0 .. 33.
using SensorNumber = std::size_t;

/// What is wrong with the rig that is simulated; empty functions: nothing.
struct RigFault {
    /// Which sensor's optics a sensor number reports.
    std::function<SensorNumber(SensorNumber)> wired_to;
    /// What it makes of a range.
    std::function<double(SensorNumber, double range_m)> altered;
};

struct WitnessOutcome {
    std::vector<SensorEvidence> evidence;          ///< by sensor number
    std::vector<std::optional<double>> flagged_s;  ///< of the revolution, when each was first flagged
    double compared_us_max = 0.0;                  ///< the longest that one image took the witness

    [[nodiscard]] std::size_t flagged() const;
    /// Of those flagged, how long it took half of them; 0 if there is none.
    [[nodiscard]] double flagged_s_median() const;
};

class WitnessBench {
  public:
    /// `pixel_divisor`: 1 is the rig's camera, 512 x 424; 4 one of a quarter as many pixels a side.
    explicit WitnessBench(std::uint32_t pixel_divisor);
    ~WitnessBench();

    [[nodiscard]] std::size_t sensors() const;
    /// One revolution in 10 s, the camera at `frames_hz`, a reading of every sensor with each frame.
    [[nodiscard]] WitnessOutcome run(std::uint64_t seed, const RigFault& fault, double frames_hz) const;

  private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

}  // namespace octoskin::testing_support
