#include "host/core/counters/loss.hpp"

#include <gmock/gmock.h>

#include "host/core/counters/counter_meanings.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;

CounterTable readings(std::uint64_t used, std::vector<CounterTable::Row> rejected,
                      std::uint64_t pending = 0) {
    CounterTable table{.unit = "readings",
                       .in = used + pending,
                       .used = used,
                       .pending = pending,
                       .rejected = std::move(rejected),
                       .is_balanced = true};
    for (const CounterTable::Row& row : table.rejected) table.in += row.count;
    return table;
}

TEST(Loss, is_there_from_over_half_on_and_mendable_only_by_the_one_table) {
    for (const CounterMeaning& meaning : counter_meanings()) {
        CounterTable table = readings(5, {{std::string(meaning.name), 5}});
        table.unit = meaning.unit;
        EXPECT_FALSE(loss_of(table)) << meaning.name << ": half is not over half";
        table.rejected[0].count = 6;
        ++table.in;
        const auto loss = loss_of(table);
        if (meaning.cause == Cause::outside) {
            EXPECT_FALSE(loss) << meaning.name;
            continue;
        }
        ASSERT_TRUE(loss) << meaning.name;
        EXPECT_EQ(loss->is_mendable, meaning.cause == Cause::mendable) << meaning.name;
        EXPECT_EQ(loss->reason, meaning.name);
        EXPECT_EQ(loss->count, 6U);
        EXPECT_EQ(loss->of, 11U);
    }
}

TEST(Loss, counts_as_lost_only_what_could_have_been_used) {
    // 900 that the scene explains and 50 from before the clock was known do not hide that 6 of 11 are lost.
    const auto lost =
        loss_of(readings(5, {{"no_return", 900}, {"clock_not_ready", 50}, {"joints_missing", 6}}));
    ASSERT_TRUE(lost);
    EXPECT_TRUE(lost->is_mendable);
    EXPECT_EQ(lost->reason, "joints_missing");
    EXPECT_EQ(lost->rejected, 6U);
    EXPECT_EQ(lost->of, 11U);
    // And they make nothing of it a loss.
    const auto scene =
        loss_of(readings(6, {{"no_return", 900}, {"clock_not_ready", 50}, {"joints_missing", 5}}));
    ASSERT_TRUE(scene);
    EXPECT_FALSE(scene->is_mendable);
    EXPECT_EQ(scene->reason, "no_return");
    EXPECT_EQ(scene->of, 911U);
}

TEST(Loss, adds_reasons_up_and_names_the_most_frequent_with_its_first_place) {
    const auto loss =
        loss_of(readings(10, {{"duplicate", 4, "1.000000 s"}, {"late", 5, "2.500000 s"}, {"too_old", 2}}));
    ASSERT_TRUE(loss);
    EXPECT_EQ(loss->rejected, 11U);
    EXPECT_EQ(loss->reason, "late");
    EXPECT_EQ(loss->first, "2.500000 s");
    EXPECT_THAT(describe(*loss),
                HasSubstr("readings: 11 of 21 are lost, most as late (5, the first at 2.500000 s): "));
}

TEST(Loss, of_what_still_waits_is_none_yet) {
    EXPECT_FALSE(loss_of(readings(0, {{"late", 5}}, 5)));
    EXPECT_TRUE(loss_of(readings(0, {{"late", 5}}, 4)));
    EXPECT_FALSE(loss_of(readings(0, {})));
    EXPECT_FALSE(loss_of(readings(0, {{"late", 0}})));
}

TEST(Loss, a_counter_that_the_table_does_not_have_counts_as_mendable) {
    const auto loss = loss_of(readings(0, {{"new_reason", 1}}));
    ASSERT_TRUE(loss);
    EXPECT_TRUE(loss->is_mendable);
    EXPECT_EQ(describe(*loss), "readings: 1 of 1 are lost, most as new_reason (1)");
}

TEST(Loss, of_nothing_used_has_its_most_frequent_reason_whatever_explains_it) {
    const auto most = most_frequent(readings(0, {{"no_host_time", 7}, {"late", 3}}));
    ASSERT_TRUE(most);
    EXPECT_EQ(most->reason, "no_host_time");
    EXPECT_FALSE(most->is_mendable);
    EXPECT_FALSE(most_frequent(readings(3, {{"late", 0}})));
}

TEST(Loss, every_mendable_counter_has_a_remedy) {
    for (const CounterMeaning& meaning : counter_meanings()) {
        if (meaning.name == "bad_value") continue;  // of a pixel: nothing mends one
        EXPECT_TRUE(meaning.cause != Cause::mendable || !meaning.remedy.empty()) << meaning.name;
    }
}

}  // namespace
}  // namespace octoskin
