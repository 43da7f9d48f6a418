#include "common/wire/bus_load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace octoskin::wire {
namespace {

constexpr BitRates k500k{.nominal = 500'000};
constexpr BitRates k1M{.nominal = 1'000'000};
constexpr BitRates kFd{.nominal = 1'000'000, .data = 5'000'000};

BusUse two_boards_of_17(double rate_hz) {
    return {.nodes = 3, .sensors = 34, .readings_per_s = 34 * rate_hz, .joint_samples_per_s = 100.0};
}
BusUse on_fd(BusUse use, std::uint8_t readings_per_frame) {
    use.uses_can_fd = true;
    use.readings_per_fd_frame = readings_per_frame;
    return use;
}
double load_of(const BusUse& use, const BitRates& rates) {
    return bus_load(traffic_of(use), rates);
}

// Oracle: Davis et al. 2007 print 55 + 10 s bits for 11-bit identifiers and s bytes (135 for 8).
TEST(WorstCaseBits, of_classical_frames_are_55_and_10_a_byte) {
    for (std::uint8_t bytes = 0; bytes <= 8; ++bytes) {
        EXPECT_EQ(worst_case_bits_classical(bytes).nominal, 55U + 10U * bytes);
        EXPECT_EQ(worst_case_bits_classical(bytes).data, 0U);
    }
}

// Hand-made sums: 1 + 4 + 8 n bits and 1 + 2 n dynamic stuff bits; stuff count 4, CRC 17 or 21, fixed stuff
// bits 6 or 7.
TEST(WorstCaseBits, of_fd_frames_are_33_or_38_and_10_a_byte_in_the_data_phase) {
    EXPECT_EQ(worst_case_bits_fd(8).data, 113U);
    EXPECT_EQ(worst_case_bits_fd(16).data, 193U);
    EXPECT_EQ(worst_case_bits_fd(20).data, 238U);
    EXPECT_EQ(worst_case_bits_fd(32).data, 358U);
    EXPECT_EQ(worst_case_bits_fd(48).data, 518U);
    EXPECT_EQ(worst_case_bits_fd(64).data, 678U);
    for (const std::uint8_t bytes : std::to_array<std::uint8_t>({0, 8, 20, 64})) {
        EXPECT_EQ(worst_case_bits_fd(bytes).nominal, 33U);
    }
}

// The oracle below builds the frame bit by bit and stuffs it as ISO 11898-1 says.
using Bits = std::vector<bool>;

void append(Bits& bits, unsigned value, int count) {
    for (int bit = count - 1; bit >= 0; --bit) {
        bits.push_back(((value >> bit) & 1U) != 0);
    }
}
unsigned crc15(const Bits& bits) {
    unsigned crc = 0;
    for (const bool bit : bits) {
        const bool carries = bit != ((crc & 0x4000U) != 0);
        crc = ((crc << 1U) & 0x7FFFU) ^ (carries ? 0x4599U : 0U);
    }
    return crc;
}
/// For each bit of `bits`, whether a stuff bit follows it.
std::vector<bool> stuffing(const Bits& bits) {
    std::vector<bool> follows(bits.size());
    bool level = true;
    int run = 0;
    for (std::size_t i = 0; i < bits.size(); ++i) {
        run = bits[i] == level ? run + 1 : 1;
        level = bits[i];
        if (run == 5) {
            follows[i] = true;
            level = !level;
            run = 1;
        }
    }
    return follows;
}
std::uint32_t classical_bits(unsigned id, const std::vector<std::uint8_t>& payload) {
    Bits bits;
    append(bits, 0, 1);
    append(bits, id, 11);
    append(bits, 0, 3);
    append(bits, static_cast<unsigned>(payload.size()), 4);
    for (const std::uint8_t byte : payload) {
        append(bits, byte, 8);
    }
    append(bits, crc15(bits), 15);
    const auto stuffed = stuffing(bits);
    const auto stuff_bits = std::ranges::count(stuffed, true);
    return static_cast<std::uint32_t>(bits.size()) + static_cast<std::uint32_t>(stuff_bits) + 1 + 2 + 7 + 3;
}
FrameBits fd_bits(unsigned id, unsigned dlc, const std::vector<std::uint8_t>& payload) {
    Bits bits;
    append(bits, 0, 1);
    append(bits, id, 11);
    append(bits, 0b00101, 5);  // RRS, IDE, FDF, res, BRS
    append(bits, 0, 1);        // ESI
    append(bits, dlc, 4);
    for (const std::uint8_t byte : payload) {
        append(bits, byte, 8);
    }
    const auto stuffed = stuffing(bits);
    const auto in_head = std::count(stuffed.begin(), stuffed.begin() + 17, true);
    const auto in_body = std::count(stuffed.begin() + 17, stuffed.end(), true);
    const std::uint32_t crc_field = payload.size() <= 16 ? 27 : 32;
    return {.nominal = 17 + static_cast<std::uint32_t>(in_head) + 1 + 2 + 7 + 3,
            .data = static_cast<std::uint32_t>(bits.size() - 17) + static_cast<std::uint32_t>(in_body) +
                    crc_field};
}
/// Bytes that are random half of the time, and else runs of four equal bits, the worst for stuffing.
std::vector<std::uint8_t> nasty_payload(std::mt19937& random, std::size_t size) {
    std::vector<std::uint8_t> payload(size);
    const bool has_runs = random() % 2 == 0;
    constexpr std::array<std::uint8_t, 8> kRuns = {0x78, 0x87, 0x0F, 0xF0, 0x1E, 0xE1, 0x3C, 0xC3};
    const std::uint8_t run = kRuns[random() % kRuns.size()];
    for (std::uint8_t& byte : payload) {
        byte = has_runs && random() % 8 != 0 ? run : static_cast<std::uint8_t>(random());
    }
    return payload;
}

TEST(WorstCaseBits, of_classical_frames_are_never_exceeded_and_nearly_reached) {
    std::mt19937 random(1);
    std::uint32_t most = 0;
    for (int i = 0; i < 20'000; ++i) {
        const std::uint32_t bits = classical_bits(random() & 0x7FFU, nasty_payload(random, 8));
        ASSERT_LE(bits, 135U) << i;
        most = std::max(most, bits);
    }
    EXPECT_GE(most, 130U);
}

TEST(WorstCaseBits, of_fd_frames_are_never_exceeded_and_nearly_reached) {
    std::mt19937 random(2);
    FrameBits most;
    for (int i = 0; i < 5'000; ++i) {
        const FrameBits bits = fd_bits(random() & 0x7FFU, 15, nasty_payload(random, 64));
        ASSERT_LE(bits.nominal, 33U) << i;
        ASSERT_LE(bits.data, 678U) << i;
        most = {std::max(most.nominal, bits.nominal), std::max(most.data, bits.data)};
    }
    EXPECT_GE(most.nominal, 32U);
    EXPECT_GE(most.data, 660U);
}

// Hand-made sums: a reading, joint, heartbeat, health or info frame has 135 bits, SYNC 85, SYNC_REPORT 125.
TEST(BusLoad, of_34_sensors_at_500k_is_41_percent_at_30_hz_and_59_at_50) {
    // (1020 + 400 + 30 + 34 + 21 + 1) * 135 + 85 + 3 * 125 = 203,770 bits a second; at 50 Hz 680 * 135 more.
    EXPECT_NEAR(load_of(two_boards_of_17(30.0), k500k), 203'770.0 / 500'000.0, 1e-12);
    EXPECT_NEAR(load_of(two_boards_of_17(50.0), k500k), 295'570.0 / 500'000.0, 1e-12);
    EXPECT_NEAR(load_of(two_boards_of_17(50.0), k1M), 0.29557, 1e-12);
}

TEST(BusLoad, of_readings_joints_heartbeats_and_health_alone_is_40_and_58_percent) {
    const auto load = [](double rate_hz) {
        return bus_load(std::array<Traffic, 4>{{{FrameType::range, 8, 34 * rate_hz},
                                                {FrameType::joint_state, 8, 400},
                                                {FrameType::heartbeat, 8, 30},
                                                {FrameType::sensor_health, 8, 34}}},
                        k500k);
    };
    EXPECT_NEAR(load(30.0), 0.40, 0.005);
    EXPECT_NEAR(load(50.0), 0.58, 0.005);
}

TEST(BusLoad, of_an_aux_frame_with_every_reading_at_50_hz_and_500k_is_beyond_the_bus) {
    BusUse use = two_boards_of_17(50.0);
    use.aux_per_s = use.readings_per_s;
    EXPECT_NEAR(load_of(use, k500k), 525'070.0 / 500'000.0, 1e-12);
}

TEST(BusLoad, on_fd_counts_both_bit_rates) {
    // 1020 frames of 33 us + 238 / 5 us, and the classical rest: 66,070 bits at 1 Mbit/s.
    EXPECT_NEAR(load_of(on_fd(two_boards_of_17(30.0), 1), kFd), 1020 * 80.6e-6 + 0.06607, 1e-12);
    // 255 frames of 33 us + 678 / 5 us.
    EXPECT_NEAR(load_of(on_fd(two_boards_of_17(30.0), 4), kFd), 255 * 168.6e-6 + 0.06607, 1e-12);
}

TEST(WorstCaseSeconds, are_the_bits_at_the_rates_that_the_format_has) {
    CanFrame frame{.can_id = 0x201, .payload_len = 8};
    EXPECT_NEAR(worst_case_seconds(frame, k500k), 270e-6, 1e-12);
    EXPECT_NEAR(worst_case_seconds(frame, kFd), 135e-6, 1e-12);
    frame = {.can_id = 0x241, .is_fd = true, .has_bit_rate_switch = true, .payload_len = 64};
    EXPECT_NEAR(worst_case_seconds(frame, kFd), 33e-6 + 678 / 5e6, 1e-12);
    frame.has_bit_rate_switch = false;
    EXPECT_NEAR(worst_case_seconds(frame, kFd), 711e-6, 1e-12);
}

TEST(BusLoad, of_nothing_is_nothing) {
    EXPECT_EQ(bus_load({}, k500k), 0.0);
}

TEST(BusLoadDeathTest, asserts_on_a_type_that_is_not_assigned) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const std::array<Traffic, 1> unassigned = {{{static_cast<FrameType>(14), 8, 1.0}}};
    EXPECT_DEATH(static_cast<void>(bus_load(unassigned, k1M)), "spec != nullptr");
    EXPECT_DEATH(static_cast<void>(worst_case_bits_classical(9)), "payload_len");
    EXPECT_DEATH(static_cast<void>(worst_case_bits_fd(9)), "is_fd_length");
}

}  // namespace
}  // namespace octoskin::wire
