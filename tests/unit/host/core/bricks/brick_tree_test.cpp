#include "host/core/bricks/brick_tree.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <thread>
#include <vector>

namespace octoskin {
namespace {

MortonCode brick_at(unsigned x, unsigned y, unsigned z) {
    return brick_of({static_cast<std::uint16_t>(8 * x), static_cast<std::uint16_t>(8 * y),
                     static_cast<std::uint16_t>(8 * z)});
}

/// First voxel's value by brick, as a tree tells it by being walked.
std::map<MortonCode, float> contents(const BrickTree& tree) {
    std::map<MortonCode, float> found;
    MortonCode before = 0;
    tree.for_each([&](MortonCode brick, const BrickView& view) {
        EXPECT_TRUE(found.empty() || brick > before) << "Morton order";
        before = brick;
        found[brick] = view.at(0);
    });
    return found;
}

TEST(BrickTree, is_unknown_where_nothing_was_set) {
    BrickTree tree;
    EXPECT_TRUE(tree.find(brick_at(4096, 4096, 4096)).is_unknown());
    tree.set_all(brick_at(4096, 4096, 4096), 1.0F);
    EXPECT_TRUE(tree.find(brick_at(4097, 4096, 4096)).is_unknown());
    EXPECT_TRUE(tree.find(brick_at(0, 0, 0)).is_unknown());
    EXPECT_TRUE(tree.find(brick_at(8191, 8191, 8191)).is_unknown());
    EXPECT_EQ(tree.find(brick_at(4096, 4096, 4096)).at(511), 1.0F);
}

TEST(BrickTree, opens_a_brick_with_what_it_held) {
    BrickTree tree;
    const MortonCode brick = brick_at(1, 2, 3);
    tree.set_all(brick, -2.0F);
    EXPECT_EQ(tree.dense_bricks(), 0U);
    tree.open(brick)[7] = 3.0F;
    EXPECT_EQ(tree.find(brick).at(7), 3.0F);
    EXPECT_EQ(tree.find(brick).at(8), -2.0F);
    EXPECT_EQ(tree.dense_bricks(), 1U);
    EXPECT_EQ(tree.bricks(), 1U);
    tree.set_all(brick, 0.5F);
    EXPECT_EQ(tree.dense_bricks(), 0U);
    EXPECT_EQ(tree.find(brick).at(7), 0.5F);
    BrickTree other;
    EXPECT_TRUE(std::isnan(other.open(brick)[0])) << "unknown before";
}

// Oracle: std::map, and copies of it.
TEST(BrickTree, and_its_copies_each_hold_what_they_were_given) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        std::vector<BrickTree> trees(1);
        std::vector<std::map<MortonCode, float>> truths(1);
        // Near each other about the octree's middle, and far apart.
        const auto draw = [&] {
            const auto near = [&] { return static_cast<unsigned>(4094 + random() % 5); };
            const auto far = [&] { return static_cast<unsigned>(random() % 8192); };
            return random() % 4 == 0 ? brick_at(far(), far(), far()) : brick_at(near(), near(), near());
        };
        for (int step = 0; step < 600; ++step) {
            const std::size_t which = random() % trees.size();
            const float value = static_cast<float>(random() % 100);
            const MortonCode brick = draw();
            switch (random() % 9) {
                case 0:
                    if (trees.size() < 6) {
                        trees.push_back(trees[which]);
                        truths.push_back(truths[which]);
                    }
                    break;
                case 1:
                    if (trees.size() > 1) {
                        trees.erase(trees.begin() + static_cast<std::ptrdiff_t>(which));
                        truths.erase(truths.begin() + static_cast<std::ptrdiff_t>(which));
                    }
                    break;
                case 2:
                    trees[which] = trees.front();
                    truths[which] = truths.front();
                    break;
                case 3:
                    trees[which].forget(brick);
                    truths[which].erase(brick);
                    break;
                case 4:
                    trees[which].set_all(brick, value);
                    truths[which][brick] = value;
                    break;
                default:
                    trees[which].open(brick).fill(value);
                    truths[which][brick] = value;
            }
        }
        for (std::size_t i = 0; i < trees.size(); ++i) {
            ASSERT_EQ(contents(trees[i]), truths[i]) << "seed " << seed;
            ASSERT_EQ(trees[i].bricks(), truths[i].size());
            for (const auto& [brick, value] : truths[i]) ASSERT_EQ(trees[i].find(brick).at(511), value);
        }
    }
}

