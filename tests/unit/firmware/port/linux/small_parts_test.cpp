// The clock, names of lines, the unique id, what a failure is called.
#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>
#include <thread>

#include "firmware/port/linux/gpio_lines.hpp"
#include "firmware/port/linux/node_clock.hpp"
#include "firmware/port/linux/start_failure.hpp"
#include "firmware/port/linux/unique_id.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::linux_port {
namespace {

TEST(NodeClock, places_a_stamp_by_its_age) {
    const ClockPair now{.node = {5'000'000}, .wall = {1'700'000'000'000'000'000}};
    EXPECT_EQ(node_time_of({now.wall.ns - 1'234'000}, now), NodeTime{5'000'000 - 1'234});
    EXPECT_EQ(node_time_of(now.wall, now), now.node);
}

TEST(NodeClock, places_a_stamp_over_the_wrap) {
    const ClockPair now{.node = {500}, .wall = {1'700'000'000'000'000'000}};
    EXPECT_EQ(node_time_of({now.wall.ns - 1'000'000}, now), NodeTime{4'294'966'796});
}

TEST(NodeClock, takes_a_stamp_of_a_stepped_wall_clock_for_now) {
    const ClockPair now{.node = {5'000'000}, .wall = {1'700'000'000'000'000'000}};
    EXPECT_EQ(node_time_of({now.wall.ns + 1}, now), now.node);
    EXPECT_EQ(node_time_of({now.wall.ns - 3'600'000'000'000}, now), now.node);
}

TEST(NodeClock, reads_both_clocks_together) {
    const NodeTime before = node_now();
    const ClockPair pair = read_clocks();
    const NodeTime after = node_now();
    EXPECT_GE(elapsed(before, pair.node).count(), 0);
    EXPECT_GE(elapsed(pair.node, after).count(), 0);
}

TEST(LineNames, are_a_chip_and_its_lines) {
    const std::vector<LineName> expected{{"gpiochip0", 17}, {"gpiochip0", 4}};
    EXPECT_EQ(parse_lines("gpiochip0:17,4"), expected);
    EXPECT_EQ(parse_lines("/dev/gpiochip1:0"), (std::vector<LineName>{{"/dev/gpiochip1", 0}}));
    EXPECT_EQ(text(expected[0]), "gpiochip0:17");
}

TEST(LineNames, refuse_everything_else) {
    for (const char* wrong :
         {"", "gpiochip0", "gpiochip0:", ":17", "gpiochip0:17,", "gpiochip0:,17", "gpiochip0:-1",
          "gpiochip0:1 7", "gpiochip0:17;18", "gpiochip0:99999999999", "gpiochip0:0x11"})
        EXPECT_EQ(parse_lines(wrong), std::nullopt) << wrong;
}

class UniqueId : public testing::Test {
  protected:
    std::optional<std::array<std::uint8_t, 12>> of(const std::string& machine_id,
                                                   const std::vector<std::string>& buses) {
        const auto file = folder_.path() / "machine-id";
        std::ofstream(file) << machine_id;
        return unique_id(buses, file);
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(UniqueId, is_the_machines_and_its_buses) {
    const std::string a(32, 'a');
    const std::string b(32, 'b');
    EXPECT_EQ(of(a, {"/dev/i2c-1"}), of(a, {"/dev/i2c-1"}));
    EXPECT_NE(of(a, {"/dev/i2c-1"}), of(b, {"/dev/i2c-1"}));
    EXPECT_NE(of(a, {"/dev/i2c-1"}), of(a, {"/dev/i2c-2"}));
    EXPECT_NE(of(a, {"/dev/i2c-1", "2"}), of(a, {"/dev/i2c-12"}));
}

TEST_F(UniqueId, does_not_tell_the_machines_id) {
    const auto uid = of("0123456789abcdef0123456789abcdef", {});
    ASSERT_TRUE(uid);
    EXPECT_NE((*uid)[0], 0x01);
    EXPECT_NE((*uid)[1], 0x23);
}

TEST_F(UniqueId, needs_a_machine_id) {
    EXPECT_EQ(of("", {}), std::nullopt);
    EXPECT_EQ(of("uninitialized", {}), std::nullopt);
    EXPECT_EQ(unique_id({}, folder_.path() / "nothing"), std::nullopt);
}

TEST(DeviceFailure, tells_a_missing_right_from_a_missing_device) {
    EXPECT_EQ(device_failure("/dev/i2c-1", EACCES).code, ExitCode::no_permission);
    EXPECT_EQ(device_failure("/dev/i2c-1", ENOENT).code, ExitCode::unavailable);
    EXPECT_EQ(device_failure("/dev/i2c-1", ENOENT).what.find("/dev/i2c-1: No such file or directory"), 0U);
}

}  // namespace
}  // namespace octoskin::linux_port
