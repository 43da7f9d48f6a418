// Every field of every message lies where docs/protocol.md says, means what it says, and no bit is left over.
// The oracle is tests/support/wire/: a table of the layouts and a bit-by-bit frame builder.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

using wire::DecodeError;

/// All values up to 13 bits; above (the rest of the 16-bit ones are in tests/property), the edges, each
/// single bit, each single zero, and both chequered patterns.
std::vector<std::uint64_t> raw_values(unsigned bits) {
    const std::uint64_t most = bits == 64 ? ~0ULL : (1ULL << bits) - 1;
    std::vector<std::uint64_t> values;
    if (bits <= 13) {
        for (std::uint64_t raw = 0; raw <= most; ++raw) {
            values.push_back(raw);
        }
        return values;
    }
    values = {0, 1, most - 1, most, 0x5555555555555555ULL & most, 0xAAAAAAAAAAAAAAAAULL & most};
    for (unsigned bit = 0; bit < bits; ++bit) {
        values.push_back(1ULL << bit);
        values.push_back(most ^ (1ULL << bit));
    }
    return values;
}

wire::CanFrame with_field(const MessageCase& layout, const FieldCase& field, std::uint64_t raw) {
    Payload payload = payload_of(encode(layout.message, layout.node_id));
    set_bits(payload, field.start, field.bits, raw);
    sign(layout.can_id, payload, layout.checksum_len);
    return frame_of(layout.can_id, layout.is_fd, payload);
}

TEST(CodecLayout, every_value_of_every_field_is_coded_and_decoded_where_the_protocol_says) {
    for (const MessageCase& layout : all_message_cases()) {
        for (const FieldCase& field : layout.fields) {
            for (const std::uint64_t raw : raw_values(field.bits)) {
                const wire::CanFrame expected = with_field(layout, field, raw);
                const auto decoded = decode(expected);
                if (!field.is_valid(raw)) {
                    ASSERT_FALSE(decoded) << layout.name << " " << field.name << " " << raw;
                    ASSERT_EQ(decoded.error(), DecodeError::invalid_field)
                        << layout.name << " " << field.name;
                    continue;
                }
                wire::Message message = layout.message;
                field.set(message, raw);
                ASSERT_EQ(encode(message, layout.node_id), expected)
                    << layout.name << " " << field.name << " " << raw;
                ASSERT_TRUE(decoded) << layout.name << " " << field.name << " " << raw
                                     << name(decoded.error());
                ASSERT_EQ(decoded->message, message) << layout.name << " " << field.name << " " << raw;
                ASSERT_EQ(decoded->node_id, layout.node_id) << layout.name;
            }
        }
    }
}

TEST(CodecLayout, messages_that_differ_in_one_field_are_not_equal) {
    for (const MessageCase& layout : all_message_cases()) {
        for (const FieldCase& field : layout.fields) {
            wire::Message zero = layout.message;
            wire::Message one = layout.message;
            field.set(zero, 0);
            field.set(one, 1);
            EXPECT_NE(zero, one) << layout.name << " " << field.name;
        }
    }
    EXPECT_NE(wire::Message(wire::JointState(wire::JointPair{.index = 0})),
              wire::Message(wire::JointState(wire::JointPair{.index = 1})));
    EXPECT_NE((wire::TimeResidue{0, 1U << 18U}), (wire::TimeResidue{0, 1U << 24U}));
    EXPECT_NE(wire::Message(wire::RangeFd{.count = 1}), wire::Message(wire::RangeFd{.count = 2}));
}

TEST(CodecLayout, frames_have_the_identifier_length_and_format_of_the_protocol) {
    for (const MessageCase& layout : all_message_cases()) {
        const wire::CanFrame frame = encode(layout.message, layout.node_id);
        EXPECT_EQ(frame.can_id, layout.can_id) << layout.name;
        EXPECT_EQ(frame.payload_len, layout.payload_len) << layout.name;
        EXPECT_EQ(frame.is_fd, layout.is_fd) << layout.name;
        EXPECT_EQ(frame.has_bit_rate_switch, layout.is_fd) << layout.name;
        EXPECT_FALSE(frame.is_extended || frame.is_remote || frame.is_error) << layout.name;
        EXPECT_EQ(frame.data[0] & 7, 1) << layout.name << ": version";
    }
}

TEST(CodecLayout, every_bit_belongs_to_exactly_one_field) {
    for (const MessageCase& layout : all_message_cases()) {
        std::vector<int> owners(8 * layout.payload_len);
        const auto claim = [&owners](unsigned start, unsigned bits) {
            for (unsigned bit = start; bit < start + bits; ++bit) {
                ++owners.at(bit);
            }
        };
        claim(0, 3);
        claim(8 * (layout.payload_len - layout.checksum_len), 8 * layout.checksum_len);
        for (const FieldCase& field : layout.fields) {
            claim(field.start, field.bits);
        }
        for (const Bits& bits : layout.fixed) {
            claim(bits.start, bits.bits);
        }
        for (const Bits& bits : layout.padding) {
            claim(bits.start, bits.bits);
        }
        EXPECT_EQ(std::ranges::count(owners, 1), std::ssize(owners)) << layout.name;
    }
}

