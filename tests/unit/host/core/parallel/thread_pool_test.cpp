#include "host/core/parallel/thread_pool.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>

namespace octoskin {
namespace {

TEST(ThreadPool, does_each_part_once_round_after_round) {
    for (unsigned size = 1; size <= 4; ++size) {
        ThreadPool pool(size);
        EXPECT_EQ(pool.size(), size);
        for (std::size_t round = 0; round < 200; ++round) {
            const std::size_t count = round % 40;
            std::array<std::atomic<int>, 40> done{};
            pool.work(count, [&](std::size_t index) { ++done.at(index); });
            for (std::size_t i = 0; i < done.size(); ++i)
                ASSERT_EQ(done[i], i < count ? 1 : 0) << size << " in round " << round;
        }
    }
}

/// Each of two parts ends only when the other has begun.
TEST(ThreadPool, works_on_parts_at_the_same_time) {
    ThreadPool pool(2);
    for (int round = 0; round < 20; ++round) {
        std::atomic<int> begun = 0;
        std::atomic<bool> is_in_time = true;
        pool.work(2, [&](std::size_t) {
            ++begun;
            const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
            while (begun < 2 && is_in_time) {
                if (std::chrono::steady_clock::now() > end) is_in_time = false;
            }
        });
        ASSERT_TRUE(is_in_time);
    }
}

TEST(ThreadPool, throws_what_a_part_threw_when_none_is_under_way_and_works_on) {
    for (unsigned size = 1; size <= 3; ++size) {
        ThreadPool pool(size);
        for (int round = 0; round < 50; ++round) {
            std::atomic<int> begun = 0;
            std::atomic<int> ended = 0;
            EXPECT_THROW(pool.work(1000,
                                   [&](std::size_t index) {
                                       ++begun;
                                       if (index == 3) throw std::runtime_error("three");
                                       ++ended;
                                   }),
                         std::runtime_error);
            EXPECT_EQ(begun, ended + 1);
            EXPECT_GE(ended, 3);
            std::atomic<int> after = 0;
            pool.work(10, [&](std::size_t) { ++after; });
            EXPECT_EQ(after, 10);
        }
    }
}

TEST(ThreadPool, that_never_worked_ends) {
    const ThreadPool pool(4);
}

}  // namespace
}  // namespace octoskin
