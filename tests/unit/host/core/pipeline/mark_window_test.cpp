#include "host/core/pipeline/mark_window.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

using wire::MarkKind;

bool take(MarkWindow& marks, MarkKind kind, std::uint64_t at_us) {
    return marks.take({kind, at_us});
}

TEST(MarkWindow, is_always_open_and_ignores_marks_unless_told_to_wait_for_one) {
    MarkWindow marks(MapBegin::first_usable);
    EXPECT_FALSE(take(marks, MarkKind::start, 10));
    EXPECT_FALSE(take(marks, MarkKind::stop, 20));
    EXPECT_TRUE(marks.contains({5'000}));
    EXPECT_TRUE(marks.contains({25'000}));
}

TEST(MarkWindow, takes_nothing_before_start_nor_after_stop_but_both_instants_themselves) {
    MarkWindow marks(MapBegin::start_mark);
    EXPECT_FALSE(marks.contains({10'000}));
    EXPECT_TRUE(take(marks, MarkKind::start, 10));
    EXPECT_FALSE(marks.contains({9'999}));
    EXPECT_TRUE(marks.contains({10'000}));
    EXPECT_TRUE(marks.contains({999'999'999'000}));
    EXPECT_TRUE(take(marks, MarkKind::stop, 20));
    EXPECT_TRUE(marks.contains({20'000}));
    EXPECT_FALSE(marks.contains({20'001}));
}

TEST(MarkWindow, opens_again_and_remembers_the_windows_before) {
    MarkWindow marks(MapBegin::start_mark);
    for (const std::uint64_t at_us : {10U, 30U, 50U}) {
        EXPECT_TRUE(take(marks, MarkKind::start, at_us));
        EXPECT_TRUE(take(marks, MarkKind::stop, at_us + 10));
    }
    for (const std::int64_t inside_us : {15, 35, 55}) {
        EXPECT_TRUE(marks.contains({inside_us * 1000}));
        EXPECT_FALSE(marks.contains({(inside_us + 10) * 1000}));
    }
}

TEST(MarkWindow, ignores_marks_that_change_nothing_or_go_back) {
    MarkWindow marks(MapBegin::start_mark);
    EXPECT_FALSE(take(marks, MarkKind::stop, 5)) << "nothing is open";
    EXPECT_TRUE(take(marks, MarkKind::start, 10));
    EXPECT_FALSE(take(marks, MarkKind::start, 12)) << "open already";
    EXPECT_FALSE(take(marks, MarkKind::stop, 9)) << "before it began";
    EXPECT_TRUE(take(marks, MarkKind::stop, 20));
    EXPECT_FALSE(take(marks, MarkKind::stop, 21));
    EXPECT_FALSE(take(marks, MarkKind::start, 19)) << "before the last one ended";
    EXPECT_TRUE(marks.contains({10'000}));
}

TEST(MarkWindow, forgets_the_oldest_of_many_windows) {
    MarkWindow marks(MapBegin::start_mark);
    for (std::uint64_t k = 0; k < 17; ++k) {
        EXPECT_TRUE(take(marks, MarkKind::start, 100 * k));
        EXPECT_TRUE(take(marks, MarkKind::stop, 100 * k + 50));
    }
    EXPECT_FALSE(marks.contains({0}));
    EXPECT_TRUE(marks.contains({100'000}));
    EXPECT_TRUE(marks.contains({1'650'000}));
}

}  // namespace
}  // namespace octoskin
