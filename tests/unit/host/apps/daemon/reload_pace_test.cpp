#include "host/apps/daemon/reload_pace.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

constexpr Nanoseconds kMs{1'000'000};

/// A SIGHUP each 1.25 ms, of which each that is obeyed changes something or does not; how many are.
int obeyed_in(Nanoseconds duration, bool has_changed) {
    ReloadPace pace;
    int obeyed = 0;
    for (Nanoseconds passed{0}; passed < duration; passed += 5 * kMs / 4) {
        pace.ask();
        if (!pace.is_due(HostTime{} + passed)) continue;
        pace.begin_reading();
        pace.obeyed(HostTime{} + passed, has_changed);
        ++obeyed;
    }
    return obeyed;
}

TEST(ReloadPace, obeys_the_first_at_once) {
    ReloadPace pace;
    EXPECT_FALSE(pace.is_due({}));
    EXPECT_TRUE(pace.ask());
    EXPECT_TRUE(pace.is_due({}));
    EXPECT_FALSE(pace.ask()) << "it is the second that waits";
}

TEST(ReloadPace, obeys_one_a_second_of_8000_in_10_s_and_fewer_where_each_changes_something) {
    EXPECT_EQ(obeyed_in(10'000 * kMs, false), 10);
    EXPECT_EQ(obeyed_in(10'000 * kMs, true), 3);
}

TEST(ReloadPace, obeys_the_last_once_more_when_its_time_has_come) {
    ReloadPace pace;
    pace.ask();
    pace.begin_reading();
    pace.obeyed({}, true);
    EXPECT_FALSE(pace.is_due(HostTime{} + 60'000 * kMs)) << "none came";
    EXPECT_TRUE(pace.ask());
    EXPECT_EQ(pace.wait(HostTime{} + 1'000 * kMs), 3'000 * kMs);
    EXPECT_FALSE(pace.is_due(HostTime{} + 3'999 * kMs));
    EXPECT_TRUE(pace.is_due(HostTime{} + 4'000 * kMs));
    pace.begin_reading();
    pace.obeyed(HostTime{} + 4'000 * kMs, false);
    EXPECT_FALSE(pace.is_due(HostTime{} + 60'000 * kMs)) << "both are obeyed";
    pace.ask();
    EXPECT_FALSE(pace.is_due(HostTime{} + 4'999 * kMs));
    EXPECT_TRUE(pace.is_due(HostTime{} + 5'000 * kMs));
}

TEST(ReloadPace, reads_the_files_once_more_for_all_that_came_while_they_were_read) {
    ReloadPace pace;
    pace.ask();
    pace.begin_reading();
    EXPECT_TRUE(pace.ask());
    EXPECT_FALSE(pace.ask());
    EXPECT_FALSE(pace.is_due(HostTime{} + 60'000 * kMs)) << "the files are being read";
    pace.obeyed(HostTime{} + 60'000 * kMs, false);
    EXPECT_TRUE(pace.is_due(HostTime{} + 61'000 * kMs));
    pace.begin_reading();
    pace.obeyed(HostTime{} + 61'000 * kMs, false);
    EXPECT_FALSE(pace.is_due(HostTime{} + 120'000 * kMs));
}

}  // namespace
}  // namespace octoskin
