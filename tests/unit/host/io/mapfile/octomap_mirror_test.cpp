// Oracle: a whole export of the same map, node for node, by OctoMap's own writer.
#include "host/io/mapfile/octomap_mirror.hpp"
#include "tests/support/evidence.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "host/io/mapfile/octomap_tree.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

std::string ot_of(const octomap::OcTree& tree) {
    std::ostringstream bytes;
    EXPECT_TRUE(tree.write(bytes));
    return bytes.str();
}

/// Of a copy, which OctoMap then prunes to what a .bt keeps.
std::string bt_of(const octomap::OcTree& tree) {
    octomap::OcTree copy(tree);
    std::ostringstream bytes;
    EXPECT_TRUE(copy.writeBinary(bytes));
    return bytes.str();
}

/// A node's log-odds, or that there is none.
std::string found(const octomap::OcTree& tree, const octomap::OcTreeKey& key, unsigned depth) {
    const octomap::OcTreeNode* const node = tree.search(key, depth);
    return node == nullptr ? "none" : std::to_string(node->getLogOdds());
}

/// Keys within two voxels of known ones, and some of anywhere.
std::vector<octomap::OcTreeKey> keys_about(const FusedMap& map, std::mt19937& random) {
    std::vector<octomap::OcTreeKey> keys;
    std::uniform_int_distribution<unsigned> anywhere(0, 65535);
    std::uniform_int_distribution<int> off(-2, 2);
    const std::size_t every = map.known_voxels() / 30 + 1;
    std::size_t count = 0;
    map.for_each_known([&](VoxelKey key, float) {
        if (count++ % every != 0) return;
        const auto axis = [&](std::uint16_t k) { return static_cast<std::uint16_t>(k + off(random)); };
        keys.emplace_back(axis(key.x), axis(key.y), axis(key.z));
    });
    for (int i = 0; i < 5; ++i) {
        const auto axis = [&] { return static_cast<std::uint16_t>(anywhere(random)); };
        keys.emplace_back(axis(), axis(), axis());
    }
    return keys;
}

void expect_exports_alike(const octomap::OcTree& tree, const FusedMap& map, std::mt19937& random) {
    const auto whole = to_octomap(map);
    const std::string ot = ot_of(tree);
    // Both from the line on that octoskin's header has more than OctoMap's.
    const std::string ours = encode_ot(map);
    EXPECT_TRUE(ot.substr(ot.find("\nid ")) == ours.substr(ours.find("\nid ")));
    EXPECT_TRUE(ot == ot_of(*whole));
    EXPECT_TRUE(bt_of(tree) == bt_of(*whole));
    EXPECT_TRUE(tree == *whole) << "OctoMap's own comparison";
    EXPECT_EQ(tree.size(), whole->size());
    EXPECT_EQ(tree.calcNumNodes(), tree.size());
    EXPECT_EQ(tree.getNumLeafNodes(), whole->getNumLeafNodes());
    EXPECT_EQ(tree.memoryUsage(), whole->memoryUsage());
    EXPECT_EQ(tree.getOccupancyThresLog(), whole->getOccupancyThresLog());
    EXPECT_EQ(tree.getClampingThresMinLog(), whole->getClampingThresMinLog());
    EXPECT_EQ(tree.getClampingThresMaxLog(), whole->getClampingThresMaxLog());
    for (const octomap::OcTreeKey& key : keys_about(map, random)) {
        for (unsigned depth = 0; depth <= tree.getTreeDepth(); ++depth)
            EXPECT_EQ(found(tree, key, depth), found(*whole, key, depth)) << "depth " << depth;
    }
}

/// Near the origin, where the octree's eight largest cubes meet, so that cubes often meet and prune each
/// other.
class RandomChanges {
  public:
    explicit RandomChanges(unsigned seed) : random_(seed) {}

