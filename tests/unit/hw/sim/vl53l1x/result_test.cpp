// What the part reports: budgets, statuses, formats, interrupt conditions. Oracles: ST's tables as literals,
// the register formats of ST's full API, and brute force.
#include <gtest/gtest.h>

#include "hw/sim/vl53l1x/ranging_result.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"

namespace octoskin::sim {
namespace {

Registers with_mode(std::uint8_t vcsel_a, std::uint8_t vcsel_b, std::uint16_t timeout_a,
                    std::uint16_t timeout_b, std::uint8_t sequence) {
    Registers registers = reset_registers();
    registers.at(0x60) = vcsel_a;
    registers.at(0x63) = vcsel_b;
    registers.at(0x81) = sequence;
    write16(registers, 0x5E, timeout_a);
    write16(registers, 0x61, timeout_b);
    return registers;
}

std::int64_t budget_us(const Registers& registers) {
    return ranging_timing(registers, {}).budget.count();
}

TEST(Budget, is_st_tables_for_st_values) {
    struct Row {
        std::int64_t ms;
        std::uint16_t a;
        std::uint16_t b;
    };
    for (const Row& row :
         {Row{15, 0x001D, 0x0027}, Row{20, 0x0051, 0x006E}, Row{33, 0x00D6, 0x006E}, Row{50, 0x01AE, 0x01E8},
          Row{100, 0x02E1, 0x0388}, Row{200, 0x03E1, 0x0496}, Row{500, 0x0591, 0x05C1}}) {
        EXPECT_EQ(budget_us(with_mode(0x07, 0x05, row.a, row.b, 0x9B)), row.ms * 1000);
    }
    for (const Row& row : {Row{20, 0x001E, 0x0022}, Row{33, 0x0060, 0x006E}, Row{50, 0x00AD, 0x00C6},
                           Row{100, 0x01CC, 0x01EA}, Row{200, 0x02D9, 0x02F8}, Row{500, 0x048F, 0x04A4}}) {
        EXPECT_EQ(budget_us(with_mode(0x0F, 0x0D, row.a, row.b, 0x9B)), row.ms * 1000);
    }
}

// Pololu's library computed these for 33, 50 and 20 ms, by ST's full API.
TEST(Budget, follows_from_the_time_outs_for_any_other_value) {
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0F, 0x0D, 0x0091, 0x00A5, 0x8B))), 33e3, 100.0);
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0F, 0x0D, 0x00E7, 0x0184, 0x8B))), 50e3, 200.0);
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x07, 0x05, 0x009D, 0x00D2, 0x8B))), 20e3, 100.0);
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0B, 0x09, 0x00C1, 0x00E8, 0x8B))), 33e3, 100.0);
}

TEST(Budget, of_st_sequence_is_interpolated_between_st_rows) {
    // Medium mode with the long rows' integration times, in its own macro periods of 73.3 and 61.1 us.
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0B, 0x09, 0x0028, 0x0030, 0x9B))), 20e3, 200.0);
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0B, 0x09, 0x0080, 0x009A, 0x9B))), 33e3, 200.0);
    EXPECT_NEAR(static_cast<double>(budget_us(with_mode(0x0B, 0x09, 0x04BE, 0x04E5, 0x9B))), 500e3, 2'000.0);
}

TEST(Region, fits_if_every_spad_of_it_is_on_the_array) {
    // Brute force: the SPADs as UM2555 draws them.
    for (int centre = 0; centre < 256; ++centre) {
        const int column = centre >= 128 ? (centre - 128) / 8 : (127 - centre) / 8;
        const int row = centre >= 128 ? (centre - 128) % 8 : 8 + (127 - centre) % 8;
        for (std::uint8_t width = 4; width <= 16; ++width) {
            for (std::uint8_t height = 4; height <= 16; ++height) {
                bool fits = true;
                for (int c = column - width / 2; c < column - width / 2 + width; ++c)
                    fits &= c >= 0 && c < 16;
                for (int r = row + height / 2; r > row + height / 2 - height; --r) fits &= r >= 0 && r < 16;
                const Roi roi{
                    .centre_spad = static_cast<std::uint8_t>(centre), .width = width, .height = height};
                ASSERT_EQ(is_on_array(roi), fits) << centre << ' ' << int{width} << 'x' << int{height};
            }
        }
    }
}

