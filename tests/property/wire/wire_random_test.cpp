// Seeded random frames: what passes, how often, and that nothing passes that we would not have sent
// ourselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "common/wire/codec.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/support/wire/message_cases.hpp"

namespace octoskin::test {
namespace {

using wire::CanFrame;
using wire::DecodeError;

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    std::uint64_t below(std::uint64_t limit) { return engine_() % limit; }
    std::size_t index_below(std::size_t size) { return static_cast<std::size_t>(below(size)); }
    bool one_in(std::uint64_t n) { return below(n) == 0; }
    void fill(std::span<std::uint8_t> bytes) {
        std::ranges::generate(bytes, [this] { return static_cast<std::uint8_t>(engine_()); });
    }

  private:
    std::mt19937_64 engine_;
};

/// Successes of `trials` at probability `p` stay within 5 standard deviations (and 5 more, for small counts):
/// a right implementation fails this less than once in a million seeds.
void expect_about(std::size_t successes, std::size_t trials, double p, const char* what) {
    const double mean = static_cast<double>(trials) * p;
    EXPECT_NEAR(static_cast<double>(successes), mean, 5.0 * std::sqrt(mean) + 5.0) << what;
}

TEST(WireRandom, random_payloads_pass_the_checksum_at_2_to_the_minus_its_width) {
    for (const std::uint64_t seed : {1ULL, 2ULL}) {
        Random random(seed);
        std::array<std::size_t, 3> trials{};
        std::array<std::size_t, 3> passed{};
        const auto cases = all_message_cases();
        for (int i = 0; i < 520'000; ++i) {
            const MessageCase& layout = cases[random.index_below(cases.size())];
            CanFrame frame = encode(layout.message, layout.node_id);
            random.fill(std::span(frame.data).first(frame.payload_len));
            const auto decoded = decode(frame);
            ++trials.at(layout.checksum_len);
            passed.at(layout.checksum_len) += decoded || decoded.error() != DecodeError::wrong_crc ? 1U : 0U;
        }
        SCOPED_TRACE(seed);
        ASSERT_GT(trials[1], 200'000U);
        ASSERT_GT(trials[2], 200'000U);
        expect_about(passed[1], trials[1], 1.0 / 256, "crc8");
        expect_about(passed[2], trials[2], 1.0 / 65'536, "crc16");
    }
}

TEST(WireRandom, frames_with_4_or_more_flipped_bits_pass_at_most_at_2_to_the_minus_width) {
    Random random(3);
    std::array<std::size_t, 3> trials{};
    std::array<std::size_t, 3> accepted{};
    const auto cases = all_message_cases();
    for (int i = 0; i < 520'000; ++i) {
        const MessageCase& layout = cases[random.index_below(cases.size())];
        CanFrame frame = encode(layout.message, layout.node_id);
        const CanFrame good = frame;
        for (std::uint64_t flips = 4 + random.below(20); flips > 0; --flips) {
            const std::size_t bit = random.index_below(8U * frame.payload_len);
            frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
        }
        ++trials.at(layout.checksum_len);
        accepted.at(layout.checksum_len) += frame != good && decode(frame) ? 1U : 0U;
    }
    for (const std::size_t bytes : {1U, 2U}) {
        const double expected =
            static_cast<double>(trials.at(bytes)) * std::pow(2.0, -8.0 * static_cast<double>(bytes));
        EXPECT_LE(static_cast<double>(accepted.at(bytes)), expected + 5.0 * std::sqrt(expected) + 5.0)
            << bytes;
    }
}

/// Any identifier, flags and length; half of them with our version and a right checksum, so that some get
/// far.
CanFrame any_frame(Random& random) {
    CanFrame frame;
    frame.can_id =
        static_cast<std::uint32_t>(random.one_in(20) ? random.below(1ULL << 32U) : random.below(2048));
    frame.is_extended = random.one_in(20);
    frame.is_remote = random.one_in(20);
    frame.is_error = random.one_in(20);
    frame.is_fd = random.one_in(4);
    frame.has_bit_rate_switch = random.one_in(2);
    constexpr std::array<std::uint8_t, 8> kOurLengths = {3, 7, 8, 8, 20, 32, 48, 64};
    frame.payload_len =
        random.one_in(4) ? static_cast<std::uint8_t>(random.below(256)) : kOurLengths[random.index_below(8)];
    random.fill(frame.data);
    if (frame.payload_len > 64 || random.one_in(2)) {
        return frame;
    }
    Payload payload = payload_of(frame);
    if (!payload.empty() && !random.one_in(16)) {
        payload[0] = static_cast<std::uint8_t>((payload[0] & 0xF8U) | 1U);
    }
    sign(frame.can_id, payload, checksum_len_of(frame.can_id));
    std::ranges::copy(payload, frame.data.begin());
    return frame;
}

TEST(WireRandom, each_of_a_million_random_frames_is_decoded_or_refused_for_a_reason) {
    Random random(4);
    std::array<std::size_t, wire::kDecodeErrors> refused{};
    std::size_t accepted = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const auto decoded = decode(any_frame(random));
        if (decoded) {
            ++accepted;
        } else {
            ++refused.at(static_cast<std::size_t>(decoded.error()));
        }
    }
    EXPECT_GT(accepted, 1'000U);
    for (std::size_t error = 0; error < refused.size(); ++error) {
        EXPECT_GT(refused.at(error), 100U) << name(static_cast<DecodeError>(error));
    }
}

// No two different payloads mean the same: what is accepted is exactly what encoding gives.
TEST(WireRandom, every_accepted_frame_is_the_one_that_its_message_encodes_to) {
    Random random(5);
    const auto cases = all_message_cases();
    std::size_t accepted = 0;
    for (int i = 0; i < 300'000; ++i) {
        const MessageCase& layout = cases[random.index_below(cases.size())];
        Payload payload = payload_of(encode(layout.message, layout.node_id));
        const std::uint8_t selector = payload[0];
        for (const FieldCase& field : layout.fields) {
            set_bits(payload, field.start, field.bits,
                     random.below(field.bits == 64 ? ~0ULL : 1ULL << field.bits));
        }
        if (random.one_in(2)) {
            random.fill(std::span(payload).first(1));
            payload[0] = static_cast<std::uint8_t>((payload[0] & 0xF8U) | (selector & 7U));
        }
        sign(layout.can_id, payload, layout.checksum_len);
        const CanFrame frame = frame_of(layout.can_id, layout.is_fd, payload);
        const auto decoded = decode(frame);
        if (decoded) {
            ++accepted;
            ASSERT_EQ(encode(decoded->message, decoded->node_id), frame) << layout.name;
        }
    }
    EXPECT_GT(accepted, 100'000U);
}

}  // namespace
}  // namespace octoskin::test
