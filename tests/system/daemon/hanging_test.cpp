// What the daemon needs stops answering: what reads its log, its files, a program's descriptors. Mapping goes
// on.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <string>

#include "tests/support/held_opens.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

class HangingTest : public DaemonTest {
  protected:
    [[nodiscard]] bool maps_on() {
        const int before = readings_used(daemon_->status());
        return daemon_
            ->wait_until([before](const Json& now) { return readings_used(now) > before + 100; }, 10s)
            .has_value();
    }
};

TEST_F(HangingTest, maps_and_ends_while_no_line_of_its_log_is_taken) {
    ASSERT_EQ(::mkfifo((folder_ / "log").c_str(), 0600), 0);
    const int pipe = ::open((folder_ / "log").c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    const std::string filling(4096, '.');
    while (::write(pipe, filling.data(), filling.size()) > 0) {
    }
    start({"--no-camera", "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s));
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return has_problem(now, "log_stuck"); }, 10s))
        << daemon_->status()["problems"].dump();
    EXPECT_GT(daemon_->status()["log"]["waiting"].get<int>(), 0);
    EXPECT_GT(daemon_->status()["log"]["stuck_s"].get<double>(), 0.0);
    EXPECT_EQ(daemon_->status()["log"]["dropped"], 0);
    EXPECT_TRUE(maps_on());
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0);
    EXPECT_TRUE(std::filesystem::exists(daemon_->maps() / "fused.ot"));
    ::close(pipe);
}

/// What a network mount does whose server is gone.
TEST_F(HangingTest, maps_on_and_ends_while_the_maps_folder_does_not_answer) {
    start({"--no-camera", "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto is_saved = [](const Json& now) { return now["map"]["saved"].get<int>() > 0; };
    ASSERT_TRUE(daemon_->wait_until(is_saved, 10s)) << daemon_->log();
    std::optional<testing_support::HeldOpens> held(daemon_->maps());
    if (!*held) GTEST_SKIP() << "needs CAP_SYS_ADMIN";
    const auto is_silent = [](const Json& now) {
        return now["map"]["folder_silent_s"].is_number() && has_problem(now, "maps_folder_silent");
    };
    ASSERT_TRUE(daemon_->wait_until(is_silent, 20s)) << daemon_->status()["map"].dump();
    EXPECT_TRUE(maps_on());
    const int saved = daemon_->status()["map"]["saved"].get<int>();
    held.reset();
    const auto answers = [saved](const Json& now) {
        return now["map"]["folder_silent_s"].is_null() && now["map"]["saved"].get<int>() > saved + 1;
    };
    EXPECT_TRUE(daemon_->wait_until(answers, 10s)) << daemon_->status()["map"].dump();
    held.emplace(daemon_->maps());
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(8s), 73);
}

TEST_F(HangingTest, maps_on_while_the_files_of_a_reload_do_not_answer_and_obeys_it_when_they_do) {
    const auto rig_named = [this](const char* name) {
        return folder_.write("rig.yaml", std::string("extends: ") + kExperiment + "\nname: " + name + "\n");
    };
    const auto rig_file = rig_named("first");
    start({"--no-camera"}, rig_file);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    rig_named("second");
    std::optional<testing_support::HeldOpens> held(rig_file);
    if (!*held) GTEST_SKIP() << "needs CAP_SYS_ADMIN";
    daemon_->signal(SIGHUP);
    const auto is_read = [](const Json& now) {
        return now["reloads"]["reading_s"].is_number() && has_problem(now, "reload_silent");
    };
    ASSERT_TRUE(daemon_->wait_until(is_read, 10s)) << daemon_->status()["reloads"].dump();
    EXPECT_TRUE(maps_on());
    for (int i = 0; i < 3; ++i) daemon_->signal(SIGHUP);
    EXPECT_EQ(daemon_->status()["rig"], "first");
    held.reset();
    const auto are_obeyed = [](const Json& now) {
        return now["rig"] == "second" && now["reloads"]["unchanged"] == 1;
    };
    EXPECT_TRUE(daemon_->wait_until(are_obeyed, 10s)) << daemon_->status()["reloads"].dump();
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 1);
    EXPECT_TRUE(daemon_->status()["reloads"]["reading_s"].is_null());
}

}  // namespace
}  // namespace octoskin::test
