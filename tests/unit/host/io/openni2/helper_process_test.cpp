// Helper programs that behave and that do not, as shell scripts.
#include "host/io/openni2/helper_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin::openni2 {
namespace {

using namespace std::chrono_literals;

class HelperProcessTest : public testing::Test {
  protected:
    Result<HelperProcess, std::string> start(const std::string& script,
                                             HelperPipe pipe = HelperPipe::its_output) {
        const auto program = scratch_.write("helper", "#!/bin/sh\n" + script + "\n");
        std::filesystem::permissions(program, std::filesystem::perms::owner_all);
        return HelperProcess::start(program, "the argument", pipe);
    }
    testing_support::ScratchFolder scratch_;
};

TEST_F(HelperProcessTest, gets_its_argument_and_gives_its_output) {
    auto helper = start("printf '%s' \"$1\"");
    ASSERT_TRUE(helper) << helper.error();
    std::string text(12, ' ');
    EXPECT_EQ(::read(helper->descriptor(), text.data(), text.size()), 12);
    EXPECT_EQ(text, "the argument");
    EXPECT_EQ(helper->wait(5s), std::nullopt);
}

TEST_F(HelperProcessTest, sees_its_inputs_end_when_the_pipe_is_closed) {
    auto helper = start("test \"$(cat)\" = hello", HelperPipe::its_input);
    ASSERT_TRUE(helper) << helper.error();
    EXPECT_EQ(::write(helper->descriptor(), "hello", 5), 5);
    helper->close_pipe();
    EXPECT_EQ(helper->wait(5s), std::nullopt);
}

TEST_F(HelperProcessTest, tells_exit_codes_and_signals) {
    EXPECT_EQ(start("exit 3")->wait(5s), "exit code 3");
    EXPECT_EQ(start("kill -SEGV $$")->wait(5s), "signal 11");
}

TEST_F(HelperProcessTest, is_killed_when_it_does_not_end_in_time) {
    auto helper = start("exec sleep 100");
    ASSERT_TRUE(helper) << helper.error();
    EXPECT_EQ(helper->wait(20ms), "did not end in time");
}

TEST_F(HelperProcessTest, that_is_not_there_is_an_error_with_its_name) {
    const auto helper = HelperProcess::start(scratch_ / "absent", "x", HelperPipe::its_output);
    ASSERT_FALSE(helper);
    EXPECT_NE(helper.error().find("absent"), std::string::npos);
    EXPECT_EQ(find_helper("octoskin-no-such-helper"), std::nullopt);
}

}  // namespace
}  // namespace octoskin::openni2
