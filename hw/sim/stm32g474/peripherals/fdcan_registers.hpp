// FDCAN's registers for the parts of its model: offsets, bits and constants. RM0440 44.
#pragma once

#include <cstdint>

namespace octoskin::sim::stm32::fdcan {

inline constexpr std::uint32_t kDbtp = 0x0C;
inline constexpr std::uint32_t kTest = 0x10;
inline constexpr std::uint32_t kCccr = 0x18;
inline constexpr std::uint32_t kNbtp = 0x1C;
inline constexpr std::uint32_t kTscc = 0x20;
inline constexpr std::uint32_t kTscv = 0x24;
inline constexpr std::uint32_t kEcr = 0x40;
inline constexpr std::uint32_t kPsr = 0x44;
inline constexpr std::uint32_t kTdcr = 0x48;
inline constexpr std::uint32_t kIr = 0x50;
inline constexpr std::uint32_t kIe = 0x54;
inline constexpr std::uint32_t kIls = 0x58;
inline constexpr std::uint32_t kIle = 0x5C;
inline constexpr std::uint32_t kRxgfc = 0x80;
inline constexpr std::uint32_t kXidam = 0x84;
inline constexpr std::uint32_t kRxf0s = 0x90;
inline constexpr std::uint32_t kRxf0a = 0x94;
inline constexpr std::uint32_t kRxf1s = 0x98;
inline constexpr std::uint32_t kRxf1a = 0x9C;
inline constexpr std::uint32_t kTxbc = 0xC0;
inline constexpr std::uint32_t kTxfqs = 0xC4;
inline constexpr std::uint32_t kTxbrp = 0xC8;
inline constexpr std::uint32_t kTxbar = 0xCC;
inline constexpr std::uint32_t kTxbcr = 0xD0;
inline constexpr std::uint32_t kTxbto = 0xD4;
inline constexpr std::uint32_t kTxbcf = 0xD8;
inline constexpr std::uint32_t kTxbtie = 0xDC;
inline constexpr std::uint32_t kTxbcie = 0xE0;
inline constexpr std::uint32_t kTxefs = 0xE4;
inline constexpr std::uint32_t kTxefa = 0xE8;
inline constexpr std::uint32_t kCkdiv = 0x100;

// CCCR
inline constexpr std::uint32_t kInit = 1U << 0;
inline constexpr std::uint32_t kCce = 1U << 1;
inline constexpr std::uint32_t kClockStopAcknowledge = 1U << 3;
inline constexpr std::uint32_t kClockStopRequest = 1U << 4;
inline constexpr std::uint32_t kFdEnable = 8;
inline constexpr std::uint32_t kRateSwitchEnable = 9;
inline constexpr std::uint32_t kFree = kInit | kCce | kClockStopRequest;  // the others need CCE
inline constexpr std::uint32_t kRestricted = 2;
inline constexpr std::uint32_t kMonitoring = 5;
inline constexpr std::uint32_t kNotModelled = 1U << 2 | 1U << 6 | 1U << 7;  // ASM, DAR, TEST

// IR
inline constexpr std::uint32_t kNewInFifo0 = 1U << 0;
inline constexpr std::uint32_t kTransmitted = 1U << 7;
inline constexpr std::uint32_t kCancelled = 1U << 8;
inline constexpr std::uint32_t kTxFifoEmpty = 1U << 9;
inline constexpr std::uint32_t kNewEvent = 1U << 10;
inline constexpr std::uint32_t kEventLost = 1U << 12;
inline constexpr std::uint32_t kRamFailed = 1U << 14;
inline constexpr std::uint32_t kErrorPassive = 1U << 17;
inline constexpr std::uint32_t kErrorInArbitration = 1U << 21;
inline constexpr std::uint32_t kErrorInData = 1U << 22;
inline constexpr std::uint32_t kErrorWarning = 1U << 18;
inline constexpr std::uint32_t kBusOff = 1U << 19;
inline constexpr std::uint32_t kArbitrationPhaseError = 1U << 21;
// Interrupts of each group of ILS (RM0440 44.4.16).
inline constexpr std::uint32_t kGroups[] = {0x7, 0x38, 0x1C0, 0x1E00, 0xE000, 0x3'0000, 0xFC'0000};

inline constexpr std::uint32_t kIrq0 = 21;
inline constexpr std::uint32_t kLastErrorAcknowledge = 3;
inline constexpr std::uint32_t kLastErrorBit0 = 5;
inline constexpr int kWarningLimit = 96;
inline constexpr int kPassiveLimit = 128;
inline constexpr int kBusOffLimit = 256;
inline constexpr std::uint32_t kJoinBits = 11;
inline constexpr std::uint32_t kRecoverBits = 129 * 11;
inline constexpr std::int64_t kInitDelay = 100'000;  // some clocks of the other domain
inline constexpr std::uint32_t kErrorFrameBits = 20;
inline constexpr std::uint32_t kBrokenAttemptBits = 30;

}  // namespace octoskin::sim::stm32::fdcan
