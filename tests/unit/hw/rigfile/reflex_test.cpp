// What a rig's limits for REFLEX say to a person.
#include "hw/rigfile/reflex.hpp"

#include <gtest/gtest.h>

namespace octoskin::rig {
namespace {

using Lines = std::vector<std::string>;

/// One node "ring" with a sensor for each limit, all in one mode.
Rig rig_of(std::initializer_list<std::uint16_t> limits_mm, DistanceMode mode = DistanceMode::long_range) {
    Rig rig;
    Node& node = rig.nodes.emplace_back();
    node.name = "ring";
    for (const std::uint16_t limit_mm : limits_mm) {
        SensorConfig& config = node.config.sensors[node.config.sensor_count++];
        config.distance_mode = mode;
        config.reflex_below_mm = limit_mm;
        const char letter = static_cast<char>('a' + node.sensors.size());
        node.sensors.emplace_back().name = std::string(1, letter);
    }
    return rig;
}

TEST(Reflex, is_told_of_each_sensor_of_a_node) {
    EXPECT_EQ(reflex_lines(rig_of({0, 0}).nodes[0]), Lines{"no REFLEX: no sensor has a reflex_below_m"});
    EXPECT_EQ(reflex_lines(rig_of({0, 150, 80, 150}).nodes[0]),
              (Lines{"REFLEX below 0.15 m from b, d", "REFLEX below 0.08 m from c", "no REFLEX from a"}));
    EXPECT_EQ(reflex_lines(rig_of({1000}).nodes[0]), Lines{"REFLEX below 1 m from a"});
}

TEST(Reflex, limit_beyond_what_the_mode_measures_is_warned_of) {
    EXPECT_EQ(reflex_warnings(rig_of({0, 1'360}, DistanceMode::short_range)), Lines());
    EXPECT_EQ(reflex_warnings(rig_of({0, 1'361}, DistanceMode::short_range)),
              Lines{"node 'ring' sensor 'b': reflex_below_m 1.361 is more than mode short can measure, about "
                    "1.36 m: an object farther away sends no REFLEX"});
    EXPECT_EQ(reflex_warnings(rig_of({2'900}, DistanceMode::medium_range)), Lines());
    EXPECT_EQ(reflex_warnings(rig_of({2'901}, DistanceMode::medium_range)).size(), 1U);
    EXPECT_EQ(reflex_warnings(rig_of({3'600})), Lines());
    EXPECT_EQ(reflex_warnings(rig_of({3'601})).size(), 1U);
}

TEST(Reflex, limit_below_the_ranges_that_count_is_warned_of) {
    Rig rig = rig_of({0, 39, 40});
    rig.range_limits.min_m = 0.04;
    EXPECT_EQ(reflex_warnings(rig),
              Lines{"node 'ring' sensor 'b': reflex_below_m 0.039 is below range_limits.min_m, 0.04: only "
                    "ranges that the map does not trust send REFLEX"});
}

}  // namespace
}  // namespace octoskin::rig
