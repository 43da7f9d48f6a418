#include "firmware/drivers/vl53l1x/result_block.hpp"

#include <gtest/gtest.h>

#include "common/range_status.hpp"

namespace octoskin::vl53l1x {
namespace {

// The example of ST's logged trace.
constexpr ResultBlock kExample{0x09, 0x00, 0x05, 0x1A, 0x00, 0x08, 0x00, 0x00, 0x10,
                               0x00, 0x10, 0x50, 0x00, 0x04, 0xD2, 0x07, 0x80};

TEST(ResultBlock, every_field_is_where_the_full_api_has_it) {
    const ResultBlock block{0x09, 0x00, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07,
                            0x08, 0x09, 0x0A, 0x0B, 0x0C, 0x0D, 0x0E, 0x0F};
    const Measurement expected{.device_status = 9,
                               .stream_count = 1,
                               .effective_spads = 0x0203,
                               .peak_signal = 0x0405,
                               .ambient = 0x0607,
                               .sigma_quarter_mm = 0x0809,
                               .range_mm = 0x0C0D,
                               .corrected_signal = 0x0E0F};
    EXPECT_EQ(unpack(block, false), expected);
}

TEST(ResultBlock, gain_factor_is_2011_of_2048_rounded) {
    EXPECT_EQ(unpack(kExample, false).range_mm, 1234);
    EXPECT_EQ(unpack(kExample, true).range_mm, 1212) << "as Pololu's library has it";
    for (int range = -32'768; range <= 32'767; ++range) {
        ResultBlock block = kExample;
        const auto raw = static_cast<std::uint16_t>(range);  // the register is signed
        block[13] = static_cast<std::uint8_t>(raw >> 8U);
        block[14] = static_cast<std::uint8_t>(raw & 0xFFU);
        ASSERT_EQ(unpack(block, false).range_mm, range);
        const double scaled = range * 2011.0 / 2048.0;
        ASSERT_NEAR(unpack(block, true).range_mm, scaled, 0.5) << range;
    }
}

TEST(ResultBlock, high_bits_never_change_the_status) {
    for (unsigned code = 0; code < 32; ++code) {
        for (unsigned high = 0; high < 8; ++high) {
            ResultBlock block = kExample;
            block[0] = static_cast<std::uint8_t>(code | (high << 5U));
            EXPECT_EQ(unpack(block, false).device_status, code);
            EXPECT_EQ(is_plausible(block), code <= 23) << code << ", high bits " << high;
        }
    }
}

TEST(ResultBlock, ones_throughout_are_no_result) {
    ResultBlock block{};
    block.fill(0xFF);
    EXPECT_FALSE(is_plausible(block));
}

TEST(ResultBlock, zeros_throughout_are_the_status_none) {
    EXPECT_TRUE(is_plausible(ResultBlock{}));
    EXPECT_EQ(range_status(unpack(ResultBlock{}, false).device_status).use, RangeUse::nothing);
}

TEST(ResultBlock, complete_range_without_a_spad_is_impossible) {
    for (unsigned code = 0; code <= 23; ++code) {
        ResultBlock block = kExample;
        block[0] = static_cast<std::uint8_t>(code);
        block[3] = 0;
        block[4] = 0;
        EXPECT_EQ(is_plausible(block), code != 9 && code != 19) << code;
        block[4] = 1;
        EXPECT_TRUE(is_plausible(block)) << code;
    }
}

}  // namespace
}  // namespace octoskin::vl53l1x
