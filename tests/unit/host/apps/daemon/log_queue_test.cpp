// The log while nothing takes its lines. Oracle: what a sink got, which holds the writer for as long as a
// test wants.
#include "host/apps/daemon/log_queue.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;

class HeldSink final : public spdlog::sinks::sink {
  public:
    void log(const spdlog::details::log_msg& message) override {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return !is_held_; });
        lines_.emplace_back(message.payload.data(), message.payload.size());
        changed_.notify_all();
    }
    void flush() override {}
    void set_pattern(const std::string&) override {}
    void set_formatter(std::unique_ptr<spdlog::formatter>) override {}

    void hold(bool is_held) {
        const std::lock_guard lock(mutex_);
        is_held_ = is_held;
        changed_.notify_all();
    }
    [[nodiscard]] bool has(std::size_t lines) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, 5s, [&] { return lines_.size() >= lines; });
    }
    [[nodiscard]] std::vector<std::string> lines() {
        const std::lock_guard lock(mutex_);
        return lines_;
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_held_ = false;
    std::vector<std::string> lines_;
};

class LogQueueTest : public testing::Test {
  protected:
    static constexpr std::size_t kRoom = 64 << 10;
    ~LogQueueTest() override { sink_->hold(false); }

    std::shared_ptr<HeldSink> sink_ = std::make_shared<HeldSink>();
    std::shared_ptr<LogQueue> queue_ =
        std::make_shared<LogQueue>(std::vector<spdlog::sink_ptr>{sink_}, kRoom, Nanoseconds{50'000'000});
    spdlog::logger log_{"test", queue_};
};

TEST_F(LogQueueTest, writes_each_line_in_its_order) {
    for (int i = 0; i < 100; ++i) log_.info("{}", i);
    ASSERT_TRUE(sink_->has(100));
    const auto lines = sink_->lines();
    for (int i = 0; i < 100; ++i) EXPECT_EQ(lines.at(static_cast<std::size_t>(i)), std::to_string(i));
    EXPECT_EQ(queue_->record().dropped, 0U);
}

TEST_F(LogQueueTest, waits_for_no_reader_and_tells_how_many_lines_it_dropped_once_it_can) {
    constexpr std::size_t kLines = 10'000;
    sink_->hold(true);
    const auto begun = std::chrono::steady_clock::now();
    log_.info("0");
    while (!queue_->record().stuck_since) std::this_thread::sleep_for(1ms);  // it makes room no more
    for (std::size_t i = 1; i < kLines; ++i) log_.info("{}", i);
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s);
    const LogRecord held = queue_->record();
    EXPECT_GT(held.dropped, 0U);
    EXPECT_LT(held.waiting, 1000U) << "64 KiB";
    EXPECT_TRUE(held.stuck_since);
    sink_->hold(false);
    const std::size_t kept = kLines - held.dropped;
    ASSERT_TRUE(sink_->has(kept + 1));
    log_.info("last");
    ASSERT_TRUE(sink_->has(kept + 2));
    const auto lines = sink_->lines();
    for (std::size_t i = 0; i < kept; ++i) EXPECT_EQ(lines.at(i), std::to_string(i)) << "the first are kept";
    EXPECT_EQ(lines.at(kept).rfind(std::to_string(held.dropped) + " lines are left out", 0), 0U)
        << lines.at(kept);
    EXPECT_EQ(lines.at(kept + 1), "last");
    EXPECT_EQ(queue_->record().dropped, held.dropped);
}

TEST_F(LogQueueTest, keeps_the_beginning_of_a_line_without_end) {
    log_.info("{}", std::string(40'000, 'x'));
    ASSERT_TRUE(sink_->has(1));
    EXPECT_EQ(sink_->lines().front(), std::string(LogQueue::kLineMax, 'x') + "... (40000 bytes)");
}

TEST_F(LogQueueTest, writes_what_waits_before_it_ends) {
    for (int i = 0; i < 100; ++i) log_.info("{}", i);
    log_.sinks().clear();
    queue_.reset();
    EXPECT_EQ(sink_->lines().size(), 100U);
}

TEST_F(LogQueueTest, leaves_a_write_that_hangs_behind_at_its_end) {
    sink_->hold(true);
    log_.info("a line");
    log_.sinks().clear();
    const auto begun = std::chrono::steady_clock::now();
    queue_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 2s);
    EXPECT_TRUE(sink_->lines().empty());
}

TEST(LogQueueDeathTest, writes_what_waits_before_a_defect_ends_the_process) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto crash = [](bool by_signal) {
        const auto log = guard_log();
        for (int i = 0; i < 50; ++i) spdlog::info("line {}", i);
        if (by_signal) std::abort();
        std::terminate();
    };
    EXPECT_EXIT(crash(true), testing::KilledBySignal(SIGABRT), "line 49");
    EXPECT_EXIT(crash(false), testing::KilledBySignal(SIGABRT), "line 49(.|\n)*a defect of octoskin");
#ifndef OCTOSKIN_SANITIZED  // which takes this signal itself, and waits for no log
    const auto crash_in_a_thread = [] {
        const auto log = guard_log();
        for (int i = 0; i < 50; ++i) spdlog::info("line {}", i);
        start_without_signals([] { (void)std::raise(SIGSEGV); }).join();
        std::exit(0);
    };
    EXPECT_EXIT(crash_in_a_thread(), testing::KilledBySignal(SIGSEGV), "line 49");
#endif
}

}  // namespace
}  // namespace octoskin