TEST(CodecLayout, refuses_each_padding_bit_that_is_set) {
    for (const MessageCase& layout : all_message_cases()) {
        for (const Bits& padding : layout.padding) {
            for (unsigned bit = 0; bit < padding.bits; ++bit) {
                const FieldCase one_bit{.name = "", .start = padding.start + bit, .bits = 1, .set = {}};
                const auto decoded = decode(with_field(layout, one_bit, 1));
                ASSERT_FALSE(decoded) << layout.name << " bit " << one_bit.start;
                ASSERT_EQ(decoded.error(), DecodeError::nonzero_padding)
                    << layout.name << " bit " << one_bit.start;
            }
        }
    }
}

TEST(CodecLayout, refuses_every_other_version_without_a_look_at_the_fields) {
    const FieldCase version{.name = "", .start = 0, .bits = 3, .set = {}};
    for (const MessageCase& layout : all_message_cases()) {
        for (const std::uint64_t other : {0U, 2U, 3U, 4U, 5U, 6U, 7U}) {
            const auto decoded = decode(with_field(layout, version, other));
            ASSERT_FALSE(decoded) << layout.name << " " << other;
            EXPECT_EQ(decoded.error(), DecodeError::wrong_version) << layout.name << " " << other;
        }
    }
}

/// The case's frame with a field's bits replaced, checksum right.
DecodeError error_with(const MessageCase& layout, unsigned start, unsigned bits, std::uint64_t raw) {
    const auto decoded =
        decode(with_field(layout, {.name = "", .start = start, .bits = bits, .set = {}}, raw));
    EXPECT_FALSE(decoded) << layout.name << " " << raw;
    return decoded.error();
}

TEST(CodecLayout, refuses_a_count_of_readings_that_is_not_the_frame_s) {
    for (const MessageCase& layout : all_message_cases()) {
        if (!layout.is_fd) {
            continue;
        }
        const unsigned room = (layout.payload_len - 3) / 14;
        for (std::uint64_t count = room + 1; count < 8; ++count) {
            EXPECT_EQ(error_with(layout, 3, 3, count), DecodeError::invalid_field)
                << layout.name << " " << count;
        }
        // With fewer, the readings left over are what is wrong.
        for (std::uint64_t count = 0; count < room; ++count) {
            EXPECT_EQ(error_with(layout, 3, 3, count), DecodeError::nonzero_padding)
                << layout.name << " " << count;
        }
    }
}

TEST(CodecLayout, refuses_fewer_readings_than_the_length_has_room_for_even_if_the_rest_is_zero) {
    for (const std::size_t length : {32U, 48U, 64U}) {
        Payload payload(length);
        payload[0] = 1 | (1 << 3);  // version 1, one reading
        sign(0x241, payload, 2);
        const auto decoded = decode(frame_of(0x241, true, payload));
        ASSERT_FALSE(decoded);
        EXPECT_EQ(decoded.error(), DecodeError::invalid_field) << length;
    }
}

TEST(CodecLayout, refuses_a_page_of_node_info_that_does_not_exist) {
    Payload payload = {1 | (7 << 3), 0, 0, 0, 0, 0, 0, 0};
    sign(0x2C7, payload, 1);
    const auto decoded = decode(frame_of(0x2C7, false, payload));
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error(), DecodeError::invalid_field);
}

TEST(CodecLayout, tells_the_four_frames_of_a_joint_sample_apart_by_their_index) {
    for (std::uint8_t index = 0; index < 4; ++index) {
        Payload payload = {
            static_cast<std::uint8_t>(1 | (index << 3) | (6 << 5)), 1, 0, 0, 0xFF, 0xFF, 0xFF, 0};
        sign(0x183, payload, 1);
        const auto decoded = decode(frame_of(0x183, false, payload));
        ASSERT_TRUE(decoded) << int{index};
        const wire::JointState expected =
            index < 3 ? wire::JointState(wire::JointPair{index, 6, {1, -1}})
                      : wire::JointState(wire::JointLast{6, 1, {0xFFFFFF, 16'777'216}});
        EXPECT_EQ(decoded->message, wire::Message(expected)) << int{index};
        EXPECT_EQ(encode(expected, 3), frame_of(0x183, false, payload)) << int{index};
    }
}

TEST(CodecLayout, padding_is_judged_before_field_ranges) {
    Payload payload = {1 | (7 << 3), 0, 0, 0, 0, 0, 0};  // COMMAND, send_info
    set_bits(payload, 3, 5, 31);                         // no such command
    set_bits(payload, 14, 2, 1);                         // padding
    sign(0x0C1, payload, 2);
    const auto decoded = decode(frame_of(0x0C1, false, payload));
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error(), DecodeError::nonzero_padding);
}

}  // namespace
}  // namespace octoskin::test
