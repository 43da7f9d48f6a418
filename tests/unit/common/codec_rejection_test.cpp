// What a decoder must refuse, exhausted where it can be: identifiers, formats, lengths, truncations, bit
// flips.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

using wire::CanFrame;
using wire::DecodeError;

/// The error of a decoding that must fail.
DecodeError error_of(const Result<wire::Decoded, DecodeError>& decoded) {
    EXPECT_FALSE(decoded);
    return decoded.error();
}

std::vector<CanFrame> all_frames() {
    std::vector<CanFrame> frames;
    for (const MessageCase& layout : all_message_cases()) {
        frames.push_back(encode(layout.message, layout.node_id));
    }
    return frames;
}

/// By docs/protocol.md: which node ids each of the 32 types may have, its format, and its lengths.
struct TypeRule {
    unsigned node_min = 1;
    unsigned node_max = 0;  ///< below node_min: the type does not exist
    bool is_fd = false;
    std::vector<std::size_t> lengths = {};
};
TypeRule rule_of(unsigned type) {
    switch (type) {
        case 1:
            return {0, 0, false, {3}};
        case 2:
        case 4:
            return {0, 0, false, {8}};
        case 3:
            return {1, 63, false, {7}};
        case 0:
        case 5:
        case 6:
        case 8:
        case 10:
        case 11:
        case 12:
        case 13:
        case 31:
            return {1, 62, false, {8}};
        case 7:
            return {1, 62, false, {7}};
        case 9:
            return {1, 62, true, {20, 32, 48, 64}};
        default:
            return {};
    }
}

TEST(CodecRejection, every_identifier_format_and_length_is_judged_as_the_protocol_says) {
    for (std::uint32_t can_id = 0; can_id < 2048; ++can_id) {
        const TypeRule rule = rule_of(can_id >> 6U);
        const unsigned node = can_id & 63U;
        for (const bool is_fd : {false, true}) {
            for (std::size_t length = 0; length <= 64; ++length) {
                Payload payload(length, 0);
                if (length > 0) {
                    payload[0] = 1;
                }
                sign(can_id, payload, checksum_len_of(can_id));
                const auto decoded = decode(frame_of(can_id, is_fd, payload));
                if (node < rule.node_min || node > rule.node_max) {
                    ASSERT_EQ(error_of(decoded), DecodeError::unknown_type) << can_id;
                } else if (is_fd != rule.is_fd) {
                    ASSERT_EQ(error_of(decoded), DecodeError::foreign_format) << can_id;
                } else if (std::ranges::find(rule.lengths, length) == rule.lengths.end()) {
                    ASSERT_EQ(error_of(decoded), DecodeError::wrong_length) << can_id << " length " << length;
                } else if (decoded) {
                    ASSERT_EQ(decoded->node_id, node);
                } else {
                    // All zero is no valid RANGE_FD (count) and no valid COMMAND (code); it is one of all
                    // others.
                    ASSERT_EQ(decoded.error(), DecodeError::invalid_field) << can_id;
                    ASSERT_TRUE((can_id >> 6U) == 9 || (can_id >> 6U) == 3) << can_id;
                }
            }
        }
    }
}

TEST(CodecRejection, extended_remote_and_error_frames_are_foreign_whatever_they_carry) {
    for (const CanFrame& good : all_frames()) {
        for (unsigned flags = 1; flags < 8; ++flags) {
            CanFrame frame = good;
            frame.is_extended = (flags & 1U) != 0;
            frame.is_remote = (flags & 2U) != 0;
            frame.is_error = (flags & 4U) != 0;
            EXPECT_EQ(error_of(decode(frame)), DecodeError::foreign_format) << good.can_id << " " << flags;
        }
    }
}

TEST(CodecRejection, an_identifier_beyond_11_bits_is_foreign_even_if_its_low_bits_are_ours) {
    for (CanFrame frame : all_frames()) {
        for (unsigned bit = 11; bit < 32; ++bit) {
            CanFrame other = frame;
            other.can_id |= 1U << bit;
            EXPECT_EQ(error_of(decode(other)), DecodeError::foreign_format) << frame.can_id << " " << bit;
        }
    }
}

