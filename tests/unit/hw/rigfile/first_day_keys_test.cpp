// The keys of a node for parts that are not as the public documents say, and the one that shuts it to
// commands: what they put into its configuration, what is refused, and that rigs without them keep their
// hashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hw/rigfile/i2c_load.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

class FirstDayKeys : public testing::Test {
  protected:
    /// A node of two sensors with these keys, one a line.
    Result<Rig, Error> read(const std::string& keys) {
        const std::string base = std::string(OCTOSKIN_SOURCE_DIR) + "/hw/rigs/bench_one_board.yaml";
        const std::string board = std::string(OCTOSKIN_SOURCE_DIR) + "/hw/boards/nucleo_g474re.yaml";
        const std::string sensor = "{bus: 0, pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]}, name: ";
        const auto file = folder_.write(
            "rig.yaml", "extends: " + base +
                            "\nnodes:\n  - name: bench\n    node_id: 1\n    board: " + board + "\n" + keys +
                            "    sensors:\n      - " + sensor + "a, xshut_line: 0, address: 0x30}\n      - " +
                            sensor + "b, xshut_line: 1, address: 0x31}\n");
        return read_rig(file);
    }
    NodeConfig config(const std::string& keys) {
        const auto rig = read(keys);
        if (!rig) throw std::runtime_error(rig.error().message());
        return rig->nodes.at(0).config;
    }
    Error error(const std::string& keys) { return error_in(read(keys)); }
    testing_support::ScratchFolder folder_;
};

TEST_F(FirstDayKeys, are_strict_quick_and_open_by_default) {
    const NodeConfig plain = config("");
    EXPECT_TRUE(plain.verifies_registers);
    EXPECT_EQ(plain.left_out_count, 0);
    EXPECT_EQ(plain.ready_jitter_us, 30);
    EXPECT_FALSE(plain.refuses_commands);
    EXPECT_EQ(config("    ready_jitter_us: 30\n    verification: {enabled: true, leave_out: []}\n"
                     "    refuses_commands: false\n"),
              plain);
    EXPECT_EQ(node_hash(config("    ready_jitter_us: 30\n")), node_hash(plain));
}

TEST_F(FirstDayKeys, leave_registers_out_in_the_order_of_their_numbers) {
    const NodeConfig some = config("    verification: {leave_out: [0x7C, 0x47, 8]}\n");
    EXPECT_TRUE(some.verifies_registers);
    ASSERT_EQ(some.left_out_count, 3);
    EXPECT_EQ(some.left_out[0], 0x08);
    EXPECT_EQ(some.left_out[1], 0x47);
    EXPECT_EQ(some.left_out[2], 0x7C);
    EXPECT_EQ(node_hash(some), node_hash(config("    verification: {leave_out: [8, 0x47, 0x7C]}\n")));
    EXPECT_FALSE(config("    verification: {enabled: false}\n").verifies_registers);
}

TEST_F(FirstDayKeys, refuse_registers_that_are_not_read_back_or_come_twice) {
    EXPECT_THAT(error("    verification: {leave_out: [0x31]}\n"),
                AllOf(file_is("rig.yaml"), line_is(6), key_is(HasSubstr("nodes[0].verification.leave_out")),
                      value_is(StartsWith("0x31"))));
    EXPECT_THAT(error("    verification: {leave_out: [0x86]}\n"),
                key_is(HasSubstr("nodes[0].verification.leave_out")));
    EXPECT_THAT(error("    verification: {leave_out: [0x47, 71]}\n"),
                AllOf(code_is(ErrorCode::duplicate), value_is("0x47 again")));
    std::string many;
    for (int index = 0x33; index < 0x33 + 33; ++index) many += std::to_string(index) + ", ";
    EXPECT_THAT(error("    verification: {leave_out: [" + many + "]}\n"),
                AllOf(code_is(ErrorCode::limit_exceeded), what_is(HasSubstr("at most 32")), value_is("33"),
                      remedy_is(HasSubstr("enabled: false"))));
    EXPECT_THAT(error("    verification: {leave: [0x47]}\n"),
                AllOf(code_is(ErrorCode::unknown_key), remedy_is(HasSubstr("enabled, leave_out"))));
}

TEST_F(FirstDayKeys, keep_the_jitter_within_what_a_node_can_follow) {
    EXPECT_EQ(config("    ready_jitter_us: 1000\n").ready_jitter_us, 1'000);
    EXPECT_THAT(error("    ready_jitter_us: 1001\n"),
                AllOf(code_is(ErrorCode::conflict), key_is("nodes[0].ready_jitter_us"),
                      what_is(HasSubstr("inter_measurement_ms of 20")), value_is("1001")));
    for (const char* outside : {"29", "2001"})
        EXPECT_THAT(error(std::string("    ready_jitter_us: ") + outside + "\n"),
                    AllOf(code_is(ErrorCode::out_of_range), key_is("nodes[0].ready_jitter_us")));
    EXPECT_EQ(config("    ready_jitter_us: 100\n    holds_phases: true\n").ready_jitter_us, 100);
    EXPECT_THAT(error("    ready_jitter_us: 101\n    holds_phases: true\n"),
                AllOf(code_is(ErrorCode::conflict), key_is("nodes[0].ready_jitter_us"),
                      what_is(HasSubstr("holds_phases")), value_is("101")));
}

// 518 bits a reading, and 48 for each further poll.
TEST_F(FirstDayKeys, plan_the_load_and_the_zones_pause_by_the_jitter) {
    const NodeConfig plain = config("");
    const NodeConfig some = config("    ready_jitter_us: 130\n");
    const NodeConfig wide = config("    ready_jitter_us: 1000\n");
    const auto further_polls = [&](const NodeConfig& node) {
        const double poll_s = 48.0 / 283'000.0;
        return (rig::reading_s(node, node.sensors[0]) - rig::reading_s(plain, plain.sensors[0])) / poll_s;
    };
    EXPECT_NEAR(further_polls(some), 2.0, 1e-6);
    EXPECT_NEAR(further_polls(wide), 4.0, 1e-6) << "1 ms in steps of 0.25 ms and a poll of 0.12 ms, and one";
    EXPECT_GE(zone_pause(wide, wide.sensors[0]) - zone_pause(plain, plain.sensors[0]), Microseconds{2'910});
}

TEST_F(FirstDayKeys, shut_a_node_to_commands) {
    EXPECT_TRUE(config("    refuses_commands: true\n").refuses_commands);
    EXPECT_NE(node_hash(config("    refuses_commands: true\n")), node_hash(config("")));
}

}  // namespace
}  // namespace octoskin::rig