    void change(FusedMap& map) {
        switch (below(8)) {
            case 0:
                return some_voxels(map);
            case 1:
                return set_cube(map, below(3));
            case 2:
                return set_cube(map, 3);
            case 3:
                return set_cube(map, 3 + below(3));
            case 4:
                return eight_bricks(map);
            case 5:
                return saturate(map);
            case 6:
                return limit(map);
            default:
                return replace(map);
        }
    }
    [[nodiscard]] unsigned below(unsigned end) { return static_cast<unsigned>(random_() % end); }
    [[nodiscard]] std::mt19937& random() { return random_; }

  private:
    [[nodiscard]] std::uint16_t axis(unsigned height) {
        const unsigned at = 32768U - 48U + below(96);
        return static_cast<std::uint16_t>(at >> height << height);
    }
    [[nodiscard]] VoxelKey place(unsigned height) { return {axis(height), axis(height), axis(height)}; }
    /// Few values: equal neighbours must be common.
    [[nodiscard]] float value() {
        constexpr float kValues[] = {-2.0F, -0.5F, 0.5F, 3.5F};
        return kValues[below(4)];
    }
    void some_voxels(FusedMap& map) {
        std::vector<VoxelUpdate> updates;
        for (unsigned i = 1 + below(60); i-- > 0;) updates.push_back({place(0), value()});
        feed(map, updates);
    }
    void set_cube(FusedMap& map, unsigned height) {
        ASSERT_TRUE(map.set_cube({place(height), height}, value()));
    }
    /// A cube of sixteen voxels' edge in another order than the tree's, and perhaps one voxel that differs.
    void eight_bricks(FusedMap& map) {
        const VoxelKey lowest = place(4);
        const float log_odds = value();
        for (unsigned i = 8; i-- > 0;) {
            const auto part = [i](std::uint16_t k, unsigned axis) {
                return static_cast<std::uint16_t>(k + 8 * (i >> axis & 1U));
            };
            const VoxelKey brick{part(lowest.x, 0), part(lowest.y, 1), part(lowest.z, 2)};
            ASSERT_TRUE(map.set_cube({brick, 3}, log_odds));
        }
        if (below(2) == 0) feed(map, std::vector<VoxelUpdate>{{lowest, value()}});
    }
    /// Voxel by voxel to a clamp: bricks that keep a value for each voxel although they are alike.
    void saturate(FusedMap& map) {
        const MortonCode first = morton_of(place(3));
        const float term = below(2) == 0 ? 20.0F : -20.0F;
        std::vector<VoxelUpdate> updates;
        for (MortonCode voxel = first; voxel < first + kBrickVoxels; ++voxel)
            updates.push_back({key_of_morton(voxel), term});
        feed(map, updates);
    }
    void limit(FusedMap& map) {
        MapConfig config = map.config();
        config.log_odds_occupied = 0.25F * static_cast<float>(below(3));
        if (below(2) == 0) config.log_odds_min = -1.0F - 0.5F * static_cast<float>(below(4));
        if (below(2) == 0) config.log_odds_max = 2.0F + 0.5F * static_cast<float>(below(4));
        map.limit(config);
    }
    void replace(FusedMap& map) {
        constexpr unsigned kEveryLoad = 3;
        if (below(kEveryLoad) != 0) return;
        map = below(4) == 0 ? FusedMap(map.config()) : samples::random_map(below(50));
    }

    std::mt19937 random_;
};

TEST(OctomapMirror, shows_what_a_whole_export_would_after_every_change) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        RandomChanges changes(seed);
        FusedMap map(MapConfig{});
        OctomapMirror mirror(map.config());
        for (int step = 0; step < 30; ++step) {
            for (unsigned i = 1 + changes.below(4); i-- > 0;) changes.change(map);
            (void)mirror.update(map);
            expect_exports_alike(mirror.tree(), map, changes.random());
            ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed << ", step " << step;
        }
    }
}

TEST(OctomapMirror, follows_to_maps_that_have_nothing_in_common_with_the_last) {
    std::mt19937 random(1);
    OctomapMirror mirror(MapConfig{});
    std::vector<FusedMap> maps;
    for (unsigned seed = 1; seed <= 2; ++seed) maps.push_back(samples::far_map(seed));
    maps.push_back(samples::small_map());
    maps.emplace_back(MapConfig{});
    maps.push_back(samples::random_map(1));
    for (const FusedMap& map : maps) {
        (void)mirror.update(map);
        expect_exports_alike(mirror.tree(), map, random);
    }
}

