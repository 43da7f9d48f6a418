// How octoskin-oni-write passes a frame to the virtual camera driver, which runs in the same process below
// OpenNI2.
#pragma once

#include <cstdint>

namespace octoskin::openni2 {

/// URI of the virtual camera: this prefix, then WIDTHxHEIGHT@FPS.
inline constexpr const char* kVirtualUriPrefix = "octoskin-virtual:";

/// Stream property that makes the virtual camera produce a frame; its data is a `VirtualFrame`.
inline constexpr int kPropertyPushFrame = 0x0C70;

struct VirtualFrame {
    std::uint64_t timestamp_us = 0;
    std::int32_t index = 0;  ///< from 1
    const std::uint16_t* pixels = nullptr;
};

/// OpenNI2's depth codec is lossless only strictly below the stream's MAX_VALUE, and only if a frame has at
/// most 2^15 different depths: it numbers them and uses the sixteenth bit itself.
inline constexpr int kDepthMaxValue = 32768;

}  // namespace octoskin::openni2
