#include "host/io/mapfile/map_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/mapfile/ply_writer.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::ScratchFolder;

TEST(MapFile, the_extension_names_the_format) {
    const ScratchFolder folder;
    const FusedMap map = samples::small_map();
    for (const char* name : {"map.ot", "map.bt", "map.ply"}) {
        ASSERT_TRUE(save_map(map, folder / name).has_value());
    }
    EXPECT_EQ(ScratchFolder::read(folder / "map.ot"), encode_ot(map));
    EXPECT_EQ(ScratchFolder::read(folder / "map.bt"), encode_bt(map));
    EXPECT_EQ(ScratchFolder::read(folder / "map.ply"), encode_ply(map));
    const auto unknown = save_map(map, folder / "map.pcd");
    ASSERT_FALSE(unknown.has_value());
    EXPECT_THAT(unknown.error().message,
                HasSubstr("map.pcd: extension \".pcd\" is not one of .ot, .bt, .ply"));
}

TEST(MapFile, loads_what_it_saved_by_content_and_not_by_name) {
    const ScratchFolder folder;
    const FusedMap map = samples::small_map();
    const auto file = folder.write("renamed.dat", encode_ot(map));
    const auto loaded = load_map(file);
    ASSERT_TRUE(loaded.has_value());
    EXPECT_EQ(oracle::voxels_of(loaded->map), oracle::voxels_of(map));
}

TEST(MapFile, says_what_is_wrong_with_a_file_and_where) {
    const ScratchFolder folder;
    const std::string whole = encode_ot(samples::small_map());
    const auto truncated = folder.write("truncated.ot", whole.substr(0, whole.size() - 1));
    ASSERT_FALSE(load_map(truncated).has_value());
    EXPECT_THAT(load_map(truncated).error().message, HasSubstr("truncated.ot: byte "));
    EXPECT_THAT(load_map(truncated).error().message, HasSubstr("the data end within the tree"));
    EXPECT_THAT(load_map(folder / "absent.ot").error().message,
                HasSubstr("absent.ot: opening failed (No such file or directory)"));
}

// Whoever has a mapping with that much memory saves such a map, and must be able to go on with it.
TEST(MapFile, a_map_to_go_on_with_may_be_as_large_as_its_mappings_memory) {
    const ScratchFolder folder;
    const auto large = folder.write(
        "large.ot",
        "# Octomap OcTree file\n# saved by octoskin\nid OcTree\nsize 60000000\nres 0.04\ndata\nxx");
    EXPECT_TRUE(load_map(large).error().is_too_large);
    const auto loaded = load_map_of(MapConfig{.memory_max_mib = 800}, large);
    EXPECT_FALSE(loaded.error().is_too_large);
    EXPECT_THAT(loaded.error().message, HasSubstr("the data end within the tree"));
    const auto refused = load_map_of(MapConfig{.memory_max_mib = 100}, large);
    EXPECT_TRUE(refused.error().is_too_large);
    EXPECT_THAT(refused.error().message,
                HasSubstr("large.ot: it was saved with more memory than the 100 MiB of map.memory_max_mib: "
                          "raise that in the mapping file"));
}

TEST(MapFile, refuses_what_is_no_file_or_too_large_without_waiting) {
    const ScratchFolder folder;
    EXPECT_THAT(load_map(folder.path()).error().message, HasSubstr("not a regular file"));
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(load_map(folder / "pipe").error().message, HasSubstr("not a regular file"));
    EXPECT_THAT(load_map("/dev/zero").error().message, HasSubstr("not a regular file"));
    const auto file = folder.write("map.ot", encode_ot(samples::small_map()));
    EXPECT_THAT(load_map(file, {}, 10).error().message, HasSubstr("the limit is 10"));
}

}  // namespace
}  // namespace octoskin
