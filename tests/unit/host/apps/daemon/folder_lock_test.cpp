#include "host/apps/daemon/folder_lock.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <optional>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

TEST(FolderLock, is_held_by_one_at_a_time_whose_process_is_named) {
    const testing_support::ScratchFolder scratch;
    const auto folder = scratch / "not/yet/there";
    std::optional<FolderLock> first;
    {
        auto taken = FolderLock::take(folder);
        ASSERT_TRUE(taken) << taken.error().message;
        first.emplace(std::move(taken).value());
    }
    const auto second = FolderLock::take(folder);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ExitCode::cannot_create);
    EXPECT_NE(second.error().message.find("process " + std::to_string(::getpid())), std::string::npos)
        << second.error().message;
    EXPECT_TRUE(FolderLock::take(scratch / "another"));
    first.reset();
    EXPECT_TRUE(FolderLock::take(folder));
}

TEST(FolderLock, says_why_nothing_can_be_written_there) {
    const testing_support::ScratchFolder scratch;
    scratch.write("file", "in the way");
    const auto lock = FolderLock::take(scratch / "file");
    ASSERT_FALSE(lock);
    EXPECT_NE(lock.error().message.find("file"), std::string::npos);
    EXPECT_EQ(testing_support::ScratchFolder::read(scratch / "file"), "in the way");
}

}  // namespace
}  // namespace octoskin
