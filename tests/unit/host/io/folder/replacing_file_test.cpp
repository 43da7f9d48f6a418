#include "host/io/folder/replacing_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

/// The mode of `file` once another one took its place.
mode_t mode_of_replaced(const std::filesystem::path& file) {
    auto replacing = ReplacingFile::begin(file);
    EXPECT_TRUE(replacing && replacing->commit());
    struct stat status {};
    EXPECT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, ::geteuid());
    return status.st_mode & 0777U;
}

TEST(ReplacingFile, has_the_mode_of_the_callers_file_in_whose_place_it_comes) {
    const testing_support::ScratchFolder folder;
    const auto file = folder.write("file", "old");
    for (const mode_t mode : {0600U, 0640U, 0666U}) {
        ASSERT_EQ(::chmod(file.c_str(), mode), 0);
        EXPECT_EQ(mode_of_replaced(file), mode);
    }
}

TEST(ReplacingFile, has_a_new_files_mode_in_the_place_of_another_users) {
    if (::geteuid() != 0) GTEST_SKIP() << "needs root, to make a file of another user";
    const testing_support::ScratchFolder folder;
    const auto file = folder.write("file", "old");
    ASSERT_EQ(::chmod(file.c_str(), 0666), 0);
    ASSERT_EQ(::chown(file.c_str(), 65534, 65534), 0);
    const mode_t mask = ::umask(022);
    EXPECT_EQ(mode_of_replaced(file), 0644U);
    ::umask(mask);
}

}  // namespace
}  // namespace octoskin
