// What a number in a depth image of a data set means: a rig file says it, the reader of the images needs it.
#pragma once

#include <cstdint>

namespace octoskin::rig {

/// By default as in the TUM RGB-D benchmark: a pixel of 5000 is 1 m, 0 no value. A camera that is plugged in
/// says it itself. https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
struct DataSetDepth {
    double units_per_m = 5000.0;  ///< positive
    std::uint16_t no_value = 0;
    friend bool operator==(const DataSetDepth&, const DataSetDepth&) = default;
};

}  // namespace octoskin::rig
