#include "firmware/port/stm32g4/can_message_ram.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/wire/frame_type.hpp"

namespace octoskin::stm32g4 {
namespace {

using wire::CanFrame;
using wire::FrameType;

constexpr std::array<std::uint8_t, 16> kLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

TEST(CanMessageRam, has_the_layout_of_the_manual) {
    EXPECT_EQ(kStandardFilters, 0x4000'A400U);
    EXPECT_EQ(element_address(kReceiveFifo, 0), 0x4000'A4B0U);
    EXPECT_EQ(element_address(kReceiveFifo, 2), 0x4000'A540U);
    EXPECT_EQ(element_address(kTransmitFifo, 0), 0x4000'A678U);
    EXPECT_EQ(element_address(kTransmitFifo, 2) + 72, 0x4000'A400U + kMessageRamBytes);
}

TEST(CanMessageRam, writes_a_classical_frame) {
    CanFrame frame{.can_id = 0x145, .payload_len = 5};
    for (std::uint8_t i = 0; i < 5; ++i) frame.data[i] = static_cast<std::uint8_t>(0x11 * (i + 1));
    const CanElement element = encode_element(frame);
    EXPECT_EQ(element[0], 0x145U << 18U);
    EXPECT_EQ(element[1], 5U << 16U);
    EXPECT_EQ(element[2], 0x4433'2211U);
    EXPECT_EQ(element[3], 0x0000'0055U);
}

TEST(CanMessageRam, writes_an_fd_frame_with_rate_switch) {
    CanFrame frame{.can_id = 0x7FF, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 64};
    frame.data[63] = 0xAB;
    const CanElement element = encode_element(frame);
    EXPECT_EQ(element[0], 0x1FFC'0000U);
    EXPECT_EQ(element[1], (1U << 21U) | (1U << 20U) | (15U << 16U));
    EXPECT_EQ(element[17], 0xAB00'0000U);
}

TEST(CanMessageRam, reads_flags_and_identifiers_of_both_lengths) {
    CanElement element{};
    element[0] = (1U << 30U) | (1U << 29U) | 0x1234'567U;
    element[1] = (8U << 16U) | 0xFFFFU;  // the time stamp is none of our business
    const CanFrame frame = decode_element(element);
    EXPECT_TRUE(frame.is_extended);
    EXPECT_TRUE(frame.is_remote);
    EXPECT_EQ(frame.can_id, 0x1234'567U);
    EXPECT_EQ(frame.payload_len, 0) << "a remote frame has no data";
    EXPECT_FALSE(frame.is_fd);
}

TEST(CanMessageRam, takes_no_more_than_eight_bytes_of_a_classical_frame) {
    for (std::uint32_t code = 0; code < 16; ++code) {
        EXPECT_EQ(payload_length(code, true), kLengths[code]);
        EXPECT_EQ(payload_length(code, false), code < 8 ? code : 8);
        EXPECT_EQ(data_length_code(kLengths[code]), code);
    }
}

TEST(CanMessageRam, gives_back_what_was_put_in) {
    std::mt19937 engine(20'261'121);
    const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
    for (int i = 0; i < 20'000; ++i) {
        CanFrame frame;
        frame.is_extended = (random() & 1U) != 0;
        frame.can_id = random() & (frame.is_extended ? 0x1FFF'FFFFU : 0x7FFU);
        frame.is_fd = (random() & 1U) != 0;
        frame.has_bit_rate_switch = frame.is_fd && (random() & 1U) != 0;
        frame.payload_len = kLengths[random() % (frame.is_fd ? 16 : 9)];
        for (std::uint8_t k = 0; k < frame.payload_len; ++k)
            frame.data[k] = static_cast<std::uint8_t>(random());
        CanElement element = encode_element(frame);
        for (std::uint32_t k = words_in_use(frame.payload_len); k < element.size(); ++k) {
            ASSERT_EQ(element[k], 0U);
            element[k] = random();  // left over from the frame before
        }
        ASSERT_EQ(decode_element(element), frame);
    }
}

/// RM0440's rule for a standard filter, written anew.
bool passes(std::uint32_t filter, std::uint32_t id) {
    const std::uint32_t first = (filter >> 16U) & 0x7FFU;
    const std::uint32_t second = filter & 0x7FFU;
    const bool goes_to_fifo0 = ((filter >> 27U) & 7U) == 1;
    switch (filter >> 30U) {
        case 0:
            return goes_to_fifo0 && id >= first && id <= second;
        case 1:
            return goes_to_fifo0 && (id == first || id == second);
        case 2:
            return goes_to_fifo0 && (id & second) == (first & second);
        default:
            return false;
    }
}

TEST(CanMessageRam, lets_pass_what_a_node_listens_to_and_nothing_else) {
    for (wire::NodeId node = 1; node <= 62; ++node) {
        const auto filters = node_filters(node);
        for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
            const bool is_wanted = id == wire::can_id(FrameType::sync, wire::kHostId) ||
                                   id == wire::can_id(FrameType::command, wire::kBroadcastId) ||
                                   wire::node_of(id) == node;
            ASSERT_EQ(passes(filters[0], id) || passes(filters[1], id), is_wanted) << int{node} << " " << id;
        }
    }
}

}  // namespace
}  // namespace octoskin::stm32g4
