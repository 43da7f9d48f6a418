#include "host/lab/study/work_folder.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

TEST(WorkFolderTest, two_under_one_parent_are_not_the_same_and_both_go) {
    const ScratchFolder parent;
    const auto opened = OpenFolder::open(parent.path(), FolderAccess::write);
    ASSERT_TRUE(opened);
    {
        const auto first = WorkFolder::create(*opened);
        auto second = WorkFolder::create(*opened);
        ASSERT_TRUE(first);
        ASSERT_TRUE(second);
        EXPECT_NE(first->folder().shown(), second->folder().shown());
        std::filesystem::create_directories(first->folder().shown() / "a/b");
        const WorkFolder moved = std::move(*second);
        EXPECT_EQ(parent.entries(), 2);
    }
    EXPECT_EQ(parent.entries(), 0);
}

TEST(WorkFolderTest, a_parent_that_is_gone_is_named) {
    const ScratchFolder parent;
    std::filesystem::create_directory(parent / "gone");
    const auto opened = OpenFolder::open(parent / "gone", FolderAccess::write);
    ASSERT_TRUE(opened);
    std::filesystem::remove(parent / "gone");
    const auto refused = WorkFolder::create(*opened);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(refused.error().error.file, parent / "gone");
}

}  // namespace
}  // namespace octoskin
