// That the helpers are confined while they hand over what they read: it is not taken, so they wait.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "host/io/openni2/helper_process.hpp"
#include "host/io/openni2/oni_writer.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/system_call_filters.hpp"

namespace octoskin {
namespace {

/// Whether the program that these words start gets a filter for its system calls within 10 s.
/// `inherited`: its descriptor 3.
bool gets_a_filter(std::vector<std::string> command, int inherited = -1) {
    std::array<int, 2> ends{-1, -1};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    std::vector<char*> words;
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    const pid_t process = ::fork();
    if (process == 0) {
        ::dup2(ends[1], STDOUT_FILENO);
        if (inherited >= 0) {
            ::dup2(inherited, openni2::HelperProcess::kInherited);
            ::fcntl(openni2::HelperProcess::kInherited, F_SETFD, 0);  // also if it was that descriptor
        }
        ::execv(words.front(), words.data());
        ::_exit(127);
    }
    const auto has_filter = [process] {
        std::ifstream status("/proc/" + std::to_string(process) + "/status");
        for (std::string line; std::getline(status, line);) {
            if (line == "Seccomp:\t2") return true;
        }
        return false;
    };
    bool is_confined = false;
    for (int tries = 0; tries < 1000 && !is_confined; ++tries) {
        is_confined = has_filter();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
    for (const int end : ends) ::close(end);
    return is_confined;
}

class HelperConfinementTest : public testing::Test {
  protected:
    void SetUp() override {
        if (const char* const why = testing_support::why_no_filters()) GTEST_SKIP() << why;
    }
    static std::string helper(const char* name) { return openni2::find_helper(name).value().string(); }
};

TEST_F(HelperConfinementTest, what_reads_worlds) {
    EXPECT_TRUE(gets_a_filter(
        {helper("octoskin-world-read"), "1024", "20", OCTOSKIN_SOURCE_DIR "/hw/worlds/cupboard.sdf"}));
}

TEST_F(HelperConfinementTest, what_reads_meshes) {
    const testing_support::ScratchFolder scratch;
    constexpr std::uint32_t kTriangles = 20'000;  // more than a pipe takes
    std::string stl(80, ' ');
    stl.append(reinterpret_cast<const char*>(&kTriangles), 4);
    for (std::uint32_t i = 0; i < kTriangles; ++i) {
        const auto height = static_cast<float>(i);
        const std::array<float, 12> triangle{0, 0, 1, 0, 0, height, 1, 0, height, 0, 1, height};
        stl.append(reinterpret_cast<const char*>(triangle.data()), 48).append(2, '\0');
    }
    const int mesh = ::open(scratch.write("a.stl", stl).c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_GE(mesh, 0);
    EXPECT_TRUE(gets_a_filter({helper("octoskin-mesh-read"), "a.stl"}, mesh));
    ::close(mesh);
}

TEST_F(HelperConfinementTest, what_reads_recordings) {
    const testing_support::ScratchFolder scratch;
    constexpr openni2::FrameSize kSize{512, 424};
    auto writer = openni2::OniWriter::create(scratch / "depth.oni", scratch / "epoch.yaml", kSize);
    ASSERT_TRUE(writer);
    const std::vector<std::uint16_t> depth(kSize.pixels(), 1000);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(writer->write(HostTime{i * 100'000'000LL}, depth));
    ASSERT_TRUE(writer->close());
    EXPECT_TRUE(gets_a_filter({helper("octoskin-oni-read"), (scratch / "depth.oni").string()}));
    EXPECT_TRUE(gets_a_filter({helper("octoskin-camera"), (scratch / "depth.oni").string()}))
        << "as a camera";
}

}  // namespace
}  // namespace octoskin
