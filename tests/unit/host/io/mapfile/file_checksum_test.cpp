#include "host/io/mapfile/file_checksum.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <random>
#include <string>

#include "common/wire/crc.hpp"

namespace octoskin {
namespace {

TEST(FileChecksum, is_the_wires_crc_32_also_piece_by_piece) {
    std::mt19937 random(3);
    for (const std::size_t size : std::initializer_list<std::size_t>{0, 1, 7, 64, 1'000, 100'000}) {
        std::string bytes(size, 0);
        for (char& byte : bytes) byte = static_cast<char>(random() & 0xFFU);
        const std::uint32_t expected =
            crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        EXPECT_EQ(file_checksum(bytes), expected) << size;
        const std::size_t cut = size / 3;
        const std::string_view all = bytes;
        EXPECT_EQ(file_checksum(all.substr(cut), file_checksum(all.substr(0, cut))), expected) << size;
    }
}

}  // namespace
}  // namespace octoskin
