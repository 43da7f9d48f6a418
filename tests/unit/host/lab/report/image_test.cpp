#include "host/lab/report/image.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <numeric>

namespace octoskin::report {
namespace {

Image every_byte() {
    Image image{8, 8, std::vector<std::uint8_t>(256)};
    std::iota(image.rgba.begin(), image.rgba.end(), std::uint8_t{0});
    return image;
}

/// Oracle: libpng's own reader.
Image decoded(const std::vector<std::uint8_t>& bytes) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()), 0);
    header.format = PNG_FORMAT_RGBA;
    Image image{header.width, header.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(header))};
    EXPECT_NE(png_image_finish_read(&header, nullptr, image.rgba.data(), 0, nullptr), 0);
    return image;
}

std::string base64_of(std::string_view text) {
    return base64({text.begin(), text.end()});
}

TEST(EncodePng, gives_back_every_pixel_when_read) {
    const Image image = decoded(encode_png(every_byte()));
    EXPECT_EQ(image.width, 8U);
    EXPECT_EQ(image.height, 8U);
    EXPECT_EQ(image.rgba, every_byte().rgba);
}

TEST(EncodePng, gives_equal_bytes_for_equal_images) {
    EXPECT_EQ(encode_png(every_byte()), encode_png(every_byte()));
}

TEST(Base64, agrees_with_the_vectors_of_rfc_4648) {
    EXPECT_EQ(base64_of(""), "");
    EXPECT_EQ(base64_of("f"), "Zg==");
    EXPECT_EQ(base64_of("fo"), "Zm8=");
    EXPECT_EQ(base64_of("foo"), "Zm9v");
    EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
    EXPECT_EQ(base64_of("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
}

TEST(Base64, uses_all_64_digits) {
    std::vector<std::uint8_t> bytes;
    for (unsigned group = 0; group < 16; ++group) {
        const unsigned four =
            (4 * group) << 18U | (4 * group + 1) << 12U | (4 * group + 2) << 6U | (4 * group + 3);
        bytes.push_back(static_cast<std::uint8_t>(four >> 16U));
        bytes.push_back(static_cast<std::uint8_t>(four >> 8U));
        bytes.push_back(static_cast<std::uint8_t>(four));
    }
    EXPECT_EQ(base64(bytes), "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/");
}

}  // namespace
}  // namespace octoskin::report
