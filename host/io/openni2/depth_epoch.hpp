// The sidecar of a recording's depth.oni. OpenNI2 starts time stamps at 0 with the first frame, so the
// absolute time of that frame is stored in this file.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::openni2 {

struct DepthEpoch {
    HostTime first_frame;      ///< whole microseconds on the host's monotonic clock
    std::uint64_t frames = 0;  ///< number of frames that the recording must have
};

[[nodiscard]] Status<Error> write_epoch(const FilePlace& file, const DepthEpoch& epoch);
[[nodiscard]] Result<DepthEpoch, Error> read_epoch(const FilePlace& file);

}  // namespace octoskin::openni2
