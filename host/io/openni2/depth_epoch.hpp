// The sidecar of a recording's depth.oni: OpenNI2 rebases time stamps to 0 at the first frame, so the
// absolute time of that frame is kept beside it.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::openni2 {

struct DepthEpoch {
    HostTime first_frame;      ///< whole microseconds on the host's monotonic clock
    std::uint64_t frames = 0;  ///< how many the recording must have
};

[[nodiscard]] Status<DepthSourceError> write_epoch(const FilePlace& file, const DepthEpoch& epoch);
[[nodiscard]] Result<DepthEpoch, DepthSourceError> read_epoch(const FilePlace& file);

}  // namespace octoskin::openni2