TEST(Region, has_the_limit_of_signal_that_fits_its_spads) {
    Registers registers = reset_registers();
    write16(registers, 0x66, 0x0080);  // 1 Mcps
    EXPECT_EQ(ranging_config(registers).signal_limit_mcps, 1.0);
    registers.at(0x80) = 0x33;  // 4 x 4: a sixteenth of the array, which no longer counts as few as that
    EXPECT_NEAR(ranging_config(registers).signal_limit_mcps, 0.39, 1e-12);
    registers.at(0x7F) = 199;
    const RangingReturn seen{.range_m = 1.0, .sigma_m = 0.01, .peak_signal_mcps = 0.4, .ambient_mcps = 0.0};
    EXPECT_EQ(device_status(ranging_config(registers), seen), 9);
    registers.at(0x80) = 0x77;  // 8 x 8: half of the array's limit
    EXPECT_EQ(ranging_config(registers).signal_limit_mcps, 0.5);
    EXPECT_EQ(device_status(ranging_config(registers), seen), 4);
}

TEST(Region, sides_below_4_are_raised_to_4) {
    Registers registers = reset_registers();
    registers.at(0x80) = 0x71;  // 8 high, 2 wide: becomes 4 x 8
    EXPECT_EQ(region_of_interest(registers), (Roi{.centre_spad = 199, .width = 4, .height = 8}));
}

RangingReturn seen_at(double range_m) {
    return {.range_m = range_m, .sigma_m = 0.005, .peak_signal_mcps = 16.0, .ambient_mcps = 0.125};
}

class Status : public testing::Test {
  protected:
    Registers registers_ = with_mode(0x0F, 0x0D, 0x001E, 0x0022, 0x9B);
    void SetUp() override { registers_.at(0x69) = 0xB8; }
    [[nodiscard]] int status(const RangingReturn& seen) const {
        return device_status(ranging_config(registers_), seen);
    }
    [[nodiscard]] int range_mm(const RangingReturn& seen) const {
        return reported_range_mm(ranging_config(registers_), seen, 7);
    }
};

TEST_F(Status, complete_up_to_the_end_of_the_valid_phase) {
    EXPECT_EQ(status(seen_at(4.59)), 9);
    EXPECT_EQ(status(seen_at(4.61)), 5) << "23.0 * 0.2 m";
    registers_.at(0x69) = 0x38;
    EXPECT_EQ(status(seen_at(1.39)), 9);
    EXPECT_EQ(status(seen_at(1.41)), 5);
    registers_.at(0x69) = 0x78;
    EXPECT_EQ(status(seen_at(2.99)), 9);
    EXPECT_EQ(status(seen_at(3.01)), 5);
}

TEST_F(Status, follows_the_limits) {
    RangingReturn weak = seen_at(1.0);
    weak.peak_signal_mcps = 0.99;
    EXPECT_EQ(status(weak), 4) << "limit 1.0 Mcps";
    write16(registers_, 0x66, 0x0040);
    EXPECT_EQ(status(weak), 9) << "limit 0.5 Mcps";
    RangingReturn noisy = seen_at(1.0);
    noisy.sigma_m = 0.0901;
    EXPECT_EQ(status(noisy), 6) << "limit 90 mm";
    noisy.sigma_m = 0.0899;
    EXPECT_EQ(status(noisy), 9);
    write16(registers_, 0x64, 0x003C);
    EXPECT_EQ(status(noisy), 6) << "limit 15 mm";
}

TEST_F(Status, without_a_return_is_no_target_with_a_ghost_for_a_range) {
    const RangingReturn nothing{.range_m = std::nullopt, .peak_signal_mcps = 16.0};
    EXPECT_EQ(status(nothing), 4);
    EXPECT_GE(range_mm(nothing), 100);
    EXPECT_LE(range_mm(nothing), 500);
}

TEST_F(Status, a_misfit_region_is_13_whatever_is_seen) {
    registers_.at(0x7F) = 0;
    EXPECT_EQ(status(seen_at(1.0)), 13);
}

