// Three revolutions of the experiment's arm without buses and boards, kept: what each sensor ranges with each
// image, also if its mount is turned, and what the camera predicts of it. Faults are then injected into what
// was kept, one sensor at a time, in milliseconds.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/witness/range_predictor.hpp"

namespace octoskin::testing_support {

/// A sensor by its place in the rig: node by node, 0 .. 33.
using SensorNumber = std::size_t;

struct KeptRange {
    double range_m = 0.0;
    double noise_m = 0.0;  ///< what of that is noise
};

/// One reading of one sensor.
struct KeptReading {
    Beam beam;  ///< of the sound sensor, but for the range
    RangePredictions predictions;
    std::optional<KeptRange> sound;                       ///< empty: it saw nothing, or the gate refuses it
    std::array<std::optional<KeptRange>, kTurns> turned;  ///< with its mount turned
};

struct KeptRun {
    std::vector<BeamSource> sources;               ///< by sensor number
    std::vector<std::vector<KeptReading>> images;  ///< by image, by sensor number
    double images_hz = 10.0;
    double predicted_us_max = 0.0;  ///< the longest that one sensor's predictions took
    double predicted_us_mean = 0.0;
};

struct KeptChoice {
    std::uint64_t seed = 0;
    std::uint32_t revolutions = 3;
    bool has_turned = false;  ///< whether `turned` is wanted: nine times the work
};

/// Of each rig, with the same images. `pixel_divisor` as WitnessBench has it; the image is filtered with a
/// window of 3 pixels, which are as large as the six of the true camera.
[[nodiscard]] std::vector<KeptRun> keep_runs(const std::vector<std::string>& rigs,
                                             std::uint32_t pixel_divisor, const KeptChoice& choice);

}  // namespace octoskin::testing_support
