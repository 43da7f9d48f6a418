// The maps' folder is removed, moved or replaced under a daemon.
#include "host/apps/daemon/map_home.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

class MapHomeTest : public testing::Test {
  protected:
    [[nodiscard]] bool is_held(const OpenFolder& folder) const {
        return fs::equivalent(folder.path_for_libraries(), maps_);
    }
    testing_support::ScratchFolder scratch_;
    fs::path maps_ = scratch_ / "maps";
    MapHome home_ = MapHome::take(maps_).value();
};

TEST_F(MapHomeTest, is_the_folder_that_is_named_as_long_as_it_is_there) {
    EXPECT_FALSE(home_.look());
    EXPECT_EQ(home_.problem(), "");
    EXPECT_TRUE(is_held(home_.folder()));
}

TEST_F(MapHomeTest, that_was_removed_is_named_and_one_made_anew_is_held_and_locked) {
    fs::remove_all(maps_);
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem().find("was removed"), std::string::npos) << home_.problem();
    EXPECT_FALSE(fs::exists(maps_)) << "only a person makes it anew";
    fs::create_directory(maps_);
    EXPECT_TRUE(home_.look());
    EXPECT_EQ(home_.problem(), "");
    EXPECT_TRUE(is_held(home_.folder()));
    EXPECT_FALSE(FolderLock::take(maps_)) << "it is locked";
    EXPECT_FALSE(home_.look());
}

TEST_F(MapHomeTest, that_was_moved_away_is_held_where_it_is) {
    fs::rename(maps_, scratch_ / "aside");
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem().find("was moved away"), std::string::npos) << home_.problem();
    EXPECT_TRUE(fs::equivalent(home_.folder().path_for_libraries(), scratch_ / "aside"));
    fs::rename(scratch_ / "aside", maps_);
    EXPECT_FALSE(home_.look());
    EXPECT_EQ(home_.problem(), "");
}

TEST_F(MapHomeTest, is_no_folder_with_a_map_of_its_own) {
    for (const char* name : {"fused.ot", "fused.bt", "fused.snapshot"}) {
        fs::remove_all(maps_);
        fs::create_directory(maps_);
        scratch_.write(std::string("maps/") + name, "another map");
        EXPECT_FALSE(home_.look());
        EXPECT_NE(home_.problem().find("not overwritten"), std::string::npos) << home_.problem();
        EXPECT_FALSE(is_held(home_.folder()));
        EXPECT_TRUE(FolderLock::take(maps_)) << "it is not kept from others";
        fs::remove(maps_ / name);
        EXPECT_TRUE(home_.look()) << name;
        EXPECT_TRUE(is_held(home_.folder()));
    }
}

TEST_F(MapHomeTest, is_no_folder_in_which_maps_of_a_killed_run_wait) {
    fs::remove_all(maps_);
    fs::create_directories(maps_ / ".octoskin-ready");
    scratch_.write("maps/.octoskin-ready/.journal", "octoskin-file-set/1\nput fused.ot\n");
    scratch_.write("maps/.octoskin-ready/fused.ot", "another map");
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem().find("not overwritten"), std::string::npos) << home_.problem();
    EXPECT_FALSE(is_held(home_.folder()));
    EXPECT_EQ(testing_support::ScratchFolder::read(maps_ / ".octoskin-ready/fused.ot"), "another map");
}

TEST_F(MapHomeTest, is_no_folder_that_another_daemon_holds_and_no_file) {
    fs::rename(maps_, scratch_ / "aside");
    {
        const auto other = FolderLock::take(maps_);
        ASSERT_TRUE(other);
        EXPECT_FALSE(home_.look());
        EXPECT_NE(home_.problem().find("another octoskin"), std::string::npos) << home_.problem();
        EXPECT_FALSE(is_held(home_.folder()));
    }
    fs::remove_all(maps_);
    scratch_.write("maps", "a file");
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem(), "");
    EXPECT_EQ(testing_support::ScratchFolder::read(maps_), "a file");
}

TEST_F(MapHomeTest, is_not_what_a_link_in_its_place_leads_to) {
    fs::create_directory(scratch_ / "victim");
    fs::rename(maps_, scratch_ / "aside");
    fs::create_directory_symlink(scratch_ / "victim", maps_);
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem().find(maps_.string() + ": is a symbolic link"), std::string::npos)
        << home_.problem();
    EXPECT_NE(home_.problem().find("saved in " + (scratch_ / "aside").string()), std::string::npos)
        << home_.problem();
    EXPECT_EQ(home_.where(), scratch_ / "aside");
    EXPECT_TRUE(fs::is_empty(scratch_ / "victim")) << "not even a lock file";
    fs::remove_all(scratch_ / "aside");
    EXPECT_FALSE(home_.look());
    EXPECT_NE(home_.problem().find("the map is not saved"), std::string::npos) << home_.problem();
    EXPECT_EQ(home_.where(), "");
    fs::remove(maps_);
    fs::create_directory(maps_);
    EXPECT_TRUE(home_.look());
    EXPECT_EQ(home_.problem(), "");
    EXPECT_TRUE(is_held(home_.folder()));
}

TEST_F(MapHomeTest, is_not_reached_through_a_link_on_the_way_to_its_place) {
    const fs::path deep = scratch_ / "a/b/maps";
    fs::create_directories(deep.parent_path());
    MapHome home = MapHome::take(deep).value();
    fs::rename(scratch_ / "a/b", scratch_ / "aside");
    fs::create_directories(scratch_ / "victim/maps");
    fs::create_directory_symlink(scratch_ / "victim", scratch_ / "a/b");
    EXPECT_FALSE(home.look());
    EXPECT_NE(home.problem().find((scratch_ / "a/b").string() + ": is a symbolic link"), std::string::npos)
        << home.problem();
    EXPECT_EQ(home.where(), scratch_ / "aside/maps");
    EXPECT_TRUE(fs::is_empty(scratch_ / "victim/maps"));
}

/// What was typed may be a link: where it led at the start is the place, whatever it leads to later.
TEST_F(MapHomeTest, is_where_a_link_that_was_typed_led_at_the_start) {
    const fs::path typed = scratch_ / "typed";
    fs::create_directory(scratch_ / "disk");
    fs::create_directory_symlink(scratch_ / "disk", typed);
    MapHome home = MapHome::take(typed).value();
    EXPECT_FALSE(home.look());
    EXPECT_EQ(home.problem(), "");
    fs::create_directory(scratch_ / "victim");
    fs::remove(typed);
    fs::create_directory_symlink(scratch_ / "victim", typed);
    EXPECT_FALSE(home.look());
    EXPECT_NE(home.problem().find("leads elsewhere"), std::string::npos) << home.problem();
    EXPECT_EQ(home.where(), scratch_ / "disk");
    EXPECT_TRUE(fs::is_empty(scratch_ / "victim"));
    fs::remove_all(scratch_ / "disk");
    fs::create_directory(scratch_ / "disk");
    EXPECT_TRUE(home.look()) << "made anew in its place";
    EXPECT_EQ(home.where(), scratch_ / "disk");
}

}  // namespace
}  // namespace octoskin
