#include "host/lab/study/parallel.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <stdexcept>
#include <string>

namespace octoskin {
namespace {

using Square = Result<std::size_t, std::string>;

TEST(Parallel, gives_the_results_in_order_for_any_number_of_jobs) {
    for (std::size_t count = 0; count < 20; ++count) {
        for (unsigned jobs = 0; jobs < 8; ++jobs) {
            const auto squares = work_in_parallel<std::size_t, std::string>(
                count, jobs, [](std::size_t i) { return Square(i * i); });
            ASSERT_TRUE(squares);
            ASSERT_EQ(squares->size(), count);
            for (std::size_t i = 0; i < count; ++i) EXPECT_EQ((*squares)[i], i * i) << count << ' ' << jobs;
        }
    }
}

TEST(Parallel, takes_results_that_cannot_be_copied) {
    using Only = std::unique_ptr<int>;
    const auto results = work_in_parallel<Only, std::string>(5, 2, [](std::size_t i) {
        return Result<Only, std::string>(std::make_unique<int>(static_cast<int>(i)));
    });
    ASSERT_TRUE(results);
    EXPECT_EQ(*results->back(), 4);
}

/// Waits until `wanted` callers are inside at once; false if they do not come.
class Meeting {
  public:
    explicit Meeting(std::size_t wanted) : wanted_(wanted) {}
    bool wait() {
        std::unique_lock lock(mutex_);
        ++present_;
        all_there_.notify_all();
        return all_there_.wait_for(lock, std::chrono::seconds(30), [&] { return present_ >= wanted_; });
    }

  private:
    std::mutex mutex_;
    std::condition_variable all_there_;
    std::size_t present_ = 0;
    std::size_t wanted_;
};

TEST(Parallel, works_on_as_many_at_once_as_there_are_jobs) {
    Meeting meeting(3);
    const auto met = work_in_parallel<bool, std::string>(
        3, 3, [&](std::size_t) { return Result<bool, std::string>(meeting.wait()); });
    EXPECT_EQ(*met, (std::vector<bool>{true, true, true}));
}

TEST(Parallel, never_works_on_more_at_once_than_there_are_jobs) {
    std::atomic<int> present{0};
    const auto counts = work_in_parallel<int, std::string>(200, 3, [&](std::size_t) {
        const int now = ++present;
        std::this_thread::yield();
        --present;
        return Result<int, std::string>(now);
    });
    for (const int now : *counts) EXPECT_LE(now, 3);
}

TEST(Parallel, begins_nothing_after_an_error) {
    std::size_t calls = 0;
    const auto result = work_in_parallel<int, std::string>(10, 1, [&](std::size_t i) {
        ++calls;
        return i == 3 ? Result<int, std::string>(unexpected(std::string("seed 3"))) : 0;
    });
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error(), "seed 3");
    EXPECT_EQ(calls, 4U);
}

TEST(Parallel, waits_for_what_is_under_way_when_an_error_comes) {
    std::atomic<bool> has_failed{false};
    std::atomic<bool> has_ended{false};
    Meeting both_began(2);
    const auto result =
        work_in_parallel<int, std::string>(2, 2, [&](std::size_t i) -> Result<int, std::string> {
            if (!both_began.wait()) return unexpected(std::string("never met"));
            if (i == 0) {
                has_failed = true;
                return unexpected(std::string("broken"));
            }
            while (!has_failed) std::this_thread::yield();
            has_ended = true;
            return 1;
        });
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error(), "broken");
    EXPECT_TRUE(has_ended);
}

TEST(Parallel, an_exception_reaches_the_caller_and_stops_the_rest) {
    std::size_t calls = 0;
    const auto throws = [&](unsigned jobs) {
        static_cast<void>(work_in_parallel<int, std::string>(1000, jobs, [&](std::size_t i) {
            if (jobs == 1) ++calls;
            if (i == 2) throw std::out_of_range("no room");
            return Result<int, std::string>(0);
        }));
    };
    EXPECT_THROW(throws(4), std::out_of_range);
    EXPECT_THROW(throws(1), std::out_of_range);
    EXPECT_EQ(calls, 3U);
}

}  // namespace
}  // namespace octoskin
