// Signals that come while the daemon begins, and the processor time that is left for its end.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "tests/support/held_opens.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class StartingTest : public DaemonTest {
  protected:
    /// Before it makes its sockets a daemon waits for this lock, 2 s at most.
    void start_and_hold() {
        const auto folder = OpenFolder::open(folder_.path(), FolderAccess::write);
        ASSERT_TRUE(folder);
        const FilePlace file(*folder, "control.lock");
        ASSERT_TRUE(file.create_new(0600));
        lock_ = FileLock::take(file, FileLock::Kind::exclusive);
        ASSERT_TRUE(lock_);
        start();
        std::this_thread::sleep_for(500ms);
    }
    std::optional<FileLock> lock_;
};

TEST_F(StartingTest, obeys_a_sighup_that_came_before_its_loop_runs_and_is_ended_by_no_stray_signal) {
    ASSERT_NO_FATAL_FAILURE(start_and_hold());
    for (const int signal : {SIGHUP, SIGUSR1, SIGUSR2, SIGRTMIN}) {
        daemon_->signal(signal);
        EXPECT_FALSE(daemon_->wait(20ms)) << signal;
    }
    lock_.reset();
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["reloads"]["unchanged"] == 1; }, 5s))
        << daemon_->log();
}

TEST_F(StartingTest, ends_as_ever_by_a_sigterm_that_came_before_its_loop_runs) {
    ASSERT_NO_FATAL_FAILURE(start_and_hold());
    daemon_->signal(SIGTERM);
    EXPECT_FALSE(daemon_->wait(100ms)) << "half-way";
    lock_.reset();
    EXPECT_EQ(daemon_->wait(8s), 0) << daemon_->log();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "control"));
    EXPECT_TRUE(std::filesystem::exists(daemon_->maps() / "fused.ot"));
}

TEST_F(StartingTest, is_ended_by_a_sigterm_though_a_file_that_it_begins_with_does_not_answer) {
    const auto rig_file = folder_.write("rig.yaml", std::string("extends: ") + kExperiment + "\n");
    std::optional<testing_support::HeldOpens> held(rig_file);
    if (!*held) GTEST_SKIP() << "needs CAP_SYS_ADMIN";
    start({"--no-camera"}, rig_file);
    std::this_thread::sleep_for(500ms);
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(10s), 128 + SIGTERM);
    held.reset();
    EXPECT_NE(daemon_->log().find("before it had begun"), std::string::npos) << daemon_->log();
}

/// `ulimit -t` sets the limit that kills, too.
TEST(ProcessorTime, is_left_for_the_last_save_where_its_limit_kills) {
    const testing_support::ScratchFolder folder;
    const auto control = folder / "control";
    std::atomic<bool> is_over = false;
    std::thread busy([&] {
        while (!is_over)
            if (!ask_daemon(control, "status")) std::this_thread::sleep_for(1ms);
    });
    const std::string command = "timeout 60 bash -c 'ulimit -t 2; exec " OCTOSKIN_PROGRAM " run --rig " +
                                std::string(kExperiment) + " --can nocan9 --no-camera --maps " +
                                (folder / "maps").string() + " --socket " + control.string() + "' 2> " +
                                (folder / "log").string();
    const int status = std::system(command.c_str());
    is_over = true;
    busy.join();
    EXPECT_EQ(WEXITSTATUS(status), 71) << testing_support::ScratchFolder::read(folder / "log");
    EXPECT_TRUE(std::filesystem::exists(folder / "maps" / "fused.ot"));
}

}  // namespace
}  // namespace octoskin::test
