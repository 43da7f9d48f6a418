// Helper programs that behave and that do not, as shell scripts.
#include "host/io/openni2/helper_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>

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
        return HelperProcess::start(program, {"the argument"}, pipe);
    }
    testing_support::ScratchFolder scratch_;
};

/// "SigBlk" or "SigIgn" of a helper that tells its own, as the kernel writes them.
std::string signals_of_helper(const std::string& key) {
    auto helper = HelperProcess::start("/bin/cat", {"/proc/self/status"}, HelperPipe::its_output);
    EXPECT_TRUE(helper) << helper.error();
    std::string text;
    std::array<char, 4096> bytes{};
    for (ssize_t n = 0; (n = ::read(helper->descriptor(), bytes.data(), bytes.size())) > 0;)
        text.append(bytes.data(), static_cast<std::size_t>(n));
    const std::size_t at = text.find(key + ":\t");
    EXPECT_NE(at, std::string::npos);
    return text.substr(at + key.size() + 2, 16);
}

TEST_F(HelperProcessTest, inherits_no_blocked_and_no_ignored_signal) {
    sigset_t all;
    sigset_t before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const auto ignored_before = std::signal(SIGPIPE, SIG_IGN);
    // The first 31; two of the rest are the C library's own.
    constexpr unsigned long long kStandard = 0x7FFF'FFFF;
    EXPECT_EQ(std::stoull(signals_of_helper("SigBlk"), nullptr, 16) & kStandard, 0U);
    EXPECT_EQ(std::stoull(signals_of_helper("SigIgn"), nullptr, 16) & kStandard, 0U);
    std::signal(SIGPIPE, ignored_before);
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST_F(HelperProcessTest, has_its_last_complaint_kept_however_much_it_complains) {
    const auto program =
        scratch_.write("helper",
                       "#!/bin/sh\nif [ \"$1\" = much ]; then yes complaint | head -c 1000000 >&2; fi\n"
                       "echo first >&2; echo 'the reason' >&2; echo end\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    for (const char* how : {"little", "much"}) {
        auto helper = HelperProcess::start(program, {how}, HelperPipe::its_output, HelperComplaints::kept);
        ASSERT_TRUE(helper) << helper.error();
        std::array<char, 8> bytes{};
        EXPECT_EQ(::read(helper->descriptor(), bytes.data(), bytes.size()), 4) << "it waits for a reader";
        if (std::string(how) == "little") {
            EXPECT_EQ(helper->complaint(), "the reason");
        } else {
            EXPECT_EQ(helper->complaint().substr(0, 4), "comp");
        }
        EXPECT_EQ(helper->complaint(), "");
    }
}

TEST_F(HelperProcessTest, reads_nothing_of_our_input_and_orders_our_terminal_nothing) {
    auto helper = start("readlink /proc/self/fd/0; printf 'forged\\033[2J\\n' >&2");
    ASSERT_TRUE(helper) << helper.error();
    std::string text(10, ' ');
    EXPECT_EQ(::read(helper->descriptor(), text.data(), text.size()), 10);
    EXPECT_EQ(text, "/dev/null\n");
    testing::internal::CaptureStderr();
    EXPECT_EQ(helper->wait(5s), std::nullopt);
    const std::string shown = testing::internal::GetCapturedStderr();
    EXPECT_NE(shown.find(": forged\\x1b[2J\n"), std::string::npos) << shown;
    EXPECT_EQ(shown.find('\x1b'), std::string::npos);
}

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

TEST_F(HelperProcessTest, names_the_limit_that_was_reached) {
    EXPECT_EQ(start("kill -XCPU $$")->wait(5s), "it needs more than 5 s of processor time for a frame");
    EXPECT_EQ(start("exit 70")->wait(5s), "it needs more than 2048 MiB of memory");
}

TEST_F(HelperProcessTest, is_killed_when_it_does_not_end_in_time) {
    auto helper = start("exec sleep 100");
    ASSERT_TRUE(helper) << helper.error();
    EXPECT_EQ(helper->wait(20ms), "did not end in time");
}

TEST_F(HelperProcessTest, that_is_not_there_is_an_error_with_its_name) {
    const auto helper = HelperProcess::start(scratch_ / "absent", {"x"}, HelperPipe::its_output);
    ASSERT_FALSE(helper);
    EXPECT_NE(helper.error().find("absent"), std::string::npos);
    const auto nowhere = find_helper("octoskin-no-such-helper");
    ASSERT_FALSE(nowhere);
    EXPECT_EQ(nowhere.error(),
              "octoskin-no-such-helper is neither beside this program nor in libexec: build "
              "octoskin_programs, or install octoskin again");
    EXPECT_EQ(find_helper("octoskin-no-such-helper", "another").value(), "another");
}

}  // namespace
}  // namespace octoskin::openni2
