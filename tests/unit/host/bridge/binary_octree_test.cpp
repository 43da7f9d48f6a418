// The binary octree of a map that changes is the one of a map that was always so.
#include "host/bridge/published/binary_octree.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/octomap_writer.hpp"

namespace octoskin::bridge {
namespace {

std::string of_file(const FusedMap& map) {
    const std::string file = encode_bt(map);
    return file.substr(file.find("\ndata\n") + 6);
}

std::string text_of(const BinaryOctree& octree) {
    return {octree.data().begin(), octree.data().end()};
}

/// A tree with the threshold of this map's configuration.
FusedMap map_of(const BrickTree& tree, const MapConfig& config) {
    return {config, {.log_odds = tree, .counts = {}, .ages = {}, .known_voxels = 0}, false};
}

class Changes {
  public:
    /// Single voxels, whole bricks, and bricks that are forgotten, in a block of 64 of them and one far away.
    void change(BrickTree& tree) {
        const MortonCode brick =
            random_() % 20 == 0 ? MortonCode{kBrickVoxels} << 24U : MortonCode{random_() % 64} * kBrickVoxels;
        switch (random_() % 6) {
            case 0:
                return tree.set_all(brick, random_() % 2 == 0 ? 1.0F : -1.0F);
            case 1:
                return tree.forget(brick);
            case 2:
                return fill(tree.open(brick), random_() % 2 == 0 ? 1.0F : -1.0F);
            default:
                tree.open(brick)[random_() % kBrickVoxels] = random_() % 2 == 0 ? 1.0F : -0.5F;
        }
    }

  private:
    /// All of them, or the cells of one node of 64.
    void fill(BrickValues& values, float value) {
        const std::size_t first = random_() % 9 * 64;
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
            if (first == kBrickVoxels || cell / 64 == first / 64) values[cell] = value;
    }
    std::mt19937 random_{7};
};

TEST(BinaryOctree, of_a_changed_map_has_the_bytes_of_its_file) {
    Changes changes;
    BrickTree tree;
    BinaryOctree octree;
    const MapConfig config;
    for (int round = 0; round < 2000; ++round) {
        for (int i = 0; i < round % 5; ++i) changes.change(tree);
        octree.update(tree, config.log_odds_occupied);
        ASSERT_EQ(text_of(octree), of_file(map_of(tree, config))) << round;
    }
}

TEST(BinaryOctree, is_pruned_beyond_bricks) {
    BrickTree tree;
    BinaryOctree octree;
    for (MortonCode brick = 0; brick < 64; ++brick) tree.set_all(brick * kBrickVoxels, 1.0F);
    octree.update(tree, 0.0F);
    EXPECT_EQ(octree.data().size(), 2U * 11) << "the nodes above the cube of 64 bricks";
    EXPECT_EQ(text_of(octree), of_file(map_of(tree, {})));
}

TEST(BinaryOctree, follows_the_threshold_and_another_map) {
    BrickTree tree;
    tree.open(0)[0] = 0.5F;
    tree.open(0)[1] = 1.5F;
    BinaryOctree octree;
    for (const float threshold : {0.0F, 1.0F, 2.0F}) {
        octree.update(tree, threshold);
        EXPECT_EQ(text_of(octree), of_file(map_of(tree, {.log_odds_occupied = threshold})));
    }
    BrickTree other;
    other.set_all(kBrickVoxels, -1.0F);
    octree.update(other, 2.0F);
    EXPECT_EQ(text_of(octree), of_file(map_of(other, {.log_odds_occupied = 2.0F})));
    octree.update({}, 2.0F);
    EXPECT_TRUE(octree.data().empty());
}

}  // namespace
}  // namespace octoskin::bridge
