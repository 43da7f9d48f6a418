#include "firmware/port/stm32g4/can_message_ram.hpp"

#include <algorithm>
#include <cassert>

#include "common/wire/frame_type.hpp"

namespace octoskin::stm32g4 {

namespace {

// Header words of an element: RM0440, "FDCAN Tx buffer element" and "FDCAN Rx FIFO element".
constexpr std::uint32_t kExtended = 1U << 30U;
constexpr std::uint32_t kRemote = 1U << 29U;
constexpr std::uint32_t kStandardShift = 18;
constexpr std::uint32_t kExtendedMask = 0x1FFF'FFFF;
constexpr std::uint32_t kFdFormat = 1U << 21U;
constexpr std::uint32_t kRateSwitch = 1U << 20U;
constexpr std::uint32_t kLengthShift = 16;

// Filter elements: RM0440, "FDCAN standard message ID filter element".
constexpr std::uint32_t kEitherOfTwo = 1U << 30U;
constexpr std::uint32_t kIdAndMask = 2U << 30U;
constexpr std::uint32_t kIntoFifo0 = 1U << 27U;
constexpr std::uint32_t kFirstShift = 16;

constexpr std::array<std::uint8_t, 16> kLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

}  // namespace

std::uint32_t data_length_code(std::uint8_t payload_len) {
    const auto* found = std::find(kLengths.begin(), kLengths.end(), payload_len);
    assert(found != kLengths.end());
    return static_cast<std::uint32_t>(found - kLengths.begin());
}

std::uint8_t payload_length(std::uint32_t code, bool is_fd) {
    const std::uint8_t length = kLengths[code & 0xFU];
    return is_fd ? length : std::min(length, wire::kClassicalPayloadMax);
}

CanElement encode_element(const wire::CanFrame& frame) {
    CanElement element{};
    element[0] = frame.is_extended ? kExtended | (frame.can_id & kExtendedMask)
                                   : (frame.can_id & wire::kStandardIdMax) << kStandardShift;
    if (frame.is_remote) element[0] |= kRemote;
    element[1] = data_length_code(frame.payload_len) << kLengthShift;
    if (frame.is_fd) element[1] |= kFdFormat;
    if (frame.has_bit_rate_switch) element[1] |= kRateSwitch;
    for (std::uint32_t i = 0; i < frame.payload_len; ++i) {
        element[2 + i / 4] |= std::uint32_t{frame.data[i]} << (8 * (i % 4));
    }
    return element;
}

wire::CanFrame decode_element(const CanElement& element) {
    wire::CanFrame frame;
    frame.is_extended = (element[0] & kExtended) != 0;
    frame.is_remote = (element[0] & kRemote) != 0;
    frame.can_id = frame.is_extended ? element[0] & kExtendedMask
                                     : (element[0] >> kStandardShift) & wire::kStandardIdMax;
    frame.is_fd = (element[1] & kFdFormat) != 0;
    frame.has_bit_rate_switch = (element[1] & kRateSwitch) != 0;
    if (frame.is_remote) return frame;
    frame.payload_len = payload_length(element[1] >> kLengthShift, frame.is_fd);
    for (std::uint32_t i = 0; i < frame.payload_len; ++i) {
        frame.data[i] = static_cast<std::uint8_t>((element[2 + i / 4] >> (8 * (i % 4))) & 0xFFU);
    }
    return frame;
}

std::array<std::uint32_t, kFilterCount> node_filters(wire::NodeId node_id) {
    using wire::FrameType;
    const std::uint32_t sync = wire::can_id(FrameType::sync, wire::kHostId);
    const std::uint32_t broadcast = wire::can_id(FrameType::command, wire::kBroadcastId);
    constexpr std::uint32_t kNodeMask = 0x3F;
    return {kEitherOfTwo | kIntoFifo0 | (sync << kFirstShift) | broadcast,
            kIdAndMask | kIntoFifo0 | (std::uint32_t{node_id} << kFirstShift) | kNodeMask};
}

}  // namespace octoskin::stm32g4
