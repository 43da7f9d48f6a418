#include "common/wire/crc.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <vector>

namespace octoskin {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

// Oracle: the check values of the public catalogue of parametrised CRC algorithms (reveng), for "123456789".
TEST(Crc, crc8_gives_the_catalogue_check_value_of_autosar) {
    EXPECT_EQ(crc8(bytes_of("123456789")), 0xDF);
}
TEST(Crc, crc16_gives_the_catalogue_check_value_of_ibm_3740) {
    EXPECT_EQ(crc16(bytes_of("123456789")), 0x29B1);
}
TEST(Crc, crc32_gives_the_catalogue_check_value_of_iso_hdlc) {
    EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926);
}

TEST(Crc, of_nothing_is_the_default_to_continue_from) {
    EXPECT_EQ(crc8({}), 0x00);
    EXPECT_EQ(crc16({}), 0xFFFF);
    EXPECT_EQ(crc32({}), 0U);
}

TEST(Crc, continued_over_every_split_equals_the_whole) {
    const auto all = bytes_of("123456789");
    const std::span<const std::uint8_t> whole(all);
    for (std::size_t split = 0; split <= all.size(); ++split) {
        EXPECT_EQ(crc8(whole.subspan(split), crc8(whole.first(split))), 0xDF) << split;
        EXPECT_EQ(crc16(whole.subspan(split), crc16(whole.first(split))), 0x29B1) << split;
        EXPECT_EQ(crc32(whole.subspan(split), crc32(whole.first(split))), 0xCBF43926) << split;
    }
}

// Oracle: the definition, one bit at a time, most significant first.
std::uint32_t by_long_division(std::span<const std::uint8_t> bytes, unsigned width, std::uint32_t polynomial,
                               std::uint32_t state) {
    const std::uint32_t top = 1U << (width - 1);
    const std::uint32_t mask = (top - 1) | top;
    for (const std::uint8_t byte : bytes) {
        for (int bit = 7; bit >= 0; --bit) {
            const bool carries = ((state & top) != 0) != (((byte >> bit) & 1) != 0);
            state = ((state << 1U) ^ (carries ? polynomial : 0U)) & mask;
        }
    }
    return state;
}

TEST(Crc, of_every_two_byte_string_equals_the_long_division) {
    for (unsigned pair = 0; pair < 65536; ++pair) {
        const std::array<std::uint8_t, 2> bytes = {static_cast<std::uint8_t>(pair >> 8U),
                                                   static_cast<std::uint8_t>(pair)};
        ASSERT_EQ(crc8(bytes), by_long_division(bytes, 8, 0x2F, 0xFF) ^ 0xFFU) << pair;
        ASSERT_EQ(crc16(bytes), by_long_division(bytes, 16, 0x1021, 0xFFFF)) << pair;
    }
}

}  // namespace
}  // namespace octoskin
