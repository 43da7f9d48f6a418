#include "hw/sim/stm32g474/peripherals/fdcan_ram.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::sim::stm32 {
namespace {

// Word offsets (RM0440 figure 669, ST's HAL).
constexpr std::uint32_t kExtendedFilters = 0x070 / 4;
constexpr std::uint32_t kRxFifo0 = 0x0B0 / 4;
constexpr std::uint32_t kRxFifo1 = 0x188 / 4;
constexpr std::uint32_t kTxEvents = 0x260 / 4;
constexpr std::uint32_t kTxBuffers = 0x278 / 4;
constexpr std::uint32_t kElementWords = 18;

constexpr std::uint32_t kExtended = 1U << 30;
constexpr std::uint32_t kRemote = 1U << 29;
constexpr std::uint32_t kEventControl = 1U << 23;
constexpr std::uint32_t kFdFormat = 1U << 21;
constexpr std::uint32_t kRateSwitch = 1U << 20;
constexpr std::uint8_t kLengths[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

std::uint32_t id_word(const wire::CanFrame& frame) {
    const std::uint32_t id = frame.is_extended ? frame.can_id | kExtended : frame.can_id << 18U;
    return id | (frame.is_remote ? kRemote : 0);
}

std::uint32_t format_word(const wire::CanFrame& frame) {
    const auto code = static_cast<std::uint32_t>(
        std::find(std::begin(kLengths), std::end(kLengths), frame.payload_len) - std::begin(kLengths));
    return code << 16U | (frame.is_fd ? kFdFormat : 0) | (frame.has_bit_rate_switch ? kRateSwitch : 0);
}

}  // namespace

std::uint32_t FdcanRam::read(std::uint32_t offset) {
    return words_.at(offset / 4);
}

void FdcanRam::write(std::uint32_t offset, std::uint32_t value) {
    words_.at(offset / 4) = value;
}

std::uint64_t FdcanRam::extended_filter(std::uint32_t index) const {
    const std::uint32_t at = kExtendedFilters + 2 * index;
    return std::uint64_t{words_.at(at + 1)} << 32U | words_.at(at);
}

FdcanRam::TxElement FdcanRam::tx_element(std::uint32_t index) const {
    const std::uint32_t at = kTxBuffers + kElementWords * index;
    const std::uint32_t t0 = words_.at(at);
    const std::uint32_t t1 = words_.at(at + 1);
    TxElement element;
    wire::CanFrame& frame = element.frame;
    frame.is_extended = (t0 & kExtended) != 0;
    frame.is_remote = (t0 & kRemote) != 0;
    frame.can_id = frame.is_extended ? t0 & 0x1FFF'FFFFU : t0 >> 18U & 0x7FFU;
    frame.is_fd = (t1 & kFdFormat) != 0;
    frame.has_bit_rate_switch = (t1 & kRateSwitch) != 0;
    frame.payload_len = kLengths[t1 >> 16U & 0xFU];
    if (!frame.is_fd) frame.payload_len = std::min(frame.payload_len, wire::kClassicalPayloadMax);
    if (frame.is_remote) frame.payload_len = 0;
    for (std::uint32_t i = 0; i < frame.payload_len; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(words_.at(at + 2 + i / 4) >> (8 * (i % 4)));
    }
    element.marker = static_cast<std::uint8_t>(t1 >> 24U);
    element.stores_event = (t1 & kEventControl) != 0;
    return element;
}

void FdcanRam::store_rx(std::uint32_t fifo, std::uint32_t index, const wire::CanFrame& frame,
                        std::uint16_t timestamp, int filter) {
    const std::uint32_t at = (fifo == 0 ? kRxFifo0 : kRxFifo1) + kElementWords * index;
    const std::uint32_t match =
        filter < 0 ? 1U << 31 : static_cast<std::uint32_t>(filter) << 24U;  // ANMF, FIDX
    words_.at(at) = id_word(frame);
    words_.at(at + 1) = match | format_word(frame) | timestamp;
    for (std::uint32_t i = 0; i < frame.payload_len; i += 4) {
        std::uint32_t word = 0;
        for (std::uint32_t byte = 0; byte < 4 && i + byte < frame.payload_len; ++byte) {
            word |= std::uint32_t{frame.data[i + byte]} << (8 * byte);
        }
        words_.at(at + 2 + i / 4) = word;
    }
}

void FdcanRam::store_event(std::uint32_t index, const TxElement& sent, std::uint16_t timestamp) {
    const std::uint32_t at = kTxEvents + 2 * index;
    words_.at(at) = id_word(sent.frame);
    words_.at(at + 1) = std::uint32_t{sent.marker} << 24U | 1U << 22U | format_word(sent.frame) | timestamp;
}

}  // namespace octoskin::sim::stm32
