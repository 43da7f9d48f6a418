#include "host/apps/daemon/thread_faults.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <new>
#include <optional>
#include <stdexcept>

#include "host/apps/daemon/quiet_thread.hpp"

namespace octoskin {
namespace {

bool is_readable(const ThreadFaults& faults) {
    pollfd readable{faults.descriptor(), POLLIN, 0};
    return ::poll(&readable, 1, 0) == 1;
}

TEST(ThreadFaults, bring_what_ends_a_thread_to_the_loops_own) {
    ThreadFaults faults;
    faults.rethrow();
    EXPECT_FALSE(is_readable(faults));
    start_without_signals([] { throw std::bad_alloc(); }).join();
    ASSERT_TRUE(is_readable(faults));
    start_without_signals([] { throw std::runtime_error("a later one"); }).join();
    EXPECT_THROW(faults.rethrow(), std::bad_alloc);
    EXPECT_FALSE(is_readable(faults));
}

TEST(ThreadFaults, of_a_thread_that_is_left_behind_are_no_wait_for_its_end) {
    const ThreadFaults faults;
    LeavableThread thread([] { throw std::bad_alloc(); });
    EXPECT_TRUE(thread.end(Nanoseconds{10'000'000'000}));
    EXPECT_TRUE(is_readable(faults));
}

TEST(ThreadFaults, take_nothing_once_they_have_gone) {
    std::optional<ThreadFaults> faults;
    faults.emplace();
    faults.reset();
    try {
        throw std::bad_alloc();
    } catch (const std::bad_alloc&) {
        EXPECT_FALSE(ThreadFaults::tell());
    }
}

}  // namespace
}  // namespace octoskin
