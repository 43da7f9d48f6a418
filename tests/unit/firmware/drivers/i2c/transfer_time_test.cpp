// Literal numbers from the I2C specification (UM10204): 9 clocks a byte, one each for START and STOP.
#include "firmware/drivers/i2c/transfer_time.hpp"

#include <gtest/gtest.h>

#include <array>

namespace octoskin::i2c {
namespace {

TEST(TransferTime, counts_every_clock) {
    EXPECT_EQ(bit_count(2, 1), 48U);
    EXPECT_EQ(bit_count(2, 2), 57U);
    EXPECT_EQ(bit_count(2, 17), 192U);
    EXPECT_EQ(bit_count(3, 0), 38U);
    EXPECT_EQ(bit_count(4, 0), 47U);
    EXPECT_EQ(bit_count(6, 0), 65U);
    EXPECT_EQ(bit_count(93, 0), 848U);
    EXPECT_EQ(bit_count(0, 1), 20U);
    EXPECT_EQ(bit_count(0, 0), 11U);
}

TEST(TransferTime, limit_is_three_times_nominal_and_a_millisecond) {
    std::array<std::uint8_t, 2> index{};
    std::array<std::uint8_t, 17> block{};
    EXPECT_EQ(time_limit({0x29, index, block}, 400'000), Microseconds(2'440));
    EXPECT_EQ(time_limit({0x29, index, block}, 100'000), Microseconds(6'760));
    std::array<std::uint8_t, 93> burst{};
    EXPECT_EQ(time_limit({0x29, burst, {}}, 400'000), Microseconds(7'360));
    EXPECT_EQ(time_limit({0x29, burst, {}}, 10'000), Microseconds(255'400));
}

}  // namespace
}  // namespace octoskin::i2c
