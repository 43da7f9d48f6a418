// A picture in memory, and as PNG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octoskin::report {

/// 8-bit sRGB and opacity, row-major, 4 bytes a pixel. Transparent where nothing is drawn: the page's
/// background, light or dark, is visible there.
struct Image {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgba;
};

/// The bytes of a PNG file. Equal images give equal bytes. An empty image is a programmer's mistake
/// (asserted).
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

/// RFC 4648 base 64 with padding.
[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace octoskin::report
