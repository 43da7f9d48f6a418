// Zones on the SPAD array. Oracle: the table of SPAD numbers as UM2555 rev 2 prints it.
#include "hw/rigfile/zone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace octoskin::rig {
namespace {

constexpr int kSpads[16][16] = {
    {128, 136, 144, 152, 160, 168, 176, 184, 192, 200, 208, 216, 224, 232, 240, 248},
    {129, 137, 145, 153, 161, 169, 177, 185, 193, 201, 209, 217, 225, 233, 241, 249},
    {130, 138, 146, 154, 162, 170, 178, 186, 194, 202, 210, 218, 226, 234, 242, 250},
    {131, 139, 147, 155, 163, 171, 179, 187, 195, 203, 211, 219, 227, 235, 243, 251},
    {132, 140, 148, 156, 164, 172, 180, 188, 196, 204, 212, 220, 228, 236, 244, 252},
    {133, 141, 149, 157, 165, 173, 181, 189, 197, 205, 213, 221, 229, 237, 245, 253},
    {134, 142, 150, 158, 166, 174, 182, 190, 198, 206, 214, 222, 230, 238, 246, 254},
    {135, 143, 151, 159, 167, 175, 183, 191, 199, 207, 215, 223, 231, 239, 247, 255},
    {127, 119, 111, 103, 95, 87, 79, 71, 63, 55, 47, 39, 31, 23, 15, 7},
    {126, 118, 110, 102, 94, 86, 78, 70, 62, 54, 46, 38, 30, 22, 14, 6},
    {125, 117, 109, 101, 93, 85, 77, 69, 61, 53, 45, 37, 29, 21, 13, 5},
    {124, 116, 108, 100, 92, 84, 76, 68, 60, 52, 44, 36, 28, 20, 12, 4},
    {123, 115, 107, 99, 91, 83, 75, 67, 59, 51, 43, 35, 27, 19, 11, 3},
    {122, 114, 106, 98, 90, 82, 74, 66, 58, 50, 42, 34, 26, 18, 10, 2},
    {121, 113, 105, 97, 89, 81, 73, 65, 57, 49, 41, 33, 25, 17, 9, 1},
    {120, 112, 104, 96, 88, 80, 72, 64, 56, 48, 40, 32, 24, 16, 8, 0},
};

TEST(Zone, fits_exactly_if_all_its_spads_are_on_the_array) {
    for (int row = 0; row < 16; ++row) {
        for (int column = 0; column < 16; ++column) {
            for (int size = 4; size <= 16; ++size) {
                // Of an even side, one more SPAD lies left of, and one more below, the centre.
                const int right = column + (size - 1) / 2;
                const int left = right - size + 1;
                const int bottom = row + size / 2;
                const int top = bottom - size + 1;
                const auto centre = static_cast<std::uint8_t>(kSpads[row][column]);
                const auto side = static_cast<std::uint8_t>(size);
                EXPECT_EQ(fits_on_array({centre, side, 4}),
                          left >= 0 && right <= 15 && row - 1 >= 0 && row + 2 <= 15)
                    << "SPAD " << kSpads[row][column] << ", " << size << " wide";
                EXPECT_EQ(fits_on_array({centre, 4, side}),
                          top >= 0 && bottom <= 15 && column - 2 >= 0 && column + 1 <= 15)
                    << "SPAD " << kSpads[row][column] << ", " << size << " high";
            }
        }
    }
}

TEST(Zone, whole_array_looks_straight_ahead) {
    EXPECT_EQ(zone_direction({199, 16, 16}), Eigen::Vector3d::UnitZ());
}

TEST(Zone, four_quadrants_look_to_the_opposite_corners_at_4_spads) {
    // 27 degrees over the diagonal of 16 x 16: 1.193 degrees a SPAD; a quadrant's middle is 4 SPADs off each
    // way.
    const double tangent = std::tan(4.0 * 27.0 / (16.0 * std::sqrt(2.0)) * std::numbers::pi / 180.0);
    struct Quadrant {
        std::uint8_t centre;
        double x;
        double y;
    };
    for (const auto& [centre, x, y] :
         {Quadrant{163, +1, -1}, Quadrant{227, -1, -1}, Quadrant{92, +1, +1}, Quadrant{28, -1, +1}}) {
        const Eigen::Vector3d expected = Eigen::Vector3d(x * tangent, y * tangent, 1.0).normalized();
        EXPECT_LT((zone_direction({centre, 8, 8}) - expected).norm(), 1e-12) << int{centre};
    }
}

TEST(Zone, spans_the_angles_of_its_spads_on_the_other_side) {
    const double spad = 27.0 / (16.0 * std::numbers::sqrt2) * std::numbers::pi / 180.0;
    EXPECT_NEAR(zone_span_x(Roi{}).max_rad, 8 * spad, 1e-15);
    EXPECT_NEAR(zone_span_y(Roi{}).min_rad, -8 * spad, 1e-15);
    // Columns 12..15 and rows 10..12.
    const Roi roi{.centre_spad = static_cast<std::uint8_t>(kSpads[11][14]), .width = 4, .height = 3};
    EXPECT_NEAR(zone_span_x(roi).min_rad, -8 * spad, 1e-15);
    EXPECT_NEAR(zone_span_x(roi).max_rad, -4 * spad, 1e-15);
    EXPECT_NEAR(zone_span_y(roi).min_rad, 2 * spad, 1e-15);
    EXPECT_NEAR(zone_span_y(roi).max_rad, 5 * spad, 1e-15);
}

TEST(Zone, direction_is_a_unit_vector_within_the_field_of_view) {
    for (int row = 2; row < 14; ++row) {
        for (int column = 2; column < 15; ++column) {
            const auto direction = zone_direction({static_cast<std::uint8_t>(kSpads[row][column]), 4, 4});
            EXPECT_NEAR(direction.norm(), 1.0, 1e-15);
            EXPECT_GT(direction.z(), std::cos(13.5 * std::numbers::pi / 180.0));
        }
    }
}

}  // namespace
}  // namespace octoskin::rig
