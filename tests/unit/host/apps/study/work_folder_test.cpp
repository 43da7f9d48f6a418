#include "host/apps/study/work_folder.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

TEST(WorkFolderTest, two_under_one_parent_are_not_the_same_and_both_go) {
    const ScratchFolder parent;
    {
        const auto first = WorkFolder::create(parent.path());
        auto second = WorkFolder::create(parent.path());
        ASSERT_TRUE(first);
        ASSERT_TRUE(second);
        EXPECT_NE(first->path(), second->path());
        std::filesystem::create_directories(first->path() / "a/b");
        const WorkFolder moved = std::move(*second);
        EXPECT_EQ(parent.entries(), 2);
    }
    EXPECT_EQ(parent.entries(), 0);
}

TEST(WorkFolderTest, a_parent_that_is_not_there_is_named) {
    const ScratchFolder parent;
    const auto refused = WorkFolder::create(parent / "absent");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ExitCode::cannot_create);
    EXPECT_NE(refused.error().message.find("absent"), std::string::npos);
}

}  // namespace
}  // namespace octoskin
