#include "host/io/openni2/helpers/frame_pixels.hpp"

#include <cstring>

namespace octoskin::openni2 {

std::optional<FrameSize> depth_size(const openni::VideoStream& stream) {
    const openni::VideoMode mode = stream.getVideoMode();
    const FrameSize size{static_cast<std::uint32_t>(mode.getResolutionX()),
                         static_cast<std::uint32_t>(mode.getResolutionY())};
    const bool is_depth_mm = mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM;
    if (!is_depth_mm || size.width == 0 || size.height == 0 || size.width > kSideMax ||
        size.height > kSideMax || size.pixels() > kPixelsMax) {
        return std::nullopt;
    }
    return size;
}

std::vector<std::uint16_t> pixels_of(const openni::VideoFrameRef& frame, FrameSize size) {
    const auto row_bytes = size.width * sizeof(std::uint16_t);
    const auto stride = static_cast<std::size_t>(frame.getStrideInBytes());
    const bool is_whole =
        frame.getWidth() == static_cast<int>(size.width) &&
        frame.getHeight() == static_cast<int>(size.height) && stride >= row_bytes &&
        static_cast<std::size_t>(frame.getDataSize()) >= stride * (size.height - 1) + row_bytes;
    if (!is_whole) return {};
    std::vector<std::uint16_t> pixels(size.pixels());
    const auto* source = static_cast<const std::byte*>(frame.getData());
    for (std::uint32_t row = 0; row < size.height; ++row) {
        std::memcpy(pixels.data() + static_cast<std::size_t>(row) * size.width, source + row * stride,
                    row_bytes);
    }
    return pixels;
}

}  // namespace octoskin::openni2
