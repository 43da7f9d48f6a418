// A file written in one go, or the reason and the remedy.
#include "host/apps/recording/text_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

std::string failure(const std::filesystem::path& file, std::string_view text = "x") {
    const auto written = write_text(file, text);
    if (written) return "";
    EXPECT_EQ(written.error().code, ExitCode::cannot_create);
    EXPECT_EQ(written.error().message.find(file.string() + ": cannot be written ("), 0U);
    return written.error().message.substr(file.string().size());
}

TEST(TextFile, replaces_all_that_was_there) {
    const ScratchFolder folder;
    const auto file = folder.write("block", "longer than what comes");
    EXPECT_TRUE(write_text(file, std::string_view("a\0b", 3)));
    EXPECT_EQ(ScratchFolder::read(file), std::string("a\0b", 3));
    EXPECT_TRUE(write_text(file, ""));
    EXPECT_EQ(ScratchFolder::read(file), "");
    EXPECT_TRUE(write_text("/dev/null", "a device, too"));
}

TEST(TextFile, says_why_not_and_what_to_do) {
    const ScratchFolder folder;
    EXPECT_EQ(failure("/dev/full"),
              ": cannot be written (No space left on device): make room there, or write elsewhere");
    EXPECT_EQ(failure(folder / "no/such"),
              ": cannot be written (No such file or directory): its folder is not there: make it, or write "
              "elsewhere");
    EXPECT_EQ(failure(folder.path()),
              ": cannot be written (Is a directory): it is a folder: name a file, or move the folder away");
}

}  // namespace
}  // namespace octoskin
