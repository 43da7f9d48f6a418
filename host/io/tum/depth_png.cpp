#include "host/io/tum/depth_png.hpp"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <memory>

namespace octoskin::tum {
namespace {

constexpr png_uint_32 kSideMax = 4096;
/// Bytes of packed pixels (chunk IDAT) for the last row, at most 8 KiB if they do not shrink, and behind it.
/// A megabyte of them may unpack to a gigabyte, which takes 12 s.
constexpr std::size_t kPackedLastMax = 64U << 10U;
constexpr png_uint_32 kPackedPixels = 0x49'44'41'54U;  // "IDAT"

/// What libpng works on. It reports errors by a jump out of itself, so nothing with a destructor may stand
/// between setjmp() and its calls: all that has one lives here.
struct Decoding {
    Decoding() = default;
    Decoding(const Decoding&) = delete;
    Decoding& operator=(const Decoding&) = delete;
    ~Decoding() { png_destroy_read_struct(&png, &info, nullptr); }

    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file{nullptr, &std::fclose};
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string complaint;
    DepthPng image;
    std::vector<png_bytep> rows;
    std::size_t packed_left =
        std::numeric_limits<std::size_t>::max();  ///< packed pixels that may be read yet
};

[[noreturn]] void keep_error(png_structp png, png_const_charp message) {
    static_cast<Decoding*>(png_get_error_ptr(png))->complaint = message;
    png_longjmp(png, 1);
}

void ignore_warning(png_structp /*png*/, png_const_charp /*message*/) {}

void read_bytes(png_structp png, png_bytep bytes, std::size_t count) {
    Decoding& decoding = *static_cast<Decoding*>(png_get_io_ptr(png));
    if (png_get_io_chunk_type(png) == kPackedPixels) {
        if (count > decoding.packed_left)
            png_error(png, "over 64 KiB of pixels lie in and behind its last row");
        decoding.packed_left -= count;
    }
    if (std::fread(bytes, 1, count, decoding.file.get()) != count) png_error(png, "the file ends early");
}

bool read_header(Decoding& decoding) {
    if (setjmp(png_jmpbuf(decoding.png)) != 0) return false;
    png_set_user_limits(decoding.png, kSideMax, kSideMax);
    // Text, profiles and what else may stand beside the pixels: a kilobyte of it can take 60 ms to unpack.
    png_set_keep_unknown_chunks(decoding.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_read_fn(decoding.png, &decoding, read_bytes);
    png_read_info(decoding.png, decoding.info);
    return true;
}

bool read_pixels(Decoding& decoding) {
    if (setjmp(png_jmpbuf(decoding.png)) != 0) return false;
    if constexpr (std::endian::native == std::endian::little) png_set_swap(decoding.png);
    const int passes = png_set_interlace_handling(decoding.png);
    for (int pass = 0; pass < passes; ++pass) {
        for (png_bytep row : decoding.rows) {
            // With the last row libpng unpacks all that is behind it.
            if (pass == passes - 1 && row == decoding.rows.back()) decoding.packed_left = kPackedLastMax;
            png_read_row(decoding.png, row, nullptr);
        }
    }
    png_read_end(decoding.png, nullptr);
    return true;
}

void make_room(Decoding& decoding) {
    DepthPng& image = decoding.image;
    image.width = png_get_image_width(decoding.png, decoding.info);
    image.height = png_get_image_height(decoding.png, decoding.info);
    image.values.resize(std::size_t{image.width} * image.height);
    for (std::size_t row = 0; row < image.height; ++row)
        decoding.rows.push_back(reinterpret_cast<png_bytep>(image.values.data() + row * image.width));
}

}  // namespace

Result<DepthPng, std::string> read_depth_png(const FilePlace& file) {
    const auto opened = file.open();
    if (!opened) {
        const FolderError& error = opened.error();
        if (error.fault == FolderFault::not_a_file)
            return unexpected(std::string("is a pipe or a device, not an ordinary file"));
        const bool is_elsewhere = error.fault == FolderFault::link || error.fault == FolderFault::outside;
        return unexpected(is_elsewhere ? error.reason() : std::string("cannot be opened"));
    }
    Decoding decoding;
    decoding.file.reset(std::fopen(opened->path_for_libraries().c_str(), "rb"));
    if (!decoding.file) return unexpected(std::string("cannot be opened"));
    decoding.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoding, keep_error, ignore_warning);
    if (decoding.png != nullptr) decoding.info = png_create_info_struct(decoding.png);
    if (decoding.info == nullptr) return unexpected(std::string("no memory to read it"));
    if (!read_header(decoding)) return unexpected("cannot be read as PNG: " + decoding.complaint);
    const int bits = png_get_bit_depth(decoding.png, decoding.info);
    if (bits != 16 || png_get_color_type(decoding.png, decoding.info) != PNG_COLOR_TYPE_GRAY)
        return unexpected(std::string("expected one grey channel of 16 bits, as depth images have"));
    make_room(decoding);
    if (!read_pixels(decoding)) return unexpected("cannot be read whole: " + decoding.complaint);
    return std::move(decoding.image);
}

}  // namespace octoskin::tum
