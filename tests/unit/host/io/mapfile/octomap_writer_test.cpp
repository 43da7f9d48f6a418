// Oracle: OctoMap's own writer and reader.
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <sstream>
#include <string_view>
#include <vector>

#include "host/io/mapfile/octomap_tree.hpp"
#include "host/io/mapfile/octree.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

/// The same content, put into OctoMap's tree voxel by voxel.
std::unique_ptr<octomap::OcTree> octomaps_tree(const FusedMap& map) {
    auto tree = std::make_unique<oracle::ClampedTree>(map.config());
    map.for_each_known(
        [&](VoxelKey key, float log_odds) { tree->setNodeValue(oracle::key_of(key), log_odds); });
    return tree;
}

/// The same, every voxel at the clamp of its state. OctoMap's own toMaxLikelihood() comes to it too, but its
/// prune() then gives up at the first level without anything to prune, and so may leave the tree larger.
std::unique_ptr<octomap::OcTree> octomaps_max_likelihood_tree(const FusedMap& map) {
    auto tree = std::make_unique<oracle::ClampedTree>(map.config());
    map.for_each_known([&](VoxelKey key, float log_odds) {
        tree->setNodeValue(oracle::key_of(key), log_odds >= 0.0F ? 3.5F : -2.0F);
    });
    return tree;
}

/// Without the only line that is not OctoMap's.
std::string without_comment(std::string file) {
    const std::string comment = "# saved by octoskin\n";
    return file.erase(file.find(comment), comment.size());
}

TEST(OctomapWriter, writes_an_empty_map_as_octomap_does) {
    const FusedMap map(MapConfig{});
    EXPECT_EQ(encode_ot(map),
              "# Octomap OcTree file\n# (feel free to add / change comments, but leave the first line as it "
              "is!)\n# saved by octoskin\n#\n"
              "id OcTree\nsize 0\nres 0.04\ndata\n");
    EXPECT_EQ(encode_bt(map),
              "# Octomap OcTree binary file\n"
              "# (feel free to add / change comments, but leave the first line as it is!)\n"
              "# saved by octoskin\n#\n"
              "id OcTree\nsize 0\nres 0.04\ndata\n");
}

TEST(OctomapWriter, writes_the_bytes_that_octomap_writes) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        const FusedMap map = seed == 0 ? samples::small_map() : samples::random_map(seed);
        const auto tree = octomaps_tree(map);
        std::ostringstream text;
        ASSERT_TRUE(tree->write(text));
        EXPECT_EQ(without_comment(encode_ot(map)), text.str()) << "seed " << seed;
        std::string unmarked;
        write_unmarked_ot(map, [&unmarked](std::string_view bytes) {
            unmarked += bytes;
            return true;
        });
        EXPECT_EQ(unmarked, text.str()) << "seed " << seed;
        std::ostringstream binary;
        ASSERT_TRUE(octomaps_max_likelihood_tree(map)->writeBinary(binary));
        EXPECT_EQ(without_comment(encode_bt(map)), binary.str()) << "seed " << seed;
    }
}

