#include "host/apps/daemon/map_keeper.hpp"

#include <gtest/gtest.h>

#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

constexpr Nanoseconds kPatience{5'000'000'000};

FusedMap some_map(std::uint16_t voxels) {
    FusedMap map{MapConfig{}};
    for (std::uint16_t i = 0; i < voxels; ++i) {
        const VoxelUpdate update{{static_cast<std::uint16_t>(32768 + 7 * i), 32768, 32700},
                                 i % 3 == 0 ? 0.9F : -0.4F};
        map.apply(std::span(&update, 1));
    }
    return map;
}

TEST(FusedMapCopy, is_equal_and_its_own) {
    FusedMap map = some_map(300);
    const FusedMap copy = map.copy();
    EXPECT_EQ(encode_ot(copy), encode_ot(map));
    EXPECT_EQ(copy.known_voxels(), map.known_voxels());
    EXPECT_EQ(copy.counters(), map.counters());
    const std::string before = encode_ot(copy);
    const VoxelUpdate update{{40000, 40000, 40000}, 0.9F};
    map.apply(std::span(&update, 1));
    EXPECT_EQ(encode_ot(copy), before);
    EXPECT_NE(encode_ot(map), before);
}

TEST(MapKeeper, loads_what_it_saved) {
    const testing_support::ScratchFolder folder;
    const FusedMap map = some_map(300);
    {
        MapKeeper keeper(folder / "maps");
        EXPECT_FALSE(keeper.load(MapConfig{}).value().has_value());
        keeper.save(map.copy());
        ASSERT_TRUE(keeper.finish(kPatience));
        EXPECT_EQ(keeper.record().saved, 1U);
        EXPECT_TRUE(keeper.record().newest);
    }
    const MapKeeper again(folder / "maps");
    const auto loaded = again.load(MapConfig{});
    ASSERT_TRUE(loaded && *loaded);
    EXPECT_EQ(encode_ot(**loaded), encode_ot(map));
}

TEST(MapKeeper, refuses_a_damaged_map_and_one_of_another_resolution_by_name) {
    const testing_support::ScratchFolder folder;
    const MapKeeper keeper(folder.path());
    folder.write("fused.ot", "# Octomap OcTree file\nid OcTree\nsize 9\nres 0.04\ndata\nxx");
    const auto damaged = keeper.load(MapConfig{});
    ASSERT_FALSE(damaged);
    EXPECT_NE(damaged.error().message.find("fused.ot"), std::string::npos);
    folder.write("fused.ot", encode_ot(some_map(10)));
    const auto other = keeper.load(MapConfig{.resolution_m = 0.02});
    ASSERT_FALSE(other);
    EXPECT_NE(other.error().message.find("0.04"), std::string::npos) << other.error().message;
}

TEST(MapKeeper, writes_the_newest_and_counts_what_it_skipped) {
    const testing_support::ScratchFolder folder;
    MapKeeper keeper(folder.path());
    constexpr std::uint16_t kSaves = 200;
    for (std::uint16_t i = 1; i <= kSaves; ++i) keeper.save(some_map(i));
    ASSERT_TRUE(keeper.finish(kPatience));
    const SaveRecord record = keeper.record();
    EXPECT_EQ(record.saved + record.displaced, kSaves);
    EXPECT_EQ(keeper.load(MapConfig{}).value()->known_voxels(), kSaves);
}

TEST(MapKeeper, says_why_it_cannot_save) {
    const testing_support::ScratchFolder folder;
    folder.write("file", "in the way");
    MapKeeper keeper(folder / "file");
    keeper.save(some_map(3));
    ASSERT_TRUE(keeper.finish(kPatience));
    EXPECT_EQ(keeper.record().failed, 1U);
    EXPECT_NE(keeper.record().error.find("file"), std::string::npos);
}

}  // namespace
}  // namespace octoskin
