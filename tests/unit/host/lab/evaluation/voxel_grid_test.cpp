#include "host/lab/evaluation/voxel_grid.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

/// Oracle: the definition, voxel by voxel.
VoxelMask dilated_by_definition(const VoxelMask& mask, int reach) {
    VoxelMask grown(mask.box());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const VoxelKey a = mask.box().key_at(i);
        for (std::size_t j = 0; j < mask.size(); ++j) {
            const VoxelKey b = mask.box().key_at(j);
            if (mask[j] != 0 && std::abs(a.x - b.x) <= reach && std::abs(a.y - b.y) <= reach &&
                std::abs(a.z - b.z) <= reach) {
                grown[i] = 1;
            }
        }
    }
    return grown;
}

TEST(KeyBox, numbers_its_voxels_with_x_running_fastest) {
    const KeyBox box{key(-1, 0, 2), key(1, 1, 3)};
    EXPECT_EQ(box.size(), 12U);
    EXPECT_EQ(box.index_of(key(-1, 0, 2)), 0U);
    EXPECT_EQ(box.index_of(key(0, 0, 2)), 1U);
    EXPECT_EQ(box.index_of(key(-1, 1, 2)), 3U);
    EXPECT_EQ(box.index_of(key(-1, 0, 3)), 6U);
    EXPECT_EQ(box.index_of(key(1, 1, 3)), 11U);
}

TEST(KeyBox, gives_every_number_back_its_key) {
    const KeyBox box{key(-2, -1, 0), key(1, 3, 2)};
    for (std::size_t i = 0; i < box.size(); ++i) {
        ASSERT_TRUE(box.contains(box.key_at(i)));
        ASSERT_EQ(box.index_of(box.key_at(i)), i);
    }
}

TEST(KeyBox, contains_both_corners_and_nothing_beyond) {
    const KeyBox box{key(0, 0, 0), key(2, 2, 2)};
    EXPECT_TRUE(box.contains(key(0, 0, 0)));
    EXPECT_TRUE(box.contains(key(2, 2, 2)));
    EXPECT_FALSE(box.contains(key(-1, 0, 0)));
    EXPECT_FALSE(box.contains(key(3, 0, 0)));
    EXPECT_FALSE(box.contains(key(0, 3, 0)));
    EXPECT_FALSE(box.contains(key(0, 0, -1)));
}

TEST(KeyBox, padding_stops_where_the_keys_end) {
    const KeyBox box{{1, 5, 65534}, {2, 6, 65535}};
    EXPECT_EQ(box.padded(3), (KeyBox{{0, 2, 65531}, {5, 9, 65535}}));
}

TEST(Dilated, reaches_over_faces_edges_and_corners) {
    VoxelMask mask(KeyBox{key(0, 0, 0), key(4, 4, 4)});
    mask.at(key(2, 2, 2)) = 1;
    const VoxelMask grown = dilated(mask, 1);
    int set = 0;
    for (std::size_t i = 0; i < grown.size(); ++i) {
        set += grown[i];
    }
    EXPECT_EQ(set, 27);
    EXPECT_EQ(grown.at(key(1, 1, 1)), 1);
    EXPECT_EQ(grown.at(key(3, 3, 3)), 1);
    EXPECT_EQ(grown.at(key(0, 2, 2)), 0);
}

TEST(Dilated, equals_the_definition_on_random_masks) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        const KeyBox box{key(0, 0, 0), key(static_cast<int>(random() % 7), static_cast<int>(random() % 6),
                                           static_cast<int>(random() % 5))};
        VoxelMask mask(box);
        for (std::size_t i = 0; i < mask.size(); ++i) {
            mask[i] = random() % 9 == 0 ? 1 : 0;
        }
        for (std::uint16_t reach = 0; reach < 4; ++reach) {
            const VoxelMask grown = dilated(mask, reach);
            const VoxelMask expected = dilated_by_definition(mask, reach);
            for (std::size_t i = 0; i < mask.size(); ++i) {
                ASSERT_EQ(grown[i], expected[i]) << "seed " << seed << " reach " << reach << " voxel " << i;
            }
        }
    }
}

}  // namespace
}  // namespace octoskin::evaluation
