#include "firmware/drivers/vl53l1x/default_configuration.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace octoskin::vl53l1x {
namespace {

// ST ULD 3.5.2, 0x2D first, as one line.
constexpr const char* kStDefault =
    "00 00 00 01 02 00 02 08 00 08 10 01 01 00 00 00 00 FF 00 0F 00 00 00 00 00 20 0B 00 00 02 0A 21 00 00 "
    "05 "
    "00 00 00 00 C8 00 00 38 FF 01 00 08 00 00 01 CC 0F 01 F1 0D 01 68 00 80 08 B8 00 00 00 00 0F 89 00 00 "
    "00 "
    "00 00 00 00 01 0F 0D 0E 0E 00 00 02 C7 FF 9B 00 00 00 01 00 00";

TEST(DefaultConfiguration, is_st_byte_by_byte) {
    std::istringstream bytes(kStDefault);
    unsigned expected = 0;
    unsigned index = 0x2D;
    for (; bytes >> std::hex >> expected; ++index) {
        EXPECT_EQ(default_configuration(static_cast<reg::Index>(index),
                                        {.is_io_2v8 = false, .is_interrupt_active_low = false}),
                  expected)
            << std::hex << index;
    }
    EXPECT_EQ(index, 0x88U);
}

TEST(DefaultConfiguration, differs_from_st_in_three_bytes_on_our_boards) {
    for (unsigned index = 0x2D; index <= 0x87; ++index) {
        const auto at = static_cast<reg::Index>(index);
        const auto ours = default_configuration(at, {.is_io_2v8 = true, .is_interrupt_active_low = true});
        if (index == 0x2E || index == 0x2F) {
            EXPECT_EQ(ours, 0x01);
        } else if (index == 0x30) {
            EXPECT_EQ(ours, 0x11);
        } else {
            EXPECT_EQ(ours, kDefaultConfiguration[index - 0x2D]);
        }
    }
}

TEST(DefaultConfiguration, does_not_start_ranging) {
    EXPECT_EQ(default_configuration(0x87, {}), 0x00);
}

}  // namespace
}  // namespace octoskin::vl53l1x