TEST(CodecRejection, the_other_format_is_foreign) {
    for (CanFrame frame : all_frames()) {
        frame.is_fd = !frame.is_fd;
        EXPECT_EQ(error_of(decode(frame)), DecodeError::foreign_format) << frame.can_id;
    }
}

TEST(CodecRejection, the_bit_rate_switch_makes_no_difference) {
    for (CanFrame frame : all_frames()) {
        frame.has_bit_rate_switch = !frame.has_bit_rate_switch;
        EXPECT_TRUE(decode(frame)) << frame.can_id;
    }
}

TEST(CodecRejection, every_truncation_has_the_wrong_length_or_the_wrong_checksum) {
    for (const CanFrame& good : all_frames()) {
        for (std::uint8_t length = 0; length < good.payload_len; ++length) {
            CanFrame frame = good;
            frame.payload_len = length;
            // 20, 32 and 48 bytes of a longer RANGE_FD are a right length again.
            const bool is_right_length = good.is_fd && (length == 20 || length == 32 || length == 48);
            EXPECT_EQ(error_of(decode(frame)),
                      is_right_length ? DecodeError::wrong_crc : DecodeError::wrong_length)
                << good.can_id << " " << int{length};
        }
    }
}

TEST(CodecRejection, no_length_is_believed_that_no_frame_can_have) {
    for (const CanFrame& good : all_frames()) {
        for (unsigned length = 65; length < 256; ++length) {
            CanFrame frame = good;
            frame.payload_len = static_cast<std::uint8_t>(length);
            EXPECT_EQ(error_of(decode(frame)), DecodeError::wrong_length) << good.can_id << " " << length;
        }
    }
}

TEST(CodecRejection, bytes_after_the_payload_make_no_difference) {
    std::mt19937 random(3);
    for (const CanFrame& good : all_frames()) {
        const auto expected = decode(good);
        ASSERT_TRUE(expected);
        for (int trial = 0; trial < 20; ++trial) {
            CanFrame frame = good;
            std::generate(frame.data.begin() + frame.payload_len, frame.data.end(),
                          [&random] { return static_cast<std::uint8_t>(random()); });
            const auto decoded = decode(frame);
            ASSERT_TRUE(decoded) << good.can_id;
            EXPECT_EQ(decoded->message, expected->message) << good.can_id;
        }
    }
}

TEST(CodecRejection, the_checks_go_from_format_to_length_to_checksum_to_version) {
    CanFrame frame = encode(wire::Sync{5}, 0);
    frame.data[0] = 0x07;  // another version, checksum not renewed
    EXPECT_EQ(error_of(decode(frame)), DecodeError::wrong_crc);
    frame.payload_len = 4;
    EXPECT_EQ(error_of(decode(frame)), DecodeError::wrong_length);
    frame.is_fd = true;
    EXPECT_EQ(error_of(decode(frame)), DecodeError::foreign_format);
    frame.can_id = 0x041;  // SYNC from a node
    EXPECT_EQ(error_of(decode(frame)), DecodeError::unknown_type);
    frame.is_remote = true;
    EXPECT_EQ(error_of(decode(frame)), DecodeError::foreign_format);
}

TEST(CodecRejection, every_error_has_its_own_name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < wire::kDecodeErrors; ++i) {
        names.emplace_back(name(static_cast<DecodeError>(i)));
    }
    const std::vector<std::string> expected = {"foreign_format", "unknown_type",  "wrong_length",
                                               "wrong_crc",      "wrong_version", "nonzero_padding",
                                               "invalid_field"};
    EXPECT_EQ(names, expected);
    EXPECT_STREQ(name(static_cast<DecodeError>(wire::kDecodeErrors)), "?");
}

}  // namespace
}  // namespace octoskin::test