TEST(OctomapMirror, goes_back_to_an_older_copy) {
    std::mt19937 random(1);
    FusedMap map = samples::random_map(2);
    const FusedMap older = map.copy();
    feed(map, std::vector<VoxelUpdate>{{samples::key(500, -500, 3), 1.0F}, {samples::key(0, 0, 0), 1.0F}});
    OctomapMirror mirror(map.config());
    (void)mirror.update(map);
    EXPECT_EQ(mirror.update(older), 2U);
    expect_exports_alike(mirror.tree(), older, random);
}

TEST(OctomapMirror, looks_at_no_brick_that_was_not_written) {
    FusedMap map = samples::random_map(4);
    OctomapMirror mirror(map.config());
    EXPECT_EQ(mirror.update(map), map.bricks().size());
    EXPECT_EQ(mirror.update(map), 0U);
    EXPECT_EQ(mirror.update(map.copy()), 0U);
    feed(map, std::vector<VoxelUpdate>{{samples::key(100, 0, 0), 0.5F}, {samples::key(101, 0, 0), 0.5F}});
    EXPECT_EQ(mirror.update(map), 1U);
    MapConfig config = map.config();
    config.log_odds_occupied = 0.7F;
    map.limit(config);
    EXPECT_EQ(mirror.update(map), 0U);
    EXPECT_FLOAT_EQ(mirror.tree().getOccupancyThresLog(), 0.7F);
}

TEST(OctomapMirror, leaves_nodes_where_they_are_that_a_change_is_not_below) {
    FusedMap map(MapConfig{});
    const auto at = [](int x) { return samples::key(x, 0, 0); };
    feed(map, std::vector<VoxelUpdate>{{at(0), 0.5F}, {at(2), 0.5F}, {at(64), 0.5F}});
    OctomapMirror mirror(map.config());
    (void)mirror.update(map);
    const auto node = [&](VoxelKey key) { return mirror.tree().search(oracle::key_of(key)); };
    const octomap::OcTreeNode* const same_brick = node(at(0));
    const octomap::OcTreeNode* const other_brick = node(at(64));
    feed(map, std::vector<VoxelUpdate>{{at(2), 0.25F}, {at(3), 0.25F}});
    (void)mirror.update(map);
    EXPECT_EQ(node(at(0)), same_brick);
    EXPECT_EQ(node(at(64)), other_brick);
    EXPECT_EQ(node(at(2))->getLogOdds(), 0.75F);
}

TEST(OctomapMirror, prunes_upwards_what_comes_to_be_one_value_and_opens_it_again) {
    FusedMap map(MapConfig{});
    OctomapMirror mirror(map.config());
    const std::uint16_t zero = samples::kZero;
    for (unsigned brick = 0; brick < 8; ++brick) {
        const MortonCode first = morton_of({zero, zero, zero}) + brick * kBrickVoxels;
        ASSERT_TRUE(map.set_cube({key_of_morton(first), 3}, 1.0F));
        (void)mirror.update(map);
        // The root and eleven inner nodes down to the cube of 16 voxels' edge, and the bricks below it.
        EXPECT_EQ(mirror.tree().size(), brick < 7 ? 13U + brick + 1 : 13U);
    }
    feed(map, std::vector<VoxelUpdate>{{{zero, zero, zero}, 0.5F}});
    (void)mirror.update(map);
    EXPECT_EQ(mirror.tree().size(), 13U + 4 * 8);
    EXPECT_EQ(mirror.tree().getRoot()->getLogOdds(), 1.5F);
    (void)mirror.update(FusedMap(MapConfig{}));
    EXPECT_EQ(mirror.tree().size(), 0U);
    EXPECT_EQ(mirror.tree().getRoot(), nullptr);
}

}  // namespace
}  // namespace octoskin
