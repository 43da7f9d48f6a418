#include "host/apps/playback/pace.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

template <class Work>
Clock::duration time_of(const Work& work) {
    const auto begin = Clock::now();
    work();
    return Clock::now() - begin;
}

TEST(Pace, as_fast_as_it_goes_waits_for_nothing) {
    Pace pace;
    EXPECT_FALSE(pace.waits());
    EXPECT_LT(time_of([&] {
                  pace.wait(0);
                  pace.wait(3'600'000'000'000);
              }),
              1s);
}

TEST(Pace, waits_no_longer_because_those_before_were_late) {
    Pace pace = Pace::times(1.0);
    pace.wait(0);
    std::this_thread::sleep_for(50ms);
    EXPECT_LT(time_of([&] { pace.wait(40'000'000); }), 20ms) << "40 ms are over";
    EXPECT_GE(time_of([&] { pace.wait(120'000'000); }), 40ms) << "counted from the first, not the newest";
}

// A node that was silent for a day, a wall clock that was set.
TEST(Pace, begins_anew_where_the_time_leaps) {
    Pace pace = Pace::times(1.0);
    EXPECT_LT(time_of([&] {
                  pace.wait(0);
                  pace.wait(86'400'000'000'000);
                  pace.wait(86'400'000'000'000 + 1'000'000);
                  pace.wait(5);
                  pace.wait(1'000'005);
              }),
              1s);
}

TEST(Pace, by_step_asks_before_each) {
    std::vector<std::string> asked;
    Pace pace = Pace::by_step([&](const std::string& what) { asked.push_back(what); });
    EXPECT_TRUE(pace.waits());
    pace.wait(0, "one");
    pace.wait(3'600'000'000'000, "two");
    EXPECT_EQ(asked, (std::vector<std::string>{"one", "two"}));
}

}  // namespace
}  // namespace octoskin
