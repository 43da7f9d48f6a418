// The frames of a device to the program that asked for them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/result.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"

namespace octoskin::openni2 {

/// When the newest frame was captured, of one that arrived at `arrived_us`; both on the host's monotonic
/// clock, microseconds. The error: why no more frames are worth having; empty: this one's time is not known.
using CaptureTime = std::function<Result<std::int64_t, std::string>(std::int64_t arrived_us)>;

/// Writes frames of `depth`, which has started, to `descriptor` (frame_pipe.hpp) until there are no more, or
/// the reader is gone or takes none for 5 s. The exit code, which is never 0.
[[nodiscard]] int stream_frames(DepthStream& depth, int descriptor, const CaptureTime& capture_time);

}  // namespace octoskin::openni2
