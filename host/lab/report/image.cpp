#include "host/lab/report/image.hpp"

#include <png.h>

#include <cassert>

namespace octoskin::report {

std::vector<std::uint8_t> encode_png(const Image& image) {
    assert(image.width > 0 && image.height > 0);
    assert(image.rgba.size() == std::size_t{4} * image.width * image.height);
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = image.width;
    header.height = image.height;
    header.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = 0;
    const void* const pixels = image.rgba.data();
    const bool is_sized = png_image_write_get_memory_size(header, size, 0, pixels, 0, nullptr) != 0;
    assert(is_sized);
    std::vector<std::uint8_t> bytes(size);
    const bool is_written =
        png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels, 0, nullptr) != 0;
    assert(is_written);
    bytes.resize(size);
    return bytes;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t taken = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            group = group << 8U | (j < taken ? bytes[i + j] : 0U);
        }
        for (std::size_t j = 0; j < 4; ++j) {
            text += j <= taken ? kDigits[group >> (18U - 6U * j) & 0x3FU] : '=';
        }
    }
    return text;
}

}  // namespace octoskin::report