TEST_F(Status, range_carries_the_set_offset_less_the_factorys) {
    EXPECT_EQ(range_mm(seen_at(1.234)), 1234) << "factory 13.0 mm";
    write16(registers_, 0x1E, 0x0000);
    EXPECT_EQ(range_mm(seen_at(1.234)), 1221);
    write16(registers_, 0x1E, 0xFFCC);
    EXPECT_EQ(range_mm(seen_at(1.234)), 1208) << "-13.0 mm, 13 bits signed";
    write16(registers_, 0x1E, 0x1FCC);
    EXPECT_EQ(range_mm(seen_at(1.234)), 1208) << "the upper three bits do not count";
    EXPECT_EQ(range_mm(seen_at(0.010)), -16) << "signed";
}

// 204.8 of 256 SPADs are active: 10 kcps each are 2.048 of 16 Mcps, 12.8 %.
TEST_F(Status, crosstalk_shortens_the_range_by_its_share_until_it_is_compensated) {
    const auto range_with = [&](double crosstalk_kcps) {
        return reported_range_mm(ranging_config(registers_, crosstalk_kcps), seen_at(1.0), 0);
    };
    EXPECT_EQ(range_with(0.0), 1000);
    EXPECT_EQ(range_with(10.0), 872);
    write16(registers_, 0x16, 5 * 512);
    EXPECT_EQ(range_with(10.0), 936);
    EXPECT_EQ(range_with(5.0), 1000);
    EXPECT_EQ(range_with(0.0), 1064) << "compensated too much";
    RangingReturn dark = seen_at(1.0);
    dark.peak_signal_mcps = 0.0;
    EXPECT_EQ(reported_range_mm(ranging_config(registers_, 10.0), dark, 0), 1000) << "no signal, no share";
}

TEST_F(Status, beyond_the_window_the_range_wraps) {
    EXPECT_EQ(range_mm(seen_at(5.6)), 1000);
}

TEST(Result, is_written_in_the_devices_formats) {
    Registers registers = reset_registers();
    const RangingConfig config{.roi = {.centre_spad = 199, .width = 5, .height = 10}};
    const RangingReturn seen{
        .range_m = 1.6, .sigma_m = 0.00425, .peak_signal_mcps = 15.0, .ambient_mcps = 0.5};
    write_result(registers, config, seen, {.range_status = 0xE9, .stream_count = 200, .range_mm = 1600});
    EXPECT_EQ(registers.at(0x89), 0xE9);
    EXPECT_EQ(registers.at(0x8B), 200);
    EXPECT_EQ(read16(registers, 0x8C), 40 * 256) << "8.8, 80 % of 50 SPADs";
    EXPECT_EQ(read16(registers, 0x8E), 15 * 128) << "9.7";
    EXPECT_EQ(read16(registers, 0x90), 64) << "9.7";
    EXPECT_EQ(read16(registers, 0x92), 17) << "14.2 mm";
    EXPECT_EQ(read16(registers, 0x94), 8 * 2048) << "5.11, 0.2 m a unit";
    EXPECT_EQ(read16(registers, 0x96), 1600);
    EXPECT_EQ(read16(registers, 0x98), 15 * 128);
    write_result(registers, config, seen, {.range_status = 9, .stream_count = 0, .range_mm = -5});
    EXPECT_EQ(read16(registers, 0x96), 0xFFFB);
}

TEST(Interrupt, fires_by_its_condition) {
    struct Case {
        std::uint8_t condition;
        std::uint8_t status;
        std::int16_t range_mm;
        bool fires;
    };
    // Thresholds 100 and 300 mm.
    for (const Case& one : {Case{0x20, 9, 200, true}, Case{0x20, 4, 200, true}, Case{0x00, 9, 99, true},
                            Case{0x00, 9, 100, false}, Case{0x01, 9, 300, false}, Case{0x01, 9, 301, true},
                            Case{0x02, 9, 99, true}, Case{0x02, 9, 200, false}, Case{0x02, 9, 301, true},
                            Case{0x03, 9, 99, false}, Case{0x03, 9, 200, true}, Case{0x03, 9, 301, false},
                            Case{0x03, 4, 200, false}, Case{0x43, 4, 200, true}}) {
        const RangingConfig config{
            .interrupt_condition = one.condition, .threshold_low_mm = 100, .threshold_high_mm = 300};
        EXPECT_EQ(fires_interrupt(config, {.range_status = one.status, .range_mm = one.range_mm}), one.fires)
            << int{one.condition} << ' ' << one.range_mm;
    }
}

}  // namespace
}  // namespace octoskin::sim
