// A process in OpenOCD's place: a script of that name, first on the PATH.
#include "host/apps/flashing/openocd_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::flashing {
namespace {

using End = OpenocdRun::End;
using testing::HasSubstr;

class OpenocdRunTest : public testing::Test {
  protected:
    OpenocdRunTest() : path_(std::getenv("PATH")) {}
    ~OpenocdRunTest() override { ::setenv("PATH", path_.c_str(), 1); }

    void put_openocd(const std::string& script) {
        const auto file = folder_.write("openocd", "#!/bin/sh\n" + script);
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
        ::setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
    }
    [[nodiscard]] OpenocdRun run(std::chrono::seconds patience = std::chrono::seconds(20)) const {
        const auto folder = OpenFolder::open(folder_.path(), FolderAccess::write);
        return run_openocd(*folder, {"-f", "flash.cfg"}, patience);
    }

    testing_support::ScratchFolder folder_;
    std::string path_;
};

TEST_F(OpenocdRunTest, keeps_all_that_it_says_and_its_exit_code) {
    put_openocd("echo out $1 $2; echo err >&2; exit 3");
    const OpenocdRun ended = run();
    EXPECT_EQ(ended.end, End::exited);
    EXPECT_EQ(ended.exit_code, 3);
    EXPECT_THAT(ended.output, HasSubstr("out -f flash.cfg\n"));
    EXPECT_THAT(ended.output, HasSubstr("err\n"));
}

TEST_F(OpenocdRunTest, finds_the_folder_by_its_descriptor_and_works_in_none_that_others_fill) {
    put_openocd(std::string("pwd; cd ") + kOpenocdFolder + "/ && pwd -P");
    EXPECT_EQ(run().output, "/\n" + std::filesystem::canonical(folder_.path()).string() + "\n");
}

TEST_F(OpenocdRunTest, a_signal_is_no_success) {
    put_openocd("kill -SEGV $$");
    EXPECT_EQ(run().exit_code, 128 + 11);
}

TEST_F(OpenocdRunTest, more_words_than_a_pipe_holds_block_nobody) {
    put_openocd("head -c 3000000 /dev/zero; echo end; exit 0");
    const OpenocdRun ended = run();
    EXPECT_EQ(ended.end, End::exited);
    EXPECT_GE(ended.output.size(), std::size_t{1} << 20U);
    EXPECT_LT(ended.output.size(), (std::size_t{1} << 20U) + 4096);
}

TEST_F(OpenocdRunTest, one_that_never_ends_is_killed) {
    put_openocd("echo before; exec sleep 600");
    const OpenocdRun ended = run(std::chrono::seconds(1));
    EXPECT_EQ(ended.end, End::timed_out);
    EXPECT_THAT(ended.output, HasSubstr("before"));
}

TEST_F(OpenocdRunTest, one_that_is_not_there_or_cannot_be_started_is_told_apart) {
    ::setenv("PATH", folder_.path().c_str(), 1);
    EXPECT_EQ(run().end, End::not_found);
    folder_.write("openocd", "text");
    std::filesystem::permissions(folder_ / "openocd", std::filesystem::perms::owner_read);
    EXPECT_EQ(run().end, End::no_process);
}

}  // namespace
}  // namespace octoskin::flashing
