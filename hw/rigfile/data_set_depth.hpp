// What a data set's images and poses mean: a rig file says it, the reader of the data set needs it.
#pragma once

#include <cstdint>
#include <optional>

namespace octoskin::rig {

/// What a number in a depth image means. By default as in the TUM RGB-D benchmark: a pixel of 5000 is 1 m, 0
/// no value. A camera that is plugged in says it itself.
/// https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
struct DataSetDepth {
    double units_per_m = 5000.0;  ///< positive
    std::uint16_t no_value = 0;
    friend bool operator==(const DataSetDepth&, const DataSetDepth&) = default;
};

/// What a rig says of a data set. What it leaves out is as the layout of the data set has it.
struct DataSetKeys {
    std::optional<double> units_per_m = {};
    std::optional<std::uint16_t> no_value = {};
    /// Between poses farther apart there is none. By default five periods of the benchmark's motion capture
    /// at 100 Hz: a camera that accelerates at 5 m/s^2 leaves the straight line by 1.6 mm meanwhile.
    double pose_gap_max_ms = 50.0;

    [[nodiscard]] DataSetDepth depth(const DataSetDepth& layout = {}) const noexcept {
        return {.units_per_m = units_per_m.value_or(layout.units_per_m),
                .no_value = no_value.value_or(layout.no_value)};
    }
    friend bool operator==(const DataSetKeys&, const DataSetKeys&) = default;
};

}  // namespace octoskin::rig
