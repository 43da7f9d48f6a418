// I2C's registers for the parts of its model: offsets and bits. RM0440 41.
#pragma once

#include <cstdint>

namespace octoskin::sim::stm32::i2c_model {

inline constexpr std::uint32_t kCr1 = 0x00;
inline constexpr std::uint32_t kCr2 = 0x04;
inline constexpr std::uint32_t kTimingr = 0x10;
inline constexpr std::uint32_t kIsr = 0x18;
inline constexpr std::uint32_t kIcr = 0x1C;
inline constexpr std::uint32_t kRxdr = 0x24;
inline constexpr std::uint32_t kTxdr = 0x28;

// CR1
inline constexpr std::uint32_t kModelledControl = 0x0000'1FFF;  // enable, interrupts, filters
// CR2
inline constexpr std::uint32_t kReadBit = 10;
inline constexpr std::uint32_t kStart = 1U << 13;
inline constexpr std::uint32_t kStop = 1U << 14;
inline constexpr std::uint32_t kReload = 24;
inline constexpr std::uint32_t kAutoEnd = 25;
// ISR
inline constexpr std::uint32_t kTxe = 1U << 0;
inline constexpr std::uint32_t kTxis = 1U << 1;
inline constexpr std::uint32_t kRxne = 1U << 2;
inline constexpr std::uint32_t kNackf = 1U << 4;
inline constexpr std::uint32_t kStopf = 1U << 5;
inline constexpr std::uint32_t kTc = 1U << 6;
inline constexpr std::uint32_t kTcr = 1U << 7;
inline constexpr std::uint32_t kArlo = 1U << 9;
inline constexpr std::uint32_t kBusy = 1U << 15;
inline constexpr std::uint32_t kErrors = 0x3F00;  // BERR ARLO OVR PECERR TIMEOUT ALERT

inline constexpr std::uint32_t kAddressBits = 10;  // START, address, acknowledge
inline constexpr std::uint32_t kByteBits = 9;

}  // namespace octoskin::sim::stm32::i2c_model
