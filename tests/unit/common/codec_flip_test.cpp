// The checksums against errors: every 1-, 2- and 3-bit flip of a frame of every layout, identifier included.
// Bits that no checksum covers (the identifier's upper bits may turn one type into another with another
// checksum) are in it too.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

using wire::CanFrame;

constexpr std::size_t kIdBits = 11;

std::size_t bits_of(const CanFrame& frame) {
    return kIdBits + 8U * frame.payload_len;
}

void flip(CanFrame& frame, std::size_t bit) {
    if (bit < kIdBits) {
        frame.can_id ^= 1U << bit;
    } else {
        std::uint8_t& byte = frame.data[(bit - kIdBits) / 8];
        byte = static_cast<std::uint8_t>(byte ^ (1U << ((bit - kIdBits) % 8)));
    }
}

TEST(CodecFlip, every_1_and_2_bit_flip_of_every_layout_is_refused) {
    for (const MessageCase& layout : all_message_cases()) {
        CanFrame frame = encode(layout.message, layout.node_id);
        for (std::size_t a = 0; a < bits_of(frame); ++a) {
            flip(frame, a);
            ASSERT_FALSE(decode(frame)) << layout.name << " " << a;
            for (std::size_t b = 0; b < a; ++b) {
                flip(frame, b);
                ASSERT_FALSE(decode(frame)) << layout.name << " " << a << " " << b;
                flip(frame, b);
            }
            flip(frame, a);
        }
        ASSERT_TRUE(decode(frame)) << layout.name;
    }
}

TEST(CodecFlip, every_3_bit_flip_of_every_classical_layout_is_refused) {
    for (const MessageCase& layout : all_message_cases()) {
        if (layout.is_fd) {
            continue;
        }
        CanFrame frame = encode(layout.message, layout.node_id);
        for (std::size_t a = 0; a < bits_of(frame); ++a) {
            flip(frame, a);
            for (std::size_t b = 0; b < a; ++b) {
                flip(frame, b);
                for (std::size_t c = 0; c < b; ++c) {
                    flip(frame, c);
                    ASSERT_FALSE(decode(frame)) << layout.name << " " << a << " " << b << " " << c;
                    flip(frame, c);
                }
                flip(frame, b);
            }
            flip(frame, a);
        }
    }
}

// A CRC is linear: what a flip changes in it does not depend on the data, and what several flips change is
// the XOR of what each changes. A flip goes unseen if the change is zero. All 3-bit flips of 64 bytes are
// flipped for real in tests/property.
template <class Checksum>
void expect_no_3_flips_cancel(std::size_t data_len, Checksum checksum) {
    Payload covered(3 + data_len, 0);
    const unsigned plain = checksum(covered);
    std::vector<unsigned> changes;
    for (std::size_t bit = 0; bit < 8 * covered.size(); ++bit) {
        covered[bit / 8] = static_cast<std::uint8_t>(1U << (bit % 8));
        changes.push_back(plain ^ checksum(covered));
        covered[bit / 8] = 0;
    }
    for (unsigned bit = 0; bit < 8 * sizeof(checksum(covered)); ++bit) {
        changes.push_back(1U << bit);
    }
    unsigned long unseen = 0;
    for (std::size_t a = 0; a < changes.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            const unsigned pair = changes[a] ^ changes[b];
            for (std::size_t c = 0; c < b; ++c) {
                unseen += (pair ^ changes[c]) == 0 ? 1U : 0U;
            }
        }
    }
    EXPECT_EQ(unseen, 0U);
}

TEST(CodecFlip, no_three_flips_cancel_in_the_crc16_of_the_longest_frame) {
    expect_no_3_flips_cancel(62, [](const Payload& bytes) { return crc16(bytes); });
}

TEST(CodecFlip, no_three_flips_cancel_in_the_crc8_of_a_classical_frame) {
    expect_no_3_flips_cancel(7, [](const Payload& bytes) { return crc8(bytes); });
}

// A burst is a run of wrong bits in the order of the bus, where a byte's highest bit comes first.
void flip_on_the_bus(CanFrame& frame, std::size_t bit) {
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (0x80U >> (bit % 8)));
}
void flip_burst(CanFrame& frame, std::size_t start, unsigned pattern) {
    for (std::size_t bit = start; pattern != 0; ++bit, pattern >>= 1U) {
        if ((pattern & 1U) != 0) {
            flip_on_the_bus(frame, bit);
        }
    }
}

TEST(CodecFlip, every_burst_as_long_as_the_checksum_is_refused) {
    for (const MessageCase& layout : all_message_cases()) {
        // One with a CRC-16 here; the others, and the long ones, are in tests/property.
        if (layout.checksum_len == 2 && layout.name != "HEARTBEAT") {
            continue;
        }
        CanFrame frame = encode(layout.message, layout.node_id);
        const unsigned width = 8 * layout.checksum_len;
        // A burst begins and ends with a wrong bit; the shorter ones are the odd patterns with zeros on top.
        for (unsigned pattern = 1; pattern < (1U << width); pattern += 2) {
            unsigned length = 0;
            while ((pattern >> length) != 0) {
                ++length;
            }
            for (std::size_t start = 0; start + length <= 8U * frame.payload_len; ++start) {
                flip_burst(frame, start, pattern);
                ASSERT_FALSE(decode(frame)) << layout.name << " " << start << " " << pattern;
                flip_burst(frame, start, pattern);
            }
        }
    }
}

}  // namespace
}  // namespace octoskin::test
