// The three checksums of the wire and of the configuration block. Each processes 4 bits at a time with a
// 16-entry table: 112 bytes of flash in all, and four times the speed of a bitwise loop.
//
// Each function continues from the CRC of the preceding bytes, so a checksum over separate parts needs no
// copy: crc16(b, crc16(a)) == crc16(a followed by b). The default is the CRC of no bytes.
#pragma once

#include <cstdint>
#include <span>

namespace octoskin {

/// CRC-8/AUTOSAR: polynomial 0x2F, initial 0xFF, final XOR 0xFF. Detects every 1-3 bit error up to 14 bytes
/// (checked exhaustively in tests/unit/common), every burst up to 8 bits, and all but 2^-8 of random errors.
[[nodiscard]] std::uint8_t crc8(std::span<const std::uint8_t> bytes, std::uint8_t before = 0x00) noexcept;

/// CRC-16/IBM-3740 ("CCITT-FALSE"): polynomial 0x1021, initial 0xFFFF. Detects every 1-3 bit error up to 69
/// bytes, every burst up to 16 bits, and all but 2^-16 of random errors.
[[nodiscard]] std::uint16_t crc16(std::span<const std::uint8_t> bytes,
                                  std::uint16_t before = 0xFFFF) noexcept;

/// CRC-32/ISO-HDLC: the one of IEEE 802.3 and zlib.
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) noexcept;

}  // namespace octoskin
