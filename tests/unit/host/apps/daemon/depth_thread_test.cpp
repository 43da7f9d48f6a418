#include "host/apps/daemon/depth_thread.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace octoskin {
namespace {

using namespace std::chrono_literals;

bool is_readable(int descriptor, std::chrono::milliseconds patience) {
    pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
    return ::poll(&waited, 1, static_cast<int>(patience.count())) == 1;
}

TEST(DepthThread, works_beside_and_says_when_it_is_done) {
    DepthThread thread;
    EXPECT_TRUE(thread.is_done());
    EXPECT_FALSE(is_readable(thread.descriptor(), 0ms));
    std::atomic<bool> may_end = false;
    int result = 0;
    for (int i = 1; i <= 100; ++i) {
        may_end = false;
        thread.begin([&, i] {
            while (!may_end) std::this_thread::yield();
            result = i;
        });
        EXPECT_FALSE(thread.is_done());
        may_end = true;
        ASSERT_TRUE(is_readable(thread.descriptor(), 10s));
        thread.acknowledge();
        EXPECT_TRUE(thread.is_done());
        thread.finish();
        EXPECT_EQ(result, i) << "what it wrote is there for whoever waited";
    }
}

TEST(DepthThread, is_waited_for) {
    DepthThread thread;
    int result = 0;
    for (int i = 1; i <= 100; ++i) {
        thread.begin([&result, i] { result = i; });
        thread.finish();
        EXPECT_EQ(result, i);
    }
}

TEST(DepthThread, hands_over_what_was_thrown_and_goes_on) {
    DepthThread thread;
    thread.begin([] { throw std::runtime_error("a defect"); });
    EXPECT_THROW(thread.finish(), std::runtime_error);
    int result = 0;
    thread.begin([&] { result = 1; });
    thread.finish();
    EXPECT_EQ(result, 1);
}

TEST(DepthThread, ends_after_what_it_is_at) {
    std::atomic<bool> has_ended = false;
    {
        DepthThread thread;
        thread.begin([&] {
            std::this_thread::sleep_for(20ms);
            has_ended = true;
        });
    }
    EXPECT_TRUE(has_ended);
}

}  // namespace
}  // namespace octoskin
