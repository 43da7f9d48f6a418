#include "host/io/mcap/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>
#include <new>

namespace octoskin::mcap {
namespace {

/// Fast, and within a few percent of the size of higher levels for octrees and depth images.
constexpr int kZstdLevel = 3;

bool unpack_zstd(std::string_view packed, std::string& bytes) {
    const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
    return ZSTD_isError(size) == 0 && size == bytes.size();
}

/// A frame may end in several steps: its end mark comes behind the last byte of content.
bool unpack_lz4(std::string_view packed, std::string& bytes) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw std::bad_alloc();
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
        context, &LZ4F_freeDecompressionContext);
    std::size_t made = 0;
    std::size_t wanted = 1;  // bytes that the frame still needs; 0: it is over
    while (wanted != 0 && !packed.empty()) {
        std::size_t room = bytes.size() - made;
        std::size_t taken = packed.size();
        wanted = LZ4F_decompress(context, bytes.data() + made, &room, packed.data(), &taken, nullptr);
        if (LZ4F_isError(wanted) != 0 || (room == 0 && taken == 0)) return false;
        made += room;
        packed.remove_prefix(taken);
    }
    return wanted == 0 && packed.empty() && made == bytes.size();
}

}  // namespace

std::string_view name_of(Compression compression) noexcept {
    switch (compression) {
        case Compression::none:
            return "";
        case Compression::lz4:
            return "lz4";
        case Compression::zstd:
            return "zstd";
    }
    return "";
}

std::optional<Compression> compression_of(std::string_view name) noexcept {
    for (const Compression one : {Compression::none, Compression::lz4, Compression::zstd})
        if (name == name_of(one)) return one;
    return std::nullopt;
}

std::string compress_zstd(std::string_view bytes) {
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only error with a buffer of this size
    packed.resize(size);
    return packed;
}

bool decompress(Compression compression, std::string_view packed, std::size_t size, std::string& bytes) {
    if (compression == Compression::none) {
        bytes = packed;
        return packed.size() == size;
    }
    bytes.resize(size);
    return compression == Compression::zstd ? unpack_zstd(packed, bytes) : unpack_lz4(packed, bytes);
}

}  // namespace octoskin::mcap