TEST(OctomapWriter, writes_the_bytes_that_octomap_writes_for_a_large_map) {
    for (const unsigned seed : {1U, 2U}) {
        const FusedMap map = samples::far_map(seed);
        ASSERT_GT(map.known_voxels(), 100'000U);
        std::ostringstream text;
        ASSERT_TRUE(octomaps_tree(map)->write(text));
        EXPECT_TRUE(without_comment(encode_ot(map)) == text.str()) << "seed " << seed;
        std::ostringstream binary;
        ASSERT_TRUE(octomaps_max_likelihood_tree(map)->writeBinary(binary));
        EXPECT_TRUE(without_comment(encode_bt(map)) == binary.str()) << "seed " << seed;
    }
}

TEST(OctomapWriter, gives_no_more_pieces_once_the_sink_takes_none) {
    const FusedMap map = samples::far_map(1);
    for (const auto write : {write_ot, write_bt}) {
        for (const int pieces_taken : {0, 1}) {
            int pieces = 0;
            write(map, [&](std::string_view) { return pieces++ < pieces_taken; });
            EXPECT_EQ(pieces, pieces_taken + 1);
        }
    }
}

TEST(OctomapWriter, writes_equal_bytes_for_equal_maps_however_they_were_filled) {
    const FusedMap map = samples::random_map(3);
    std::vector<VoxelUpdate> updates;
    map.for_each_known([&](VoxelKey key, float log_odds) { updates.push_back({key, log_odds}); });
    std::reverse(updates.begin(), updates.end());
    FusedMap backwards(MapConfig{});
    feed(backwards, updates);
    EXPECT_EQ(encode_ot(backwards), encode_ot(map));
    EXPECT_EQ(encode_bt(backwards), encode_bt(map));
    EXPECT_EQ(encode_ot(map), encode_ot(samples::random_map(3)));
}

TEST(OctomapWriter, files_read_back_in_octomap_with_the_same_voxels) {
    const FusedMap map = samples::random_map(5);
    std::istringstream text(encode_ot(map));
    const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(text));
    ASSERT_NE(dynamic_cast<octomap::OcTree*>(tree.get()), nullptr);
    EXPECT_EQ(oracle::voxels_of(dynamic_cast<octomap::OcTree&>(*tree)), oracle::voxels_of(map));

    octomap::OcTree binary_tree(0.1);
    std::istringstream binary(encode_bt(map));
    ASSERT_TRUE(binary_tree.readBinary(binary));
    EXPECT_DOUBLE_EQ(binary_tree.getResolution(), 0.04);
    const auto voxels = oracle::voxels_of(binary_tree);
    EXPECT_EQ(voxels.size(), map.known_voxels());
    for (const auto& [key, log_odds] : voxels) {
        EXPECT_EQ(map.occupancy(key), log_odds > 0.0F ? Occupancy::occupied : Occupancy::free);
    }
}

TEST(OctomapTree, hands_out_octomaps_own_tree_with_the_same_voxels) {
    const FusedMap map = samples::random_map(6);
    const auto tree = to_octomap(map);
    EXPECT_EQ(oracle::voxels_of(*tree), oracle::voxels_of(map));
    EXPECT_EQ(tree->size(), octomaps_tree(map)->size());
    EXPECT_FLOAT_EQ(tree->getClampingThresMinLog(), -2.0F);
    EXPECT_FLOAT_EQ(tree->getClampingThresMaxLog(), 3.5F);
    EXPECT_EQ(to_octomap(FusedMap(MapConfig{}))->size(), 0U);
}

std::vector<OctreeNode> nodes_of(const PrunedOctree& octree) {
    std::vector<OctreeNode> nodes;
    EXPECT_TRUE(octree.for_each([&nodes](std::span<const OctreeNode> more) {
        nodes.insert(nodes.end(), more.begin(), more.end());
        return true;
    }));
    EXPECT_EQ(nodes.size(), octree.size());
    return nodes;
}

TEST(Octree, prunes_eight_equal_leaves_on_every_level) {
    FusedMap map(MapConfig{});
    ASSERT_TRUE(map.set_cube({.lowest = {32768, 32768, 32768}, .height = 4}, 1.0F));
    auto nodes = nodes_of(PrunedOctree(map, LeafValues::exact));
    EXPECT_EQ(nodes.size(), 13U);  // the root, eleven inner nodes and the leaf of 16 voxels' edge
    EXPECT_EQ(nodes.back(), (OctreeNode{1.0F, 0, NodeState::occupied_leaf}));
    feed(map, std::vector<VoxelUpdate>{{{32768, 32768, 32768}, 0.5F}});
    nodes = nodes_of(PrunedOctree(map, LeafValues::exact));
    EXPECT_EQ(nodes.size(), 13U + 4 * 8);  // the path to the voxel opened on four levels
    EXPECT_EQ(nodes.front().log_odds, 1.5F) << "an inner node is as occupied as its most occupied child";
    EXPECT_EQ(nodes_of(PrunedOctree(map, LeafValues::max_likelihood)).size(), 13U);
    EXPECT_TRUE(nodes_of(PrunedOctree(FusedMap(MapConfig{}), LeafValues::exact)).empty());
}

}  // namespace
}  // namespace octoskin
