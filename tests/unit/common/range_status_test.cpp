#include "common/range_status.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>

namespace octoskin {
namespace {

// Oracle: ST's user statuses for all device codes, typed from the status tables of the VL53L1X full API and
// of ULD 3.5.2 (index = device code). Where one of the two says 255, the other one's number stands here.
constexpr std::array<std::uint8_t, 32> kUserStatus = {
    255, 5, 5,  5, 2,   4,   1,  7,  3,   0,   255, 255, 9,   13,  255, 255,  // 0..15
    255, 5, 10, 6, 255, 255, 11, 12, 255, 255, 255, 255, 255, 255, 255, 255,  // 16..31
};

TEST(RangeStatus, of_every_device_code_is_st_s) {
    for (std::uint8_t code = 0; code < 32; ++code) {
        EXPECT_EQ(static_cast<int>(range_status(code).status), kUserStatus[code]) << int{code};
    }
}

TEST(RangeStatus, only_code_9_is_a_hit_and_only_code_4_may_clear) {
    for (std::uint8_t code = 0; code < 32; ++code) {
        const RangeUse expected = code == 9   ? RangeUse::hit
                                  : code == 4 ? RangeUse::no_return
                                              : RangeUse::nothing;
        EXPECT_EQ(range_status(code).use, expected) << int{code};
    }
}

TEST(RangeStatus, constants_name_the_codes_that_matter) {
    EXPECT_EQ(range_status(kDeviceStatusComplete).status, RangeStatus::valid);
    EXPECT_EQ(range_status(kDeviceStatusNoTarget).status, RangeStatus::signal_fail);
    EXPECT_EQ(range_status(kDeviceStatusCompleteNoWrapCheck).status, RangeStatus::valid_no_wrap_check);
}

TEST(RangeStatus, every_text_is_there_and_its_own) {
    for (std::uint8_t code = 0; code < 32; ++code) {
        const std::string_view text = range_status(code).text;
        EXPECT_FALSE(text.empty()) << int{code};
        for (std::uint8_t other = 0; other < code; ++other) {
            EXPECT_NE(text, range_status(other).text) << int{code} << " and " << int{other};
        }
    }
}

TEST(RangeStatusDeathTest, asserts_on_a_code_that_was_not_masked) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_DEATH(static_cast<void>(range_status(32)), "device_code");
    EXPECT_DEATH(static_cast<void>(range_status(9 | 0x20)), "device_code");
}

}  // namespace
}  // namespace octoskin
