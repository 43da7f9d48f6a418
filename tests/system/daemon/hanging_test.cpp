// What the daemon needs stops answering: what reads its log, its files, a program's descriptors. Mapping goes
// on.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string>

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
    EXPECT_TRUE(
        daemon_->wait_until([](const Json& now) { return has_problem(now, "the log takes no line"); }, 10s))
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

}  // namespace
}  // namespace octoskin::test
