#include "host/core/voxels/voxel_lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "host/core/voxels/morton.hpp"
#include "tests/support/octomap_oracle.hpp"

namespace octoskin {
namespace {

TEST(VoxelLattice, puts_the_origin_into_key_32768) {
    const VoxelLattice lattice(0.04);
    EXPECT_EQ(lattice.key_of(0.0), 32768);
    EXPECT_EQ(lattice.key_of(0.039), 32768);
    EXPECT_EQ(lattice.key_of(0.041), 32769);
    EXPECT_EQ(lattice.key_of(-0.001), 32767);
    EXPECT_EQ(lattice.key_of(-0.0), 32768);
}

TEST(VoxelLattice, has_no_key_for_what_is_not_finite_or_outside) {
    const VoxelLattice lattice(0.5);
    EXPECT_EQ(lattice.key_of(-16384.0), 0);
    EXPECT_EQ(lattice.key_of(16383.99), 65535);
    for (const double outside :
         {16384.0, -16384.001, 1e9, -1e9, 1e30, -1e300, std::numeric_limits<double>::quiet_NaN(),
          std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
        EXPECT_FALSE(lattice.key_of(outside).has_value()) << outside;
        EXPECT_FALSE(lattice.key_of(Eigen::Vector3d(0.0, outside, 0.0)).has_value()) << outside;
    }
}

TEST(VoxelLattice, centres_lie_half_an_edge_above_the_lower_face) {
    const VoxelLattice lattice(0.04);
    EXPECT_DOUBLE_EQ(lattice.centre_of(std::uint16_t{32768}), 0.02);
    EXPECT_DOUBLE_EQ(lattice.centre_of(std::uint16_t{32767}), -0.02);
    EXPECT_DOUBLE_EQ(lattice.centre_of(VoxelKey{32793, 32768, 0}).x(), 1.02);
    EXPECT_DOUBLE_EQ(lattice.centre_of(VoxelKey{32793, 32768, 0}).z(), -1310.70);
}

// Oracle: OctoMap's coordToKeyChecked and keyToCoord, also for coordinates right at faces.
TEST(VoxelLattice, agrees_with_octomap_on_keys_and_centres) {
    constexpr unsigned kSeed = 7;
    std::mt19937 random(kSeed);
    for (const double resolution : {0.04, 0.02, 0.05, 0.1, 0.3}) {
        const VoxelLattice lattice(resolution);
        const octomap::OcTree tree(resolution);
        std::uniform_int_distribution<int> any_face(-32768, 32768);
        std::uniform_int_distribution<int> any_nudge(-2, 2);
        for (int i = 0; i < 20'000; ++i) {
            double coordinate = any_face(random) * resolution;
            for (int nudge = any_nudge(random); nudge != 0; nudge -= nudge > 0 ? 1 : -1) {
                coordinate = std::nextafter(coordinate, nudge * 1e9);
            }
            octomap::key_type expected = 0;
            const bool has_key = tree.coordToKeyChecked(coordinate, expected);
            const auto key = lattice.key_of(coordinate);
            ASSERT_EQ(key.has_value(), has_key) << "seed " << kSeed << ", coordinate " << coordinate;
            if (!has_key) continue;
            ASSERT_EQ(*key, expected) << "seed " << kSeed << ", coordinate " << coordinate;
            ASSERT_EQ(lattice.centre_of(*key), tree.keyToCoord(expected));
        }
    }
}

TEST(MortonCode, interleaves_x_lowest_and_back) {
    EXPECT_EQ(morton_of({1, 0, 0}), 1U);
    EXPECT_EQ(morton_of({0, 1, 0}), 2U);
    EXPECT_EQ(morton_of({0, 0, 1}), 4U);
    EXPECT_EQ(morton_of({65535, 65535, 65535}), (1ULL << 48U) - 1U);
    for (unsigned value = 0; value < 65536; ++value) {
        const auto key = static_cast<std::uint16_t>(value);
        MortonCode expected = 0;
        for (unsigned bit = 0; bit < 16; ++bit) expected |= MortonCode{(value >> bit) & 1U} << (3 * bit);
        ASSERT_EQ(spread_bits(key), expected);
        ASSERT_EQ(key_of_morton(morton_of({key, 4711, 815})), (VoxelKey{key, 4711, 815}));
    }
}

}  // namespace
}  // namespace octoskin
