// Checks OpenNI2's streams and frames.
#pragma once

#include <OpenNI.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "host/io/openni2/frame_pipe.hpp"

namespace octoskin::openni2 {

/// The size of a depth stream in millimetres; empty for any other stream, and for one that is too large.
[[nodiscard]] std::optional<FrameSize> depth_size(const openni::VideoStream& stream);

/// The frame's pixels, for any stride; empty if it does not have the stream's size.
[[nodiscard]] std::vector<std::uint16_t> pixels_of(const openni::VideoFrameRef& frame, FrameSize size);

}  // namespace octoskin::openni2
