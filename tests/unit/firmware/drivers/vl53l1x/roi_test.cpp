// The oracle is UM2555's drawing of the SPAD array, copied number by number.
#include "firmware/drivers/vl53l1x/roi.hpp"

#include <gtest/gtest.h>

#include <set>

namespace octoskin::vl53l1x {
namespace {

// clang-format off
constexpr int kDrawing[16][16] = {
    {128, 136, 144, 152, 160, 168, 176, 184, 192, 200, 208, 216, 224, 232, 240, 248},
    {129, 137, 145, 153, 161, 169, 177, 185, 193, 201, 209, 217, 225, 233, 241, 249},
    {130, 138, 146, 154, 162, 170, 178, 186, 194, 202, 210, 218, 226, 234, 242, 250},
    {131, 139, 147, 155, 163, 171, 179, 187, 195, 203, 211, 219, 227, 235, 243, 251},
    {132, 140, 148, 156, 164, 172, 180, 188, 196, 204, 212, 220, 228, 236, 244, 252},
    {133, 141, 149, 157, 165, 173, 181, 189, 197, 205, 213, 221, 229, 237, 245, 253},
    {134, 142, 150, 158, 166, 174, 182, 190, 198, 206, 214, 222, 230, 238, 246, 254},
    {135, 143, 151, 159, 167, 175, 183, 191, 199, 207, 215, 223, 231, 239, 247, 255},
    {127, 119, 111, 103,  95,  87,  79,  71,  63,  55,  47,  39,  31,  23,  15,   7},
    {126, 118, 110, 102,  94,  86,  78,  70,  62,  54,  46,  38,  30,  22,  14,   6},
    {125, 117, 109, 101,  93,  85,  77,  69,  61,  53,  45,  37,  29,  21,  13,   5},
    {124, 116, 108, 100,  92,  84,  76,  68,  60,  52,  44,  36,  28,  20,  12,   4},
    {123, 115, 107,  99,  91,  83,  75,  67,  59,  51,  43,  35,  27,  19,  11,   3},
    {122, 114, 106,  98,  90,  82,  74,  66,  58,  50,  42,  34,  26,  18,  10,   2},
    {121, 113, 105,  97,  89,  81,  73,  65,  57,  49,  41,  33,  25,  17,   9,   1},
    {120, 112, 104,  96,  88,  80,  72,  64,  56,  48,  40,  32,  24,  16,   8,   0}};
// clang-format on

TEST(SpadMap, equals_the_drawing_for_all_256) {
    for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 16; ++column) {
            const auto number = static_cast<std::uint8_t>(kDrawing[row][column]);
            EXPECT_EQ(spad_number({row, column}), number);
            EXPECT_EQ(spad_position(number), (SpadPosition{row, column}));
        }
    }
}

TEST(RegionOfInterest, covers_all_around_spad_199) {
    EXPECT_EQ(covered_area({.centre_spad = 199, .width = 16, .height = 16}),
              (SpadArea{.first = {0, 0}, .last = {15, 15}}));
}

// 199 is at row 7, column 8: right of and above the array's middle.
TEST(RegionOfInterest, centre_of_an_even_side_is_right_of_and_above_its_middle) {
    EXPECT_EQ(covered_area({.centre_spad = 199, .width = 4, .height = 4}),
              (SpadArea{.first = {6, 6}, .last = {9, 9}}));
    EXPECT_EQ(covered_area({.centre_spad = 199, .width = 5, .height = 5}),
              (SpadArea{.first = {5, 6}, .last = {9, 10}}));
    EXPECT_EQ(covered_area({.centre_spad = 167, .width = 8, .height = 8}),
              (SpadArea{.first = {4, 0}, .last = {11, 7}}));
}

// Brute force: the numbers of all SPADs it covers are on the drawing.
TEST(RegionOfInterest, is_supported_exactly_where_all_of_it_is_on_the_array) {
    for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 16; ++column) {
            for (int width = 0; width <= 17; ++width) {
                for (int height = 0; height <= 17; ++height) {
                    const int left = column - width / 2;
                    const int bottom = row + height / 2;
                    int inside = 0;
                    for (int r = 0; r < 16; ++r) {
                        for (int c = 0; c < 16; ++c) {
                            inside +=
                                r <= bottom && r > bottom - height && c >= left && c < left + width ? 1 : 0;
                        }
                    }
                    const bool has_sides = width >= 4 && width <= 16 && height >= 4 && height <= 16;
                    const Roi roi{.centre_spad = static_cast<std::uint8_t>(kDrawing[row][column]),
                                  .width = static_cast<std::uint8_t>(width),
                                  .height = static_cast<std::uint8_t>(height)};
                    ASSERT_EQ(is_supported(roi), has_sides && inside == width * height)
                        << row << ' ' << column << ' ' << width << 'x' << height;
                }
            }
        }
    }
}

TEST(RegionOfInterest, size_is_one_nibble_a_side) {
    EXPECT_EQ(size_register({.width = 16, .height = 16}), 0xFF);
    EXPECT_EQ(size_register({.width = 8, .height = 8}), 0x77);
    EXPECT_EQ(size_register({.width = 4, .height = 10}), 0x93);
}

}  // namespace
}  // namespace octoskin::vl53l1x
