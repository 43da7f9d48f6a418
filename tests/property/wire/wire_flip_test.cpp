// Exhaustive checks that are too slow for the unit suite: the longest frame against all 3-bit flips and all
// bursts, and all values of all 16-bit fields.
#include <gtest/gtest.h>

#include <bit>
#include <cstddef>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

using wire::CanFrame;

CanFrame longest_frame() {
    for (const MessageCase& layout : all_message_cases()) {
        if (layout.payload_len == 64) {
            return encode(layout.message, layout.node_id);
        }
    }
    return {};
}

void flip(CanFrame& frame, std::size_t bit) {
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (0x80U >> (bit % 8)));
}

TEST(WireFlip, each_of_22_million_3_bit_flips_of_the_longest_frame_is_refused) {
    CanFrame frame = longest_frame();
    ASSERT_EQ(frame.payload_len, 64);
    std::size_t flips = 0;
    for (std::size_t a = 0; a < 512; ++a) {
        flip(frame, a);
        for (std::size_t b = 0; b < a; ++b) {
            flip(frame, b);
            for (std::size_t c = 0; c < b; ++c) {
                flip(frame, c);
                ASSERT_FALSE(decode(frame)) << a << " " << b << " " << c;
                flip(frame, c);
                ++flips;
            }
            flip(frame, b);
        }
        flip(frame, a);
    }
    EXPECT_EQ(flips, 22'238'720U);
    EXPECT_TRUE(decode(frame));
}

/// In the order of the bus, where a byte's highest bit comes first.
void flip_burst(CanFrame& frame, std::size_t start, unsigned pattern) {
    for (std::size_t bit = start; pattern != 0; ++bit, pattern >>= 1U) {
        if ((pattern & 1U) != 0) {
            flip(frame, bit);
        }
    }
}

TEST(WireFlip, every_burst_of_up_to_16_bits_is_refused_in_every_layout_with_a_crc16) {
    for (const MessageCase& layout : all_message_cases()) {
        const bool is_shorter_fd = layout.is_fd && layout.payload_len < 64;
        if (layout.checksum_len != 2 || is_shorter_fd) {
            continue;
        }
        CanFrame frame = encode(layout.message, layout.node_id);
        for (unsigned pattern = 1; pattern < 65'536; pattern += 2) {
            const auto length = static_cast<unsigned>(std::bit_width(pattern));
            for (std::size_t start = 0; start + length <= 8U * frame.payload_len; ++start) {
                flip_burst(frame, start, pattern);
                ASSERT_FALSE(decode(frame)) << layout.name << " " << start << " " << pattern;
                flip_burst(frame, start, pattern);
            }
        }
        EXPECT_TRUE(decode(frame)) << layout.name;
    }
}

TEST(WireFields, every_value_of_every_16_bit_field_survives_the_wire) {
    std::size_t fields = 0;
    for (const MessageCase& layout : all_message_cases()) {
        const bool is_between =
            layout.payload_len == 32 || layout.payload_len == 48;  // 1 and 4 readings will do
        for (const FieldCase& field : layout.fields) {
            if (field.bits != 16 || is_between) {
                continue;
            }
            ++fields;
            Payload payload = payload_of(encode(layout.message, layout.node_id));
            wire::Message message = layout.message;
            for (std::uint64_t raw = 0; raw < 65'536; ++raw) {
                set_bits(payload, field.start, field.bits, raw);
                sign(layout.can_id, payload, layout.checksum_len);
                const CanFrame expected = frame_of(layout.can_id, layout.is_fd, payload);
                field.set(message, raw);
                ASSERT_EQ(encode(message, layout.node_id), expected)
                    << layout.name << " " << field.name << " " << raw;
                const auto decoded = decode(expected);
                ASSERT_TRUE(decoded) << layout.name << " " << field.name << " " << raw;
                ASSERT_EQ(decoded->message, message) << layout.name << " " << field.name << " " << raw;
            }
        }
    }
    EXPECT_EQ(fields, 34U);
}

}  // namespace
}  // namespace octoskin::test
