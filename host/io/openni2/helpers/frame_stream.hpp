// Sends the frames of a device to the program that started this helper.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/result.hpp"
#include "host/io/openni2/helpers/depth_stream.hpp"

namespace octoskin::openni2 {

/// The capture time of the latest frame, which arrived at `arrived_us`; both on the host's monotonic clock,
/// microseconds. Empty: the time of this frame is unknown. Error: why further frames cannot be used.
using CaptureTime = std::function<Result<std::int64_t, std::string>(std::int64_t arrived_us)>;

/// Writes frames of `depth`, which must be started, to `descriptor` (frame_pipe.hpp), until there are no
/// more, or the reader has closed or accepts none for 5 s. Returns an exit code, which is never 0.
[[nodiscard]] int stream_frames(DepthStream& depth, int descriptor, const CaptureTime& capture_time);

}  // namespace octoskin::openni2
