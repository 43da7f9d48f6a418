#include "host/core/ingest/fate_history.hpp"

#include <gtest/gtest.h>

#include <string>

namespace octoskin {
namespace {

void note(FateHistory& fates, std::size_t times, std::optional<ReadingReason> rejected) {
    for (std::size_t i = 0; i < times; ++i) fates.note(rejected);
}

TEST(FateHistory, tells_a_streak_once_31_of_32_were_rejected) {
    FateHistory fates;
    note(fates, 31, ReadingReason::status_fault);
    EXPECT_EQ(fates.streak(), std::nullopt) << "too few to tell";
    fates.note(std::nullopt);
    EXPECT_EQ(fates.streak(), ReadingReason::status_fault);
    note(fates, 1, std::nullopt);
    EXPECT_EQ(fates.streak(), std::nullopt);
    note(fates, 100, ReadingReason::below_range_min);
    EXPECT_EQ(fates.streak(), ReadingReason::below_range_min);
}

TEST(FateHistory, names_the_most_frequent_reason) {
    FateHistory fates;
    note(fates, 12, ReadingReason::below_range_min);
    note(fates, 20, ReadingReason::sigma_above_max);
    EXPECT_EQ(fates.streak(), ReadingReason::sigma_above_max);
}

// Each of the reasons, by name: what counts against a sensor is decided here, not by its place in a list.
TEST(FateHistory, blames_a_sensor_for_what_is_its_own) {
    const std::string own =
        " time_uncertain duplicate out_of_window too_soon too_young too_old sensor_misconfigured "
        "status_fault "
        "zone_unknown zone_not_in_rig not_finite below_range_min above_range_max sigma_above_max "
        "beam_not_valid outside_map cone_too_large ";
    for (std::size_t i = 0; i < names_of(ReadingReason{}).size(); ++i) {
        const std::string name = names_of(ReadingReason{}).at(i);
        FateHistory fates;
        note(fates, 64, static_cast<ReadingReason>(i));
        EXPECT_EQ(fates.streak().has_value(), own.find(" " + name + " ") != std::string::npos) << name;
    }
}

TEST(FateHistory, is_not_washed_out_by_what_others_lack_but_by_empty_space_and_the_robot) {
    FateHistory fates;
    note(fates, 32, ReadingReason::status_fault);
    note(fates, 100, ReadingReason::joints_missing);
    EXPECT_EQ(fates.streak(), ReadingReason::status_fault);
    note(fates, 1, ReadingReason::no_return);
    note(fates, 1, ReadingReason::self_hit);
    EXPECT_EQ(fates.streak(), std::nullopt);
}

}  // namespace
}  // namespace octoskin