TEST(BrickTree, keeps_nothing_of_bricks_that_it_forgot) {
    BrickTree tree;
    tree.set_all(brick_at(1, 2, 3), 1.0F);
    (void)tree.open(brick_at(4000, 2, 3));
    const BrickTree copy = tree;
    tree.forget(brick_at(7, 7, 7));  // that it never had
    tree.forget(brick_at(1, 2, 3));
    tree.forget(brick_at(4000, 2, 3));
    EXPECT_EQ(tree.memory_bytes(), 0U);
    EXPECT_EQ(tree.bricks(), 0U);
    EXPECT_FALSE(tree.space().has_parts());
    EXPECT_EQ(copy.find(brick_at(1, 2, 3)).at(9), 1.0F);
}

TEST(BrickTree, holds_stamps_as_it_holds_log_odds) {
    BrickTreeOf<std::uint16_t> tree;
    EXPECT_TRUE(tree.find(brick_at(1, 2, 3)).is_unknown());
    tree.set_all(brick_at(1, 2, 3), 0xFFFF);
    EXPECT_EQ(tree.find(brick_at(1, 2, 3)).at(5), 0xFFFF);
    tree.open(brick_at(1, 2, 3))[5] = 1;
    EXPECT_EQ(tree.find(brick_at(1, 2, 3)).at(5), 1);
    EXPECT_EQ(tree.find(brick_at(1, 2, 3)).at(6), 0xFFFF);
    EXPECT_EQ(tree.memory_bytes(), 7 * 544 + 1040);
}

TEST(BrickTree, tells_what_is_different_and_passes_over_what_is_shared) {
    BrickTree before;
    for (unsigned i = 0; i < 1000; ++i) before.open(brick_at(i % 10, i / 10 % 10, i / 100)).fill(1.0F);
    BrickTree now = before;
    now.open(brick_at(3, 3, 3))[0] = 2.0F;
    now.set_all(brick_at(9, 9, 9), 5.0F);
    now.set_all(brick_at(5000, 1, 1), 5.0F);  // new space
    std::vector<MortonCode> different;
    now.for_each_difference(before, [&](MortonCode brick) { different.push_back(brick); });
    std::vector<MortonCode> expected{brick_at(3, 3, 3), brick_at(9, 9, 9), brick_at(5000, 1, 1)};
    std::ranges::sort(expected);
    EXPECT_EQ(different, expected);
    std::vector<MortonCode> back;
    before.for_each_difference(now, [&](MortonCode brick) { back.push_back(brick); });
    EXPECT_EQ(back, expected);
    now.for_each_difference(now, [&](MortonCode) { ADD_FAILURE() << "nothing differs from itself"; });
}

TEST(BrickTree, lets_copies_be_read_and_dropped_by_other_threads_while_it_is_written) {
    BrickTree tree;
    for (unsigned i = 0; i < 512; ++i) tree.open(brick_at(i % 8, i / 8 % 8, i / 64)).fill(0.0F);
    std::vector<std::thread> readers;
    for (int round = 1; round <= 20; ++round) {
        readers.emplace_back([copy = tree, was = static_cast<float>(round - 1)] {
            copy.for_each([&](MortonCode, const BrickView& view) { EXPECT_EQ(view.at(100), was); });
        });
        for (unsigned i = 0; i < 512; ++i)
            tree.open(brick_at(i % 8, i / 8 % 8, i / 64)).fill(static_cast<float>(round));
    }
    for (std::thread& reader : readers) reader.join();
    EXPECT_EQ(tree.find(brick_at(0, 0, 0)).at(0), 20.0F);
}

}  // namespace
}  // namespace octoskin
