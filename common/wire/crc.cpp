#include "common/wire/crc.hpp"

#include <array>
#include <climits>

namespace octoskin {
namespace {

constexpr std::uint8_t kPolynomial8 = 0x2F;
constexpr std::uint16_t kPolynomial16 = 0x1021;
constexpr std::uint32_t kPolynomial32Reflected = 0xEDB88320;

/// The effect of four zero bits on a register whose top four bits are the index.
template <class Register>
constexpr std::array<Register, 16> nibble_table(Register polynomial) {
    constexpr unsigned kWidth = sizeof(Register) * CHAR_BIT;
    std::array<Register, 16> table{};
    for (unsigned nibble = 0; nibble < 16; ++nibble) {
        auto state = static_cast<Register>(nibble << (kWidth - 4));
        for (int bit = 0; bit < 4; ++bit) {
            const bool carries = (state >> (kWidth - 1)) != 0;
            state = static_cast<Register>((unsigned{state} << 1U) ^ (carries ? polynomial : 0U));
        }
        table[nibble] = state;
    }
    return table;
}

/// The mirrored table: least significant bit first, the index in the register's low four bits.
constexpr std::array<std::uint32_t, 16> reflected_nibble_table(std::uint32_t polynomial) {
    std::array<std::uint32_t, 16> table{};
    for (std::uint32_t nibble = 0; nibble < 16; ++nibble) {
        std::uint32_t state = nibble;
        for (int bit = 0; bit < 4; ++bit) {
            state = (state >> 1U) ^ ((state & 1U) != 0 ? polynomial : 0U);
        }
        table[nibble] = state;
    }
    return table;
}

constexpr auto kTable8 = nibble_table<std::uint8_t>(kPolynomial8);
constexpr auto kTable16 = nibble_table<std::uint16_t>(kPolynomial16);
constexpr auto kTable32 = reflected_nibble_table(kPolynomial32Reflected);

}  // namespace

std::uint8_t crc8(std::span<const std::uint8_t> bytes, std::uint8_t before) noexcept {
    unsigned state = before ^ 0xFFU;
    for (const std::uint8_t byte : bytes) {
        state ^= byte;
        state = ((state << 4U) & 0xFFU) ^ kTable8[state >> 4U];
        state = ((state << 4U) & 0xFFU) ^ kTable8[state >> 4U];
    }
    return static_cast<std::uint8_t>(state ^ 0xFFU);
}

std::uint16_t crc16(std::span<const std::uint8_t> bytes, std::uint16_t before) noexcept {
    unsigned state = before;
    for (const std::uint8_t byte : bytes) {
        state ^= static_cast<unsigned>(byte) << 8U;
        state = ((state << 4U) & 0xFFFFU) ^ kTable16[state >> 12U];
        state = ((state << 4U) & 0xFFFFU) ^ kTable16[state >> 12U];
    }
    return static_cast<std::uint16_t>(state);
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before) noexcept {
    std::uint32_t state = ~before;
    for (const std::uint8_t byte : bytes) {
        state ^= byte;
        state = (state >> 4U) ^ kTable32[state & 0xFU];
        state = (state >> 4U) ^ kTable32[state & 0xFU];
    }
    return ~state;
}

}  // namespace octoskin
