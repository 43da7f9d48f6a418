// A file written in one go, or the reason and the remedy.
#include "host/apps/recording/text_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

/// Expects an error with the system's reason; returns its code.
ErrorCode failure(const std::filesystem::path& file, const std::string& reason) {
    const auto written = write_text(file, "x");
    if (written) {
        ADD_FAILURE() << file << " was written";
        return {};
    }
    EXPECT_EQ(written.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(written.error().error.file, file);
    EXPECT_NE(written.error().error.what.find(reason), std::string::npos) << written.error().message();
    const auto check_disk = remedy_of(std::make_error_code(std::errc::io_error));  // of any other error
    EXPECT_NE(written.error().error.remedy, "");
    EXPECT_NE(written.error().error.remedy, check_disk);
    return written.error().error.code;
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
    EXPECT_EQ(failure("/dev/full", "No space left on device"), ErrorCode::system_error);
    EXPECT_EQ(failure(folder / "no/such", "No such file or directory"), ErrorCode::not_found);
    EXPECT_EQ(failure(folder.path(), "Is a directory"), ErrorCode::wrong_kind_of_file);
}

TEST(TextFile, leaves_the_other_names_of_a_file_what_they_have) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    std::filesystem::create_hard_link(victim, folder / "out");
    EXPECT_TRUE(write_text(folder / "out", "new"));
    EXPECT_EQ(ScratchFolder::read(folder / "out"), "new");
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
}

TEST(TextFile, puts_itself_in_the_place_of_a_link_and_writes_through_none) {
    const ScratchFolder folder;
    const auto victim = folder.write("victim", "precious");
    for (const char* target : {"victim", "nothing", "/dev/full", "/dev/stdout"}) {
        std::filesystem::remove(folder / "out");
        std::filesystem::create_symlink(target, folder / "out");
        EXPECT_TRUE(check_text_place(folder / "out")) << target;
        EXPECT_TRUE(write_text(folder / "out", "new")) << target;
        EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(folder / "out")));
        EXPECT_EQ(ScratchFolder::read(folder / "out"), "new");
    }
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
    EXPECT_FALSE(std::filesystem::exists(folder / "nothing"));
    EXPECT_EQ(folder.entries(), 2) << "nothing is left beside it";
}

TEST(TextFile, goes_to_the_descriptor_that_is_named_at_its_place) {
    const ScratchFolder folder;
    const auto file = folder.write("log", "before");
    const int opened = ::open(file.c_str(), O_WRONLY | O_APPEND);
    ASSERT_GE(opened, 0);
    for (const char* folder_of : {"/proc/self/fd/", "/dev/fd/"}) {
        const std::string name = folder_of + std::to_string(opened);
        EXPECT_TRUE(check_text_place(name)) << name;
        EXPECT_TRUE(write_text(name, ", then")) << name;
    }
    ::close(opened);
    EXPECT_EQ(ScratchFolder::read(file), "before, then, then");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(TextFile, that_fails_leaves_what_was_there_and_nothing_beside_it) {
    const ScratchFolder folder;
    const auto file = folder.write("out", "precious");
    std::filesystem::create_directory(folder / ".out.octoskin-part");
    const auto refused = write_text(file, "new");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().error.code, ErrorCode::already_exists);
    EXPECT_EQ(refused.error().error.file, folder / ".out.octoskin-part");
    EXPECT_FALSE(check_text_place(file));
    EXPECT_EQ(ScratchFolder::read(file), "precious");
    std::filesystem::remove(folder / ".out.octoskin-part");
    std::filesystem::create_symlink("out", folder / ".out.octoskin-part");
    EXPECT_TRUE(write_text(file, "new"));
    EXPECT_EQ(ScratchFolder::read(file), "new");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(TextFile, keeps_to_itself_what_its_owner_alone_may_read) {
    const ScratchFolder folder;
    const auto file = folder.write("out", "secret");
    std::filesystem::permissions(file, std::filesystem::perms(0600));
    EXPECT_TRUE(write_text(file, "new secret"));
    EXPECT_EQ(std::filesystem::status(file).permissions(), std::filesystem::perms(0600));
}

TEST(TextFile, has_a_place_that_can_be_checked_before_the_work) {
    const ScratchFolder folder;
    EXPECT_TRUE(check_text_place(folder / "new"));
    EXPECT_TRUE(check_text_place("/dev/null"));
    EXPECT_FALSE(check_text_place(folder / "no/such"));
    EXPECT_FALSE(check_text_place(folder.path()));
    EXPECT_FALSE(check_text_place(folder.path().string() + "/"));
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_FALSE(check_text_place({NamedFolder(folder.path()), "pipe"})) << "it was not typed itself";
    EXPECT_EQ(folder.entries(), 1);
}

TEST(TextFile, is_known_as_an_input_by_each_of_its_names) {
    const ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{folder.write("rig", "a"), folder.write("base", "b")};
    std::filesystem::create_symlink("base", folder / "link");
    std::filesystem::create_hard_link(folder / "base", folder / "hard_link");
    for (const char* const name : {"base", "./base", "link", "hard_link"}) {
        const auto refused = check_replaces_none(folder.path() / name, inputs);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().exit, ExitCode::usage);
        EXPECT_EQ(refused.error().error.code, ErrorCode::conflict);
        EXPECT_EQ(refused.error().error.file, inputs[1]);
    }
    EXPECT_TRUE(check_replaces_none(folder / "new", inputs));
    EXPECT_TRUE(check_replaces_none({}, inputs));
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
    EXPECT_EQ(refused.error().error.code, ErrorCode::link);
    EXPECT_EQ(refused.error().error.file, folder / "named/up");
    EXPECT_EQ(ScratchFolder::read(victim), "precious");
}

}  // namespace
}  // namespace octoskin
