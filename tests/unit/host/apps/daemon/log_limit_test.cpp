#include "host/apps/daemon/log_limit.hpp"

#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <algorithm>
#include <sstream>

namespace octoskin {
namespace {

class LogLimitTest : public testing::Test {
  protected:
    LogLimitTest() {
        log_.set_pattern("%l %v");
        log_.set_level(spdlog::level::debug);
    }
    /// What is written since the last time, in lines.
    long written() {
        const std::string text = text_.str();
        text_.str({});
        return std::ranges::count(text, '\n');
    }

    std::ostringstream text_;
    HostTime now_{1'000'000'000'000};
    spdlog::logger log_{
        "test", std::make_shared<LogLimit>(
                    std::vector<spdlog::sink_ptr>{std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)},
                    [this] { return now_; })};
};

TEST_F(LogLimitTest, passes_sixty_at_once_and_one_in_two_seconds_and_tells_how_many_it_left_out) {
    for (int i = 0; i < 1000; ++i) log_.warn("{}", i);
    EXPECT_EQ(written(), 60);
    now_ = now_ + LogLimit::kPeriod - Nanoseconds{1};
    log_.warn("too soon");
    EXPECT_EQ(written(), 0);
    now_ = now_ + Nanoseconds{1};
    log_.warn("next");
    EXPECT_EQ(text_.str(),
              "warning 941 lines are left out here, because there were too many; `octoskin status` lists the "
              "problems\nwarning next\n");
    text_.str({});
    now_ = now_ + 3 * LogLimit::kPeriod;
    for (int i = 0; i < 10; ++i) log_.warn("{}", i);
    EXPECT_EQ(written(), 3);
    now_ = now_ + 1000 * LogLimit::kPeriod;
    for (int i = 0; i < 1000; ++i) log_.warn("{}", i);
    EXPECT_EQ(written(), 61) << "sixty, and how many were left out before";
}

TEST_F(LogLimitTest, lets_no_level_take_the_room_of_another_and_the_worst_always_through) {
    for (int i = 0; i < 100; ++i) log_.warn("{}", i);
    EXPECT_EQ(written(), 60);
    log_.info("an info");
    log_.error("an error");
    EXPECT_EQ(text_.str(), "info an info\nerror an error\n");
    text_.str({});
    for (int i = 0; i < 100; ++i) log_.critical("{}", i);
    EXPECT_EQ(written(), 100);
}

}  // namespace
}  // namespace octoskin
