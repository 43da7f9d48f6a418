// A process of its own for each thing that a confined one tries.
#include "host/io/helper_limits/confinement.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "host/io/helper_limits/helper_limits.hpp"
#include "host/io/helper_limits/helper_words.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/system_call_filters.hpp"

namespace octoskin {
namespace {

/// The wait status of a process that does `action` and ends with its result.
int status_of(const std::function<int()>& action) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(action());
    int status = -1;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
}

int confined(const std::function<int()>& action) {
    return status_of([&] {
        (void)confine_this_process("test", NewThreads::allowed);
        return action();
    });
}

class ConfinementTest : public testing::Test {
  protected:
    void SetUp() override {
        if (const char* const why = testing_support::why_no_filters()) GTEST_SKIP() << why;
    }
    testing_support::ScratchFolder scratch_;
};

TEST_F(ConfinementTest, what_reads_a_file_does_not_need_ends_the_process) {
    struct Attempt {
        const char* name;
        std::function<void()> make;
    };
    const std::string file = (scratch_ / "made").string();
    const std::string there = scratch_.write("there", "x").string();
    const pid_t parent = ::getpid();
    const std::vector<Attempt> attempts{
        {"exec", [] { ::execl("/bin/true", "true", nullptr); }},
        {"fork", [] { (void)::fork(); }},
        {"socket", [] { (void)::socket(AF_INET, SOCK_STREAM, 0); }},
        {"open for writing", [&] { (void)::open(there.c_str(), O_WRONLY); }},
        {"open for both", [&] { (void)::open(there.c_str(), O_RDWR); }},
        {"create", [&] { (void)::open(file.c_str(), O_RDONLY | O_CREAT, 0600); }},
        {"truncate by open", [&] { (void)::open(there.c_str(), O_RDONLY | O_TRUNC); }},
        {"file without a name", [&] { (void)::open(file.c_str(), O_TMPFILE | O_RDWR, 0600); }},
        {"unlink", [&] { ::unlink(there.c_str()); }},
        {"rename", [&] { (void)::rename(there.c_str(), file.c_str()); }},
        {"mkdir", [&] { ::mkdir(file.c_str(), 0700); }},
        {"kill", [&] { ::kill(parent, 0); }},
        {"signal to a thread of another", [&] { ::syscall(SYS_tgkill, parent, parent, 0); }},
        {"ptrace", [&] { ::ptrace(PTRACE_ATTACH, parent, nullptr, nullptr); }},
        {"owner of a file's signals", [] { ::fcntl(STDERR_FILENO, F_SETOWN, 1); }},
        {"more memory than allowed",
         [] {
             const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
             ::setrlimit(RLIMIT_AS, &all);
         }},
        {"another system's calls", [] { ::syscall(0x4000'0000L + SYS_getpid); }},
    };
    for (const Attempt& attempt : attempts) {
        const int status = confined([&] {
            attempt.make();
            return 0;
        });
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << attempt.name << ": " << status;
    }
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_EQ(std::filesystem::file_size(there), 1U);
}

TEST_F(ConfinementTest, another_thread_is_confined_too) {
    const int status = status_of([] {
        std::thread other([] {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            (void)::socket(AF_INET, SOCK_STREAM, 0);
        });
        (void)confine_this_process("test", NewThreads::allowed);
        other.join();
        return 0;
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << status;
}

TEST_F(ConfinementTest, reading_writing_to_what_is_open_memory_and_threads_go_on) {
    const std::string file = scratch_.write("there", "text").string();
    std::array<int, 2> ends{-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    const int status = confined([&] {
        std::string text;
        std::ifstream(file) >> text;
        if (text != "text" || std::filesystem::file_size(file) != 4) return 1;
        std::size_t entries = 0;
        for (const auto& entry : std::filesystem::directory_iterator(scratch_ / ""))
            entries += entry.is_regular_file() ? 1U : 0U;
        if (entries != 1) return 2;
        int sum = 0;
        std::thread([&] { sum = 7; }).join();
        const std::vector<char> much(64U << 20U, 'x');
        if (sum != 7 || much.back() != 'x') return 3;
        try {
            throw std::runtime_error("thrown");
        } catch (const std::runtime_error&) {
            ++sum;
        }
        const rlimit processor{5, 6};
        if (::setrlimit(RLIMIT_CPU, &processor) != 0 || sum != 8) return 4;
        if (::send(ends[1], "a", 1, MSG_NOSIGNAL) != 1 || ::write(ends[1], "b", 1) != 1) return 5;
        return 0;
    });
    EXPECT_TRUE(WIFEXITED(status)) << status;
    EXPECT_EQ(WEXITSTATUS(status), 0);
    std::array<char, 3> got{};
    EXPECT_EQ(::read(ends[0], got.data(), got.size()), 2);
    for (const int end : ends) ::close(end);
}

TEST_F(ConfinementTest, a_thread_has_no_namespace_of_its_own_and_where_refused_there_is_none) {
    const auto clone_with = [](int flag) {
        return confined([flag] {
            ::syscall(SYS_clone, CLONE_VM | CLONE_SIGHAND | CLONE_THREAD | flag, nullptr, nullptr, nullptr,
                      0);
            return 0;
        });
    };
    for (const int flag : {CLONE_NEWNS, CLONE_NEWUTS, CLONE_NEWIPC, CLONE_NEWNET, CLONE_NEWUSER, CLONE_NEWPID,
                           CLONE_NEWCGROUP}) {
        const int status = clone_with(flag);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << flag << ": " << status;
    }
    const int status = status_of([] {
        (void)confine_this_process("test", NewThreads::refused);
        std::thread([] {}).join();
        return 0;
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS) << status;
}

TEST_F(ConfinementTest, looks_into_no_other_process_and_lifts_no_limit) {
    const bool has_landlock = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, 1) > 0;
    if (!has_landlock && ::geteuid() != 0) GTEST_SKIP() << "the kernel has no Landlock";
    const std::string parent = "/proc/" + std::to_string(::getpid());
    const int status = confined([&] {
        if (::open((parent + "/mem").c_str(), O_RDONLY) >= 0) return 1;
        std::string text;
        if (std::getline(std::ifstream(parent + "/environ"), text)) return 2;
        if (::open("/proc/self/status", O_RDONLY) < 0) return 3;
        return 0;
    });
    EXPECT_TRUE(WIFEXITED(status)) << status;
    EXPECT_EQ(WEXITSTATUS(status), 0);
    const int limited = status_of([] {
        bound_processor_seconds(7);
        (void)confine_this_process("test", NewThreads::allowed);
        allow_processor_seconds(1000);
        const rlimit all{RLIM_INFINITY, RLIM_INFINITY};
        ::setrlimit(RLIMIT_CPU, &all);
        rlimit now{};
        ::getrlimit(RLIMIT_CPU, &now);
        return now.rlim_max == 7 && now.rlim_cur == 6 ? 0 : 1;
    });
    EXPECT_TRUE(WIFEXITED(limited)) << limited;
    EXPECT_EQ(WEXITSTATUS(limited), 0);
}

TEST(HelperWordsTest, are_lines_that_order_a_terminal_nothing_and_are_not_taken_for_ours) {
    EXPECT_EQ(helper_lines("octoskin-x", "octoskin-x: is wrong\n\n12:00:00 info fine\x1b]0;title\x07\nend"),
              "octoskin-x: is wrong\noctoskin-x: 12:00:00 info fine\\x1b]0;title\\x07\noctoskin-x: end\n");
    EXPECT_EQ(helper_lines("octoskin-x", ""), "");
}

TEST_F(ConfinementTest, its_own_abort_is_an_abort) {
    const int status = confined([]() -> int { std::abort(); });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

/// As a kernel without filters, or a container that has none for its programs.
void refuse_filters() {
    std::array<sock_filter, 4> code{{{BPF_LD | BPF_W | BPF_ABS, 0, 0, offsetof(seccomp_data, nr)},
                                     {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, SYS_seccomp},
                                     {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ERRNO | EINVAL},
                                     {BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW}}};
    const sock_fprog program{static_cast<unsigned short>(code.size()), code.data()};
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

TEST_F(ConfinementTest, a_kernel_without_filters_is_a_warning) {
    std::array<int, 2> ends{-1, -1};
    ASSERT_EQ(::pipe(ends.data()), 0);
    const int status = status_of([&] {
        refuse_filters();
        ::dup2(ends[1], STDERR_FILENO);
        const bool is_confined = confine_this_process("octoskin-test", NewThreads::allowed);
        const int made = ::open((scratch_ / "made").c_str(), O_WRONLY | O_CREAT, 0600);
        return made >= 0 && !is_confined ? 0 : 1;
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
    ::close(ends[1]);
    std::array<char, 200> said{};
    const ssize_t count = ::read(ends[0], said.data(), said.size());
    EXPECT_EQ(
        std::string(said.data(), count > 0 ? static_cast<std::size_t>(count) : 0U).find("octoskin-test: "),
        0U);
    ::close(ends[0]);
}

}  // namespace
}  // namespace octoskin
