// Corrects the checksums of damaged snapshots, so that the checks behind the checksums are tested.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/wire/crc.hpp"
#include "host/io/snapshot/blocks.hpp"

namespace octoskin::testing_support {

/// The same bytes with a corrected number and checksum of each block, as far as the blocks' lengths are
/// valid.
[[nodiscard]] inline std::string mended(std::string_view bytes) {
    constexpr std::size_t kHead = 12;
    constexpr std::size_t kWord = 4;
    std::string text(bytes);
    const auto put = [&text](std::size_t at, std::uint32_t word) {
        for (std::size_t i = 0; i < kWord; ++i) text[at + i] = static_cast<char>(word >> (8 * i) & 0xFFU);
    };
    std::uint32_t number = 0;
    for (std::size_t at = snapshot::kMagic.size(); text.size() >= at + kHead + kWord;) {
        const std::string_view lengths = std::string_view(text).substr(at + 8);
        const std::size_t length = snapshot::ByteReader(lengths).get<std::uint32_t>();
        if (length > text.size() - at - kHead - kWord) break;
        put(at + kWord, number++);
        const auto* const first = reinterpret_cast<const std::uint8_t*>(text.data() + at);
        put(at + kHead + length, crc32({first, kHead + length}));
        at += kHead + length + kWord;
    }
    return text;
}

}  // namespace octoskin::testing_support
