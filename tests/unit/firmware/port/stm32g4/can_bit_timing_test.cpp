#include "firmware/port/stm32g4/can_bit_timing.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>

namespace octoskin::stm32g4 {
namespace {

constexpr std::uint32_t kClock = 80'000'000;

struct Expected {
    std::uint32_t rate, prescaler, before, after;
};

// Arithmetic by hand for 80 MHz: rate * prescaler * (1 + before + after) = 80 MHz.
constexpr auto kNominal = std::to_array<Expected>(
    {{125'000, 4, 139, 20}, {250'000, 2, 139, 20}, {500'000, 1, 127, 32}, {1'000'000, 1, 63, 16}});
constexpr auto kData = std::to_array<Expected>(
    {{2'000'000, 1, 29, 10}, {4'000'000, 1, 14, 5}, {5'000'000, 1, 11, 4}, {8'000'000, 1, 6, 3}});

TEST(CanBitTiming, makes_the_usual_rates) {
    for (const Expected& e : kNominal) {
        EXPECT_EQ(nominal_timing(kClock, e.rate), (BitTiming{e.prescaler, e.before, e.after})) << e.rate;
    }
    for (const Expected& e : kData) {
        EXPECT_EQ(data_timing(kClock, e.rate), (BitTiming{e.prescaler, e.before, e.after})) << e.rate;
    }
}

TEST(CanBitTiming, writes_them_as_the_registers_want) {
    // 1M: SJW 16, prescaler 1, 63, 16. 5M with compensation: prescaler 1, 11, 4, SJW 4.
    EXPECT_EQ(nbtp(*nominal_timing(kClock, 1'000'000)), (15U << 25U) | (62U << 8U) | 15U);
    EXPECT_EQ(nbtp(*nominal_timing(kClock, 125'000)), (19U << 25U) | (3U << 16U) | (138U << 8U) | 19U);
    EXPECT_EQ(dbtp(5'000'000, *data_timing(kClock, 5'000'000)), (1U << 23U) | (10U << 8U) | (3U << 4U) | 3U);
    EXPECT_EQ(dbtp(1'000'000, *data_timing(kClock, 1'000'000)), (1U << 16U) | (28U << 8U) | (9U << 4U) | 9U);
    EXPECT_EQ(tdcr(*data_timing(kClock, 5'000'000)), 12U << 8U);
    EXPECT_EQ(tdcr(*data_timing(kClock, 2'000'000)), 30U << 8U);
}

/// Whether some prescaler gives a bit of 8 to `most` quanta, by trial.
bool divides(std::uint32_t rate, std::uint32_t prescaler_max, std::uint32_t most) {
    for (std::uint32_t prescaler = 1; prescaler <= prescaler_max; ++prescaler) {
        for (std::uint32_t quanta = 8; quanta <= most; ++quanta) {
            if (std::uint64_t{rate} * prescaler * quanta == kClock) return true;
        }
    }
    return false;
}

void check(std::uint32_t rate, const std::optional<BitTiming>& timing, const BitTimingRange& range,
           double sample_min) {
    ASSERT_TRUE(timing) << rate;
    EXPECT_EQ(std::uint64_t{rate} * timing->prescaler * timing->quanta(), kClock) << rate;
    EXPECT_LE(timing->prescaler, range.prescaler_max) << rate;
    EXPECT_GE(timing->before, 1U);
    EXPECT_LE(timing->before, range.before_max) << rate;
    EXPECT_GE(timing->after, 1U);
    EXPECT_LE(timing->after, range.after_max) << rate;
    const double sample = (1.0 + timing->before) / timing->quanta();
    EXPECT_GE(sample, sample_min) << rate;
    EXPECT_LE(sample, 0.90) << rate;
}

/// All of a configuration's range in steps of 500 bit/s.
TEST(CanBitTiming, is_exact_and_in_range_wherever_the_clock_divides) {
    int made = 0;
    for (std::uint32_t rate = 10'000; rate <= 8'000'000; rate += 500) {
        // At these sample points the longest bit has 257 / 0.875 = 293 quanta, the longest data bit 33 / 0.75
        // = 44.
        if (rate <= 1'000'000 && divides(rate, 512, 293)) {
            check(rate, nominal_timing(kClock, rate), kNominalRange, 0.75);
            ++made;
        }
        if (divides(rate, 32, 44)) {
            check(rate, data_timing(kClock, rate), kDataRange, 0.69);
            ++made;
        }
    }
    EXPECT_GE(made, 40) << "80 MHz has that many divisors that are multiples of 500";
    EXPECT_FALSE(data_timing(kClock, 7'000'000));
    EXPECT_FALSE(nominal_timing(kClock, 333'333));
    EXPECT_FALSE(nominal_timing(kClock, 0));
    EXPECT_FALSE(nominal_timing(0, 1'000'000));
}

TEST(CanBitTiming, knows_a_configuration_that_cannot_be_made) {
    NodeConfig config;
    EXPECT_TRUE(is_possible(rates_of(config), kClock));
    config.data_bitrate = 7'000'000;
    EXPECT_FALSE(is_possible(rates_of(config), kClock));
    config.uses_can_fd = false;
    EXPECT_TRUE(is_possible(rates_of(config), kClock)) << "classical CAN has no data rate";
    config.nominal_bitrate = 300'000;
    EXPECT_FALSE(is_possible(rates_of(config), kClock));
}

}  // namespace
}  // namespace octoskin::stm32g4
