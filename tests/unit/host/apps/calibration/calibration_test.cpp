// The whole way of a calibration: the command's own code on a socket, real node core and driver, modelled
// sensors. What is found, written into the rig, makes the sensor range right.
#include "host/apps/calibration/calibration.hpp"

#include <gtest/gtest.h>

#include "tests/support/live/node_on_socket.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::calibrating {
namespace {

using test::fleet_config;
using test::NodeOnSocket;
using test::SensorSetup;

Question question(std::uint16_t target_mm, std::uint8_t sensor = 1) {
    return {.node_id = 5,
            .node_name = "n",
            .node_hash = node_hash(fleet_config(4, 2)),
            .sensor = sensor,
            .sensor_name = "s",
            .quantity = wire::CalibrationQuantity::offset,
            .target_mm = target_mm,
            .inter_measurement_ms = 33,
            .sequence = 1};
}

TEST(Calibrating, finds_the_offset_of_a_modelled_sensor_over_a_socket) {
    std::vector<SensorSetup> setups(4);
    setups[1].target =
        sim::RangingReturn{.range_m = 0.170, .sigma_m = 0.003, .peak_signal_mcps = 8.0, .ambient_mcps = 0.1};
    NodeOnSocket bus(fleet_config(4, 2), setups);
    Dialogue dialogue(question(140), bus.outside().now());
    const auto outcome = converse(dialogue, bus.host(), bus.outside());
    ASSERT_TRUE(outcome) << outcome.error().message();
    EXPECT_EQ(outcome->offset_quarter_mm, -68);
    EXPECT_EQ(edit_of(question(140), *outcome).key, "device_offset_mm");
    EXPECT_EQ(edit_of(question(140), *outcome).value, "-17.00");
    EXPECT_LT(bus.rig().now().us, 6'000'000);
}

TEST(Calibrating, tells_a_persons_mistakes_and_a_dead_node_apart) {
    NodeOnSocket bus(fleet_config(4, 2), std::vector<SensorSetup>(4));
    Dialogue no_such(question(140, 9), bus.outside().now());
    const auto refused = converse(no_such, bus.host(), bus.outside());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::failed);
    EXPECT_EQ(refused.error().error.code, ErrorCode::bad_argument) << refused.error().message();
    Question stranger = question(140);
    stranger.node_id = 6;
    Dialogue nobody(stranger, bus.outside().now());
    EXPECT_EQ(converse(nobody, bus.host(), bus.outside()).error().exit, ExitCode::unavailable);
}

rig::Rig bench() {
    const auto rig = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/bench_one_board.yaml");
    EXPECT_TRUE(rig) << rig.error().message();
    return *rig;
}

TEST(Calibrating, finds_node_and_sensor_by_name) {
    const auto question =
        question_of(bench(), {.node = "", .sensor = "back", .quantity = {}, .target_mm = 140}, 3);
    ASSERT_TRUE(question);
    EXPECT_EQ(question->node_id, 1);
    EXPECT_EQ(question->sensor, 2);
    EXPECT_EQ(question->node_hash, node_hash(bench().nodes[0].config));
    EXPECT_EQ(question->inter_measurement_ms, 20);
    const auto no_sensor =
        question_of(bench(), {.node = "1", .sensor = "top", .quantity = {}, .target_mm = 1}, 3);
    ASSERT_FALSE(no_sensor);
    EXPECT_EQ(no_sensor.error().error.code, ErrorCode::unknown_name);
    EXPECT_EQ(no_sensor.error().error.key, "--sensor");
    EXPECT_EQ(no_sensor.error().error.value, "'top'");
    EXPECT_NE(no_sensor.error().error.what.find("bench, which has front, left, back, right"),
              std::string::npos);
    const auto no_node =
        question_of(bench(), {.node = "x", .sensor = "back", .quantity = {}, .target_mm = 1}, 3);
    ASSERT_FALSE(no_node);
    EXPECT_EQ(no_node.error().error.code, ErrorCode::unknown_name);
    EXPECT_EQ(no_node.error().error.key, "--node");
    EXPECT_EQ(no_node.error().error.value, "'x'");
    EXPECT_NE(no_node.error().error.what.find("bench_one_board, which has bench"), std::string::npos);
}

TEST(Calibrating, writes_into_the_rig_and_leaves_mode_and_links_as_they_were) {
    using std::filesystem::perms;
    const testing_support::ScratchFolder folder;
    const auto file = folder.write(
        "rig.yaml", "extends: " OCTOSKIN_SOURCE_DIR
                    "/hw/rigs/bench_one_board.yaml\nname: mine\nnodes:\n"
                    "- name: bench\n  node_id: 1\n  board: " OCTOSKIN_SOURCE_DIR
                    "/hw/boards/nucleo_g474re.yaml\n  sensors:\n"
                    "  - {name: front, bus: 0, xshut_line: 0, address: 0x30, pose: {xyz_m: [0, 0, 0], "
                    "rpy_deg: [0, 0, 0]}}  # mine\n");
    std::filesystem::permissions(file, perms{0640});
    const auto link = folder / "link.yaml";
    std::filesystem::create_symlink("rig.yaml", link);
    const rig::SensorEdit edit{
        .node = "bench", .sensor = "front", .key = "device_offset_mm", .value = "-17.25"};
    const auto written = write_into_rig(link, edit);
    ASSERT_TRUE(written) << written.error().message();
    EXPECT_TRUE(std::filesystem::is_symlink(link));
    EXPECT_EQ(std::filesystem::status(file).permissions(), perms{0640});
    EXPECT_NE(testing_support::ScratchFolder::read(file).find("device_offset_mm: -17.25"), std::string::npos);
    EXPECT_NE(testing_support::ScratchFolder::read(file).find("# mine"), std::string::npos);
    EXPECT_EQ(folder.entries(), 2) << "nothing left beside it";
    const auto refused = write_into_rig(file, {.node = "bench", .sensor = "top", .key = "x", .value = "1"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
}

}  // namespace
}  // namespace octoskin::calibrating
