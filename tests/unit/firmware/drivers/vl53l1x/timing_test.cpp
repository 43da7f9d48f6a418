// Oracles: ST ULD 3.5.2's tables as literals, its period formula in double precision, and for the medium rows
// (ours) the integration time of ST's long rows.
#include "firmware/drivers/vl53l1x/timing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "firmware/drivers/vl53l1x/settings.hpp"

namespace octoskin::vl53l1x {
namespace {

using enum DistanceMode;

struct Row {
    std::uint16_t budget_ms;
    std::uint16_t a;
    std::uint16_t b;
};
constexpr Row kShort[] = {{15, 0x001D, 0x0027}, {20, 0x0051, 0x006E},  {33, 0x00D6, 0x006E},
                          {50, 0x01AE, 0x01E8}, {100, 0x02E1, 0x0388}, {200, 0x03E1, 0x0496},
                          {500, 0x0591, 0x05C1}};
constexpr Row kLong[] = {{20, 0x001E, 0x0022},  {33, 0x0060, 0x006E},  {50, 0x00AD, 0x00C6},
                         {100, 0x01CC, 0x01EA}, {200, 0x02D9, 0x02F8}, {500, 0x048F, 0x04A4}};

TEST(Budget, equals_st_tables) {
    for (const Row& row : kShort) {
        EXPECT_EQ(range_timeouts(short_range, row.budget_ms), (RangeTimeouts{row.a, row.b})) << row.budget_ms;
        EXPECT_EQ(budget_of_timeout_a(row.a), row.budget_ms);
    }
    for (const Row& row : kLong) {
        EXPECT_EQ(range_timeouts(long_range, row.budget_ms), (RangeTimeouts{row.a, row.b})) << row.budget_ms;
        EXPECT_EQ(budget_of_timeout_a(row.a), row.budget_ms);
    }
}

TEST(Budget, any_other_is_refused_in_every_mode) {
    const std::set<std::uint16_t> known{33, 50, 100, 200, 500};
    for (unsigned ms = 0; ms <= 0xFFFF; ++ms) {
        const auto budget_ms = static_cast<std::uint16_t>(ms);
        const bool is_known = known.contains(budget_ms);
        ASSERT_EQ(range_timeouts(long_range, budget_ms).has_value(), is_known || ms == 20) << ms;
        ASSERT_EQ(range_timeouts(medium_range, budget_ms).has_value(), is_known) << ms;
        ASSERT_EQ(range_timeouts(short_range, budget_ms).has_value(), is_known || ms == 15 || ms == 20) << ms;
    }
}

TEST(Budget, time_out_a_names_one_budget_or_none) {
    unsigned found = 0;
    for (unsigned a = 0; a <= 0xFFFF; ++a)
        found += budget_of_timeout_a(static_cast<std::uint16_t>(a)) ? 1U : 0U;
    EXPECT_EQ(found, 18U) << "7 short, 5 medium, 6 long: no value stands for two";
}

double integration_us(std::uint16_t timeout, int vcsel_clocks) {
    const double pll_us = std::ldexp(1.0, 30) / 0xBC7A / std::ldexp(1.0, 24);
    return (std::ldexp(timeout & 0xFF, timeout >> 8) + 1.0) * 2304.0 * vcsel_clocks * pll_us;
}

TEST(Budget, medium_integrates_for_as_long_as_long_does) {
    for (const Row& row : kLong) {
        if (row.budget_ms == 20) continue;  // DS12385 2.5.2: medium mode needs 33 ms
        const RangeTimeouts medium = range_timeouts(medium_range, row.budget_ms).value();
        EXPECT_NEAR(integration_us(medium.a, 24) / integration_us(row.a, 32), 1.0, 0.01) << row.budget_ms;
        EXPECT_NEAR(integration_us(medium.b, 20) / integration_us(row.b, 28), 1.0, 0.01) << row.budget_ms;
        EXPECT_LE(integration_us(medium.a, 24), integration_us(row.a, 32)) << "never longer";
        EXPECT_LE(integration_us(medium.b, 20), integration_us(row.b, 28));
    }
}

TEST(Mode, registers_are_st_and_pololus) {
    EXPECT_EQ(mode_registers(short_range).phasecal_timeout, 0x14);
    EXPECT_EQ(mode_registers(short_range).vcsel_period_a, 0x07);
    EXPECT_EQ(mode_registers(short_range).vcsel_period_b, 0x05);
    EXPECT_EQ(mode_registers(short_range).valid_phase_high, 0x38);
    EXPECT_EQ(mode_registers(short_range).woi, 0x0705);
    EXPECT_EQ(mode_registers(short_range).initial_phase, 0x0606);
    EXPECT_EQ(mode_registers(medium_range).phasecal_timeout, 0x0E);
    EXPECT_EQ(mode_registers(medium_range).vcsel_period_a, 0x0B);
    EXPECT_EQ(mode_registers(medium_range).vcsel_period_b, 0x09);
    EXPECT_EQ(mode_registers(medium_range).valid_phase_high, 0x78);
    EXPECT_EQ(mode_registers(medium_range).woi, 0x0B09);
    EXPECT_EQ(mode_registers(medium_range).initial_phase, 0x0A0A);
    EXPECT_EQ(mode_registers(long_range).phasecal_timeout, 0x0A);
    EXPECT_EQ(mode_registers(long_range).vcsel_period_a, 0x0F);
    EXPECT_EQ(mode_registers(long_range).vcsel_period_b, 0x0D);
    EXPECT_EQ(mode_registers(long_range).valid_phase_high, 0xB8);
    EXPECT_EQ(mode_registers(long_range).woi, 0x0F0D);
    EXPECT_EQ(mode_registers(long_range).initial_phase, 0x0E0E);
}

TEST(Mode, is_marked_by_three_values_and_by_no_other) {
    for (unsigned value = 0; value <= 0xFF; ++value) {
        const auto mode = marked_mode(static_cast<std::uint8_t>(value));
        const auto expected = value == 0x14   ? std::optional(short_range)
                              : value == 0x0E ? std::optional(medium_range)
                              : value == 0x0A ? std::optional(long_range)
                                              : std::nullopt;
        EXPECT_EQ(mode, expected) << value;
    }
}

TEST(Period, equals_st_formula_for_every_oscillator_value) {
    for (std::uint16_t oscillator = 1; oscillator <= 0x3FF; ++oscillator) {
        for (const int ms : {1, 7, 20, 33, 50, 100, 1'000, 60'000}) {
            const auto expected = static_cast<std::uint32_t>(oscillator * ms * 1.075);
            ASSERT_EQ(period_register(oscillator, Microseconds{ms * 1'000}), expected)
                << oscillator << ' ' << ms;
        }
    }
}

TEST(Period, literal_values) {
    EXPECT_EQ(period_step(37), Nanoseconds{25'141}) << "1e9 / (37 * 1075)";
    EXPECT_EQ(period_step(0xFC00), std::nullopt);
    EXPECT_EQ(period_register(37, Microseconds{50'000}), 0x07C4U);
    EXPECT_EQ(period_register(37, Microseconds{100'000}), 0x0F89U) << "ST's default configuration";
    EXPECT_EQ(period_register(37, Microseconds{50'500}), 2'008U) << "finer than milliseconds";
}

TEST(Period, only_ten_bits_of_the_oscillator_count) {
    EXPECT_EQ(period_register(0xFC25, Microseconds{50'000}), 0x07C4U);
    EXPECT_EQ(period_register(0xFC00, Microseconds{50'000}), std::nullopt);
    EXPECT_EQ(period_register(0, Microseconds{50'000}), std::nullopt);
}

TEST(Period, impossible_ones_are_none) {
    EXPECT_EQ(period_register(37, Microseconds{0}), std::nullopt);
    EXPECT_EQ(period_register(37, Microseconds{-1}), std::nullopt);
    EXPECT_EQ(period_register(1, Microseconds{900}), std::nullopt) << "less than a tick";
    EXPECT_EQ(period_register(1023, Microseconds{INT64_MAX}), std::nullopt);
    EXPECT_EQ(period_register(1023, Microseconds{3'600'000'000}), 3'959'010'000U);
}

TEST(Period, needs_the_budget_and_5_ms) {
    EXPECT_TRUE(is_period_long_enough(15, 20));
    EXPECT_FALSE(is_period_long_enough(15, 19));
    EXPECT_TRUE(is_period_long_enough(500, 505));
    EXPECT_FALSE(is_period_long_enough(500, 504));
    EXPECT_FALSE(is_period_long_enough(65'535, 4)) << "no wrap";
}

TEST(Settings, defaults_are_supported) {
    EXPECT_TRUE(is_supported(Settings{}));
}

TEST(Settings, each_broken_limit_is_refused) {
    const auto refuses = [](auto change) {
        Settings settings;
        change(settings);
        return !is_supported(settings);
    };
    EXPECT_TRUE(refuses([](Settings& s) { s.timing_budget_ms = 25; }));
    EXPECT_TRUE(refuses([](Settings& s) { s.timing_budget_ms = 15; })) << "short mode only";
    EXPECT_TRUE(refuses([](Settings& s) { s.inter_measurement_ms = 24; }));
    EXPECT_FALSE(refuses([](Settings& s) { s.inter_measurement_ms = 25; }));
    EXPECT_TRUE(refuses([](Settings& s) { s.zone_count = 0; }));
    EXPECT_TRUE(refuses([](Settings& s) { s.zone_count = 10; }));
    EXPECT_TRUE(refuses([](Settings& s) { s.zones[0].centre_spad = 0; }));
    EXPECT_FALSE(refuses([](Settings& s) { s.zones[1].centre_spad = 0; })) << "not in use";
    EXPECT_TRUE(refuses([](Settings& s) {
        s.zones[1].centre_spad = 0;
        s.zone_count = 2;
    }));
    const auto refuses_offset = [&](std::int16_t value, bool is_used) {
        return refuses([=](Settings& s) {
            s.offset_quarter_mm = value;
            s.has_offset = is_used;
        });
    };
    EXPECT_FALSE(refuses_offset(4095, true));
    EXPECT_TRUE(refuses_offset(4096, true));
    EXPECT_FALSE(refuses_offset(-4096, true));
    EXPECT_TRUE(refuses_offset(-4097, true));
    EXPECT_FALSE(refuses_offset(-4097, false));
}

}  // namespace
}  // namespace octoskin::vl53l1x
