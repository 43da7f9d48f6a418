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

TEST(TextFile, leaves_the_other_names_of_a_file_what_they_have) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    std::filesystem::create_hard_link(victim, folder / "out");
    EXPECT_TRUE(write_text(folder / "out", "new"));
    EXPECT_EQ(ScratchFolder::read(folder / "out"), "new");
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
    std::filesystem::create_symlink("out", folder / "link");
    EXPECT_TRUE(write_text(folder / "link", "by the link that was typed"));
    EXPECT_EQ(ScratchFolder::read(folder / "out"), "by the link that was typed");
}

TEST(TextFile, below_a_named_folder_replaces_a_link_and_follows_none) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    std::filesystem::create_directory(folder / "named");
    const NamedFolder named(folder / "named");
    for (const bool is_hard : {false, true}) {
        std::filesystem::remove(folder / "named/out");
        is_hard ? std::filesystem::create_hard_link(victim, folder / "named/out")
                : std::filesystem::create_symlink("../victim", folder / "named/out");
        EXPECT_TRUE(write_text({named, "out"}, "new"));
        EXPECT_EQ(ScratchFolder::read(folder / "named/out"), "new");
        EXPECT_EQ(ScratchFolder::read(victim), "precious");
    }
    std::filesystem::create_symlink("..", folder / "named/up");
    const auto refused = write_text({named, "up/victim"}, "new");
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find((folder / "named/up").string() + ": is a symbolic link"),
              std::string::npos);
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
}

}  // namespace
}  // namespace octoskin
