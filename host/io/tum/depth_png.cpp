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
/// Limit of the compressed pixels (chunk IDAT) from the last row to the end of the file; the last row needs
/// at most 8 KiB if it does not compress. A megabyte of them may decompress to a gigabyte, which takes 12 s.
constexpr std::size_t kPackedLastMax = 64U << 10U;
constexpr png_uint_32 kPackedPixels = 0x49'44'41'54U;  // "IDAT"

/// The state for libpng, which reports errors by a long jump. Nothing with a destructor may be created
/// between setjmp() and the calls, so all such objects are members here.
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
        std::numeric_limits<std::size_t>::max();  ///< compressed pixels that may still be read
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
            png_error(png, "the last row and the data after it have over 64 KiB");
        decoding.packed_left -= count;
    }
    if (std::fread(bytes, 1, count, decoding.file.get()) != count) png_error(png, "the file ends early");
}

bool read_header(Decoding& decoding) {
    if (setjmp(png_jmpbuf(decoding.png)) != 0) return false;
    png_set_user_limits(decoding.png, kSideMax, kSideMax);
    // Skips text, profiles and other data beside the pixels: decompressing a kilobyte of them can take 60 ms.
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
            // With the last row libpng decompresses everything after it.
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
            return unexpected(std::string("is a pipe or a device, not a regular file"));
        const bool is_elsewhere = error.fault == FolderFault::link || error.fault == FolderFault::outside;
        return unexpected(is_elsewhere ? error.reason() : std::string("cannot be opened"));
    }
    Decoding decoding;
    decoding.file.reset(std::fopen(opened->path_for_libraries().c_str(), "rb"));
    if (!decoding.file) return unexpected(std::string("cannot be opened"));
    decoding.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoding, keep_error, ignore_warning);
    if (decoding.png != nullptr) decoding.info = png_create_info_struct(decoding.png);
    if (decoding.info == nullptr) return unexpected(std::string("not enough memory to read it"));
    if (!read_header(decoding)) return unexpected("cannot be read as PNG: " + decoding.complaint);
    const int bits = png_get_bit_depth(decoding.png, decoding.info);
    if (bits != 16 || png_get_color_type(decoding.png, decoding.info) != PNG_COLOR_TYPE_GRAY)
        return unexpected(std::string("expected one grey channel of 16 bits, as depth images have"));
    make_room(decoding);
    if (!read_pixels(decoding)) return unexpected("cannot be read completely: " + decoding.complaint);
    return std::move(decoding.image);
}

}  // namespace octoskin::tum
