#include "host/core/time/bus_time.hpp"

#include <gtest/gtest.h>

namespace octoskin {
namespace {

HostTime ms(std::int64_t value) {
    return {value * 1'000'000};
}

TEST(BusTime, goes_on_from_the_newest_frame_however_late_that_was_read) {
    BusTime time;
    time.on_frame(ms(7'000), ms(100'000));
    EXPECT_EQ(time.at(ms(7'000)), ms(100'000));
    EXPECT_EQ(time.at(ms(7'010)), ms(100'010));
    time.on_frame(ms(9'000), ms(100'100));
    EXPECT_EQ(time.at(ms(9'000)), ms(100'100)) << "1.9 s late";
}

TEST(BusTime, goes_on_when_the_bus_falls_silent) {
    BusTime time;
    time.on_frame(ms(7'000), ms(100'000));
    EXPECT_EQ(time.at(ms(67'000)), ms(160'000));
}

TEST(BusTime, is_unknown_while_nodes_speak_and_nobody_tells_the_time) {
    BusTime time;
    time.on_frame(ms(6'000), ms(100'000));
    time.on_frame(ms(7'000), std::nullopt);
    EXPECT_EQ(time.at(ms(7'000)), std::nullopt);
    EXPECT_EQ(time.at(ms(7'350)), std::nullopt);
    EXPECT_EQ(time.at(ms(7'351)), ms(101'351)) << "they fell silent: it is as it was last known";
    time.on_frame(ms(8'000), ms(161'000));
    EXPECT_EQ(time.at(ms(8'001)), ms(161'001)) << "of a host that was set a minute ahead";
}

TEST(BusTime, is_reckoned_from_the_newest_that_was_known_while_it_is_in_doubt) {
    BusTime time;
    EXPECT_EQ(time.reckoned_at(ms(5'000)), ms(5'000)) << "nobody ever spoke";
    time.on_frame(ms(5'500), std::nullopt);
    EXPECT_EQ(time.reckoned_at(ms(5'600)), ms(5'600)) << "it was never known";
    time.on_frame(ms(6'000), ms(100'000));
    EXPECT_EQ(time.reckoned_at(ms(6'100)), time.at(ms(6'100)));
    time.on_frame(ms(7'000), std::nullopt);
    time.on_frame(ms(96'000), std::nullopt);
    EXPECT_EQ(time.at(ms(96'000)), std::nullopt);
    EXPECT_EQ(time.reckoned_at(ms(96'000)), ms(190'000));
}

TEST(BusTime, is_reckoned_on_the_clock_that_was_set_from_the_frame_on_that_tells_it) {
    BusTime time;
    time.on_frame(ms(6'000), ms(100'000));
    time.on_frame(ms(7'000), std::nullopt);
    time.on_host_frame(ms(7'010), ms(3'700'000));
    EXPECT_EQ(time.reckoned_at(ms(7'020)), ms(3'700'010));
    EXPECT_EQ(time.at(ms(7'020)), std::nullopt) << "that is told by the next frame of a node";
    EXPECT_EQ(time.at(ms(7'351)), ms(3'700'341)) << "or by none: they fell silent";
    time.on_host_frame(ms(7'400), std::nullopt);
    EXPECT_EQ(time.reckoned_at(ms(7'400)), ms(3'700'390)) << "in doubt: as it was";
}

TEST(BusTime, is_that_of_the_host_that_tells_it_where_no_node_ever_spoke) {
    BusTime time;
    time.on_host_frame(ms(7'000), ms(3'700'000));
    EXPECT_EQ(time.at(ms(8'000)), ms(3'701'000));
    EXPECT_FALSE(time.has_fallen_silent(ms(8'000)));
}

TEST(BusTime, has_fallen_silent_350_ms_after_the_last_frame_and_not_before_the_first) {
    BusTime time;
    EXPECT_FALSE(time.has_fallen_silent(ms(60'000)));
    time.on_frame(ms(60'000), std::nullopt);
    EXPECT_FALSE(time.has_fallen_silent(ms(60'350)));
    EXPECT_TRUE(time.has_fallen_silent(ms(60'351)));
    time.on_frame(ms(70'000), ms(1'000));
    EXPECT_FALSE(time.has_fallen_silent(ms(70'000)));
}

TEST(BusTime, is_this_machines_where_nobody_ever_spoke) {
    BusTime time;
    EXPECT_EQ(time.at(ms(5'000)), ms(5'000));
    time.on_frame(ms(7'000), std::nullopt);
    EXPECT_EQ(time.at(ms(7'351)), ms(7'351));
}

}  // namespace
}  // namespace octoskin
