#include "hw/image/option_bytes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace octoskin::image {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

constexpr std::uint32_t kFactory = 0xFFEF'F8AA;  // RM0440: the value that ST programs
constexpr std::uint32_t kWanted = 0xFBEF'FCAA;   // the same with BOR_LEV 4 and nSWBOOT0 0

TEST(OptionBytes, a_board_from_the_factory_lacks_two) {
    EXPECT_THAT(option_byte_faults(kFactory),
                ElementsAre(StartsWith("BOR_LEV is 0, not 4: "), StartsWith("nSWBOOT0 is 1, not 0: ")));
    EXPECT_THAT(option_byte_faults(kWanted), IsEmpty());
}

TEST(OptionBytes, writing_them_mends_what_may_be_written_and_leaves_the_rest) {
    const MaskedWord wanted = wanted_option_bytes();
    EXPECT_EQ(wanted.mask, 0x0C10'0700U);   // BOR_LEV 10:8, BFB2 20, nSWBOOT0 26, nBOOT0 27
    EXPECT_EQ(wanted.value, 0x0800'0400U);  // 4, 0, 0, 1
    EXPECT_EQ((kFactory & ~wanted.mask) | wanted.value, kWanted);
    EXPECT_EQ(wanted.mask & 0xFFU, 0U) << "the read protection must never be written";
}

TEST(OptionBytes, each_bit_of_a_field_matters_and_no_other) {
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        const bool is_ours =
            bit == 8 || bit == 9 || bit == 10 || bit == 20 || bit == 22 || bit == 26 || bit == 27;
        EXPECT_EQ(option_byte_faults(kWanted ^ (1U << bit)).size(), is_ours ? 1U : 0U) << "bit " << bit;
    }
}

TEST(OptionBytes, only_level_0_lets_itself_be_programmed) {
    for (std::uint32_t level = 0; level < 256; ++level)
        EXPECT_EQ(is_read_protected((kWanted & ~0xFFU) | level), level != 0xAA);
}

}  // namespace
}  // namespace octoskin::image
