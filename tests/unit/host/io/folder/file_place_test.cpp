#include "host/io/folder/file_place.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <utility>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing_support::ScratchFolder;

class FilePlaceTest : public testing::Test {
  protected:
    FilePlaceTest() {
        fs::create_directory(scratch_ / "rec");
        scratch_.write("rec/rig.yaml", "rig");
        scratch_.write("robot.urdf", "robot");
        fs::create_symlink("../robot.urdf", scratch_ / "rec/robot.urdf");
        ::mkfifo((scratch_ / "pipe").c_str(), 0600);
    }
    [[nodiscard]] FilePlace within(const char* name) const {
        return {*OpenFolder::open(scratch_ / "rec", FolderAccess::read), name};
    }
    ScratchFolder scratch_;
};

TEST_F(FilePlaceTest, a_typed_path_follows_links_and_one_below_a_folder_does_not) {
    const FilePlace typed(scratch_ / "rec/robot.urdf");
    EXPECT_TRUE(typed.is_file());
    EXPECT_EQ(*typed.open()->read(100), "robot");
    const FilePlace below = within("robot.urdf");
    EXPECT_EQ(below.shown(), typed.shown());
    EXPECT_EQ(below.kind(), EntryKind::link);
    EXPECT_TRUE(below.is_there());
    EXPECT_EQ(below.open().error().fault, FolderFault::link);
    EXPECT_EQ(*within("rig.yaml").open()->read(100), "rig");
}

TEST_F(FilePlaceTest, held_content_outlives_the_file_and_is_not_for_writing) {
    const FilePlace held = FilePlace::held("text", scratch_ / "robot.urdf");
    fs::remove(scratch_ / "robot.urdf");
    EXPECT_EQ(held.shown(), scratch_ / "robot.urdf");
    EXPECT_EQ(held.kind(), EntryKind::file);
    EXPECT_EQ(*held.open()->read(100), "text");
    EXPECT_EQ(*held.open()->read(100), "text");  // each from its begin
    EXPECT_EQ(*held.read(100), "text");
    EXPECT_EQ(*held.read(2), "tex");  // one more byte shows that there is more
    EXPECT_EQ(*within("rig.yaml").read(2), "rig");
    EXPECT_EQ(held.create_anew().error().error_number, EROFS);
    EXPECT_FALSE(fs::exists(scratch_ / "robot.urdf"));
    EXPECT_EQ(*held.beside("rec/rig.yaml").open()->read(100), "rig");
    const FilePlace below = FilePlace::held("text", within("robot.urdf"));  // a link there
    EXPECT_EQ(*below.open()->read(100), "text");
    EXPECT_NE(below.folder(), nullptr);
}

TEST_F(FilePlaceTest, what_a_file_speaks_of_is_beside_it_and_stays_below_its_folder) {
    const FilePlace typed(scratch_ / "rec/rig.yaml");
    EXPECT_EQ(*typed.beside("../robot.urdf").open()->read(100), "robot");
    EXPECT_EQ(*typed.beside(scratch_ / "robot.urdf").open()->read(100), "robot");
    const FilePlace below = within("rig.yaml");
    EXPECT_EQ(*below.beside("rig.yaml").open()->read(100), "rig");
    EXPECT_EQ(below.beside("../robot.urdf").open().error().fault, FolderFault::outside);
    EXPECT_EQ(below.beside(scratch_ / "robot.urdf").open().error().fault, FolderFault::outside);
    EXPECT_EQ(below.beside("robot.urdf").open().error().fault, FolderFault::link);
}

TEST_F(FilePlaceTest, a_typed_path_leads_to_an_ordinary_file_or_is_refused_at_once) {
    EXPECT_EQ(FilePlace(scratch_ / "pipe").open().error().fault, FolderFault::not_a_file);
    EXPECT_EQ(FilePlace(scratch_ / "pipe").kind(), EntryKind::other);
    EXPECT_EQ(FilePlace("/dev/null").open().error().fault, FolderFault::not_a_file);
    EXPECT_EQ(FilePlace(scratch_.path()).open().error().fault, FolderFault::not_a_file);
    EXPECT_EQ(FilePlace(scratch_ / "none").open().error().fault, FolderFault::absent);
    EXPECT_FALSE(FilePlace(scratch_ / "none").is_there());
    EXPECT_TRUE(FilePlace().empty());
}

TEST_F(FilePlaceTest, a_file_that_is_nearly_all_holes_is_no_ordinary_one) {
    constexpr std::uintmax_t kGiB = 1U << 30U;
    const auto file = scratch_.write("large", std::string(16U << 20U, 'x'));
    for (const auto& [size, is_opened] :
         {std::pair{kGiB, true}, std::pair{kGiB + (kGiB >> 1U), true}, std::pair{4 * kGiB, false}}) {
        fs::resize_file(file, size);
        const auto opened = FilePlace(file).open();
        EXPECT_EQ(opened.has_value(), is_opened) << size;
        if (opened) {
            EXPECT_EQ(opened->read(3)->substr(0, 3), "xxx");
            EXPECT_EQ(::lseek(opened->descriptor(), 0, SEEK_CUR), 0) << "is at its begin";
        } else {
            EXPECT_EQ(opened.error().fault, FolderFault::not_a_file);
        }
    }
}

TEST_F(FilePlaceTest, its_folder_is_what_is_written_to) {
    const auto parent = FilePlace(scratch_ / "rec/new").parent_to_write();
    ASSERT_TRUE(parent);
    EXPECT_TRUE(parent->create_new("new"));
    const auto opened = OpenFolder::open(scratch_.path(), FolderAccess::write);
    ASSERT_TRUE(opened);
    EXPECT_EQ(FilePlace(*opened, "top").parent_to_write()->shown(), scratch_.path());
    EXPECT_EQ(FilePlace(*opened, "rec/x").parent_to_write()->shown(), scratch_ / "rec");
    EXPECT_EQ(FilePlace(*opened, "none/x").parent_to_write().error().fault, FolderFault::absent);
}

}  // namespace
}  // namespace octoskin
