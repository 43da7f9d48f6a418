#include "host/io/mapfile/map_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/mapfile/ply_writer.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/octomap_oracle.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/host/io/mapfile/map_samples.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::remedy_is;
using testing_support::ScratchFolder;
using testing_support::value_is;
using testing_support::what_is;

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
    EXPECT_THAT(unknown.error(), AllOf(code_is(ErrorCode::unknown_word), file_is("map.pcd"),
                                       what_is(HasSubstr(".ot, .bt, .ply")), value_is("\".pcd\"")));
    EXPECT_TRUE(has_its_fields(unknown.error()));
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
    EXPECT_THAT(load_map(truncated).error(),
                AllOf(code_is(ErrorCode::damaged), file_is("truncated.ot"),
                      what_is(AllOf(StartsWith("byte "), HasSubstr("the data end within the tree")))));
    EXPECT_TRUE(has_its_fields(load_map(truncated).error()));
    EXPECT_THAT(load_map(folder / "absent.ot").error(),
                AllOf(code_is(ErrorCode::not_found), file_is("absent.ot"),
                      what_is(HasSubstr("No such file or directory"))));
}

// Whoever has a mapping with that much memory saves such a map, and must be able to go on with it.
TEST(MapFile, a_map_to_go_on_with_may_be_as_large_as_its_mappings_memory) {
    const ScratchFolder folder;
    const auto large = folder.write(
        "large.ot",
        "# Octomap OcTree file\n# saved by octoskin\nid OcTree\nsize 60000000\nres 0.04\ndata\nxx");
    EXPECT_THAT(load_map(large).error(), code_is(ErrorCode::too_large));
    const auto loaded = load_map_of(MapConfig{.memory_max_mib = 800}, large);
    EXPECT_THAT(loaded.error(),
                AllOf(code_is(ErrorCode::damaged), what_is(HasSubstr("the data end within the tree"))));
    const auto refused = load_map_of(MapConfig{.memory_max_mib = 100}, large);
    EXPECT_THAT(refused.error(), AllOf(code_is(ErrorCode::too_large), file_is("large.ot"),
                                       what_is(HasSubstr("100 MiB of map.memory_max_mib")),
                                       remedy_is(HasSubstr("in the mapping file"))));
    EXPECT_TRUE(has_its_fields(refused.error()));
}

TEST(MapFile, refuses_what_is_no_file_or_too_large_without_waiting) {
    const ScratchFolder folder;
    EXPECT_THAT(load_map(folder.path()).error(), code_is(ErrorCode::wrong_kind_of_file));
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(load_map(folder / "pipe").error(),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), file_is("pipe")));
    EXPECT_THAT(load_map("/dev/zero").error(), code_is(ErrorCode::wrong_kind_of_file));
    const auto file = folder.write("map.ot", encode_ot(samples::small_map()));
    EXPECT_THAT(load_map(file, {}, 10).error(),
                AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("at most 10 bytes")),
                      value_is(std::to_string(std::filesystem::file_size(file)))));
}

}  // namespace
}  // namespace octoskin
