// The meaning of a data set's depth images and poses, as the rig file defines it for the reader of the data
// set.
#pragma once

#include <cstdint>
#include <optional>

namespace octoskin::rig {

/// The scale of a depth image. Default as in the TUM RGB-D benchmark: 5000 is 1 m, 0 is no value. A connected
/// camera reports its own scale. https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
struct DataSetDepth {
    double units_per_m = 5000.0;  ///< positive
    std::uint16_t no_value = 0;
    friend bool operator==(const DataSetDepth&, const DataSetDepth&) = default;
};

/// The rig's keys for a data set. A missing key has the default of the data set's layout.
struct DataSetKeys {
    std::optional<double> units_per_m = {};
    std::optional<std::uint16_t> no_value = {};
    /// No pose is interpolated between poses farther apart than this. Default: five periods of the
    /// benchmark's motion capture at 100 Hz: a camera that accelerates at 5 m/s^2 deviates from a straight
    /// line by 1.6 mm in that time.
    double pose_gap_max_ms = 50.0;

    [[nodiscard]] DataSetDepth depth(const DataSetDepth& layout = {}) const noexcept {
        return {.units_per_m = units_per_m.value_or(layout.units_per_m),
                .no_value = no_value.value_or(layout.no_value)};
    }
    friend bool operator==(const DataSetKeys&, const DataSetKeys&) = default;
};

}  // namespace octoskin::rig
