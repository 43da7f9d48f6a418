// What is typed, as commands for the bus.
#include "host/apps/command/order.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "common/wire/names.hpp"

namespace octoskin::commanding {
namespace {

using wire::CommandCode;

rig::Rig rig_of(const std::string& name) {
    const auto rig = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/" + name + ".yaml");
    EXPECT_TRUE(rig) << rig.error().message();
    return *rig;
}
Wish wish(const std::string& node, const std::string& code, const std::string& sensor = "") {
    return {.node = node, .code = code, .sensor = sensor, .period_ms = {}, .seconds = {}};
}
Error refusal_of(const rig::Rig* rig, const Wish& wish) {
    const auto orders = orders_of(rig, wish, 0);
    EXPECT_FALSE(orders);
    if (orders) return {};
    EXPECT_EQ(orders.error().exit, ExitCode::usage);
    return orders.error().error;
}
void expect_unknown(const Error& error, const std::string& key, const std::string& value,
                    const std::string& remedy) {
    EXPECT_EQ(error.code, ErrorCode::unknown_name) << error.message();
    EXPECT_EQ(error.key, key);
    EXPECT_EQ(error.value, value);
    EXPECT_NE(error.remedy.find(remedy), std::string::npos) << error.message();
}

TEST(CommandOrder, finds_nodes_and_sensors_by_name_and_by_number) {
    const rig::Rig bench = rig_of("bench_one_board");
    for (const std::string node : {"bench", "1", "all"}) {
        for (const std::string sensor : {"back", "2"}) {
            const auto orders = orders_of(&bench, wish(node, "stop", sensor), 77);
            ASSERT_TRUE(orders) << orders.error().message();
            ASSERT_EQ(orders->size(), 1U);
            const Order& order = orders->front();
            EXPECT_EQ(order.node_id, 1);
            EXPECT_EQ(order.command, (wire::Command{.code = CommandCode::stop, .sensor = 2, .sequence = 77}));
            EXPECT_EQ(order.whom(), "node 1 'bench'");
            EXPECT_EQ(order.known->node_hash, node_hash(bench.nodes[0].config));
            EXPECT_EQ(order.is_sensor_by_name, sensor == "back");
        }
    }
    const auto bare = orders_of(nullptr, wish("62", "start"), 3);
    ASSERT_TRUE(bare);
    EXPECT_EQ(bare->front().node_id, 62);
    EXPECT_EQ(bare->front().command.sensor, wire::kAllSensors);
    EXPECT_EQ(bare->front().whom(), "node 62");
}

TEST(CommandOrder, all_is_every_sensor_board_of_the_rig_and_not_its_joint_source) {
    const rig::Rig experiment = rig_of("experiment");
    ASSERT_EQ(experiment.nodes.size(), 2U);
    const auto orders = orders_of(&experiment, wish("all", "start"), 0);
    ASSERT_TRUE(orders);
    ASSERT_EQ(orders->size(), 2U);
    EXPECT_EQ(orders->at(0).node_id, experiment.nodes[0].config.node_id);
    EXPECT_EQ(orders->at(1).node_id, experiment.nodes[1].config.node_id);
}

TEST(CommandOrder, names_what_there_is_instead) {
    const rig::Rig bench = rig_of("bench_one_board");
    const Error no_node = refusal_of(&bench, wish("x", "stop"));
    expect_unknown(no_node, "", "'x'", "bench (1)");
    EXPECT_NE(no_node.what.find("bench_one_board"), std::string::npos);
    const Error no_sensor = refusal_of(&bench, wish("bench", "stop", "top"));
    expect_unknown(no_sensor, "--sensor", "'top'", "front, left, back, right");
    EXPECT_NE(no_sensor.what.find("node 1 'bench'"), std::string::npos);
    const std::string joints = std::to_string(bench.joint_sources.at(0).node_id);
    const Error joint_source = refusal_of(&bench, wish(joints, "stop"));
    EXPECT_EQ(joint_source.code, ErrorCode::bad_argument);
    EXPECT_EQ(joint_source.value, fmt::format("node {}, the rig's joint source", joints));
    for (const std::string node : {"bench", "all", "0", "63", "64", "256", "-1", "1x", ""}) {
        const Error error = refusal_of(nullptr, wish(node, "stop"));
        expect_unknown(error, "", "'" + node + "'", "--rig");
        EXPECT_NE(error.what.find("1 to 62"), std::string::npos);
    }
    for (const std::string sensor : {"63", "256", "front", "-1"})
        expect_unknown(refusal_of(nullptr, wish("1", "stop", sensor)), "--sensor", "'" + sensor + "'",
                       "--rig");
}

// An option that would mean nothing is a mistake of whoever typed it.
TEST(CommandOrder, takes_of_each_option_only_what_the_code_has) {
    for (const auto& [code, name] : wire::values_of(CommandCode{})) {
        const bool is_calibration =
            code == CommandCode::calibrate_offset || code == CommandCode::calibrate_crosstalk;
        const Wish plain = wish("1", name);
        const bool needs_period = code == CommandCode::set_rate;
        EXPECT_EQ(orders_of(nullptr, plain, 0).has_value(), !is_calibration && !needs_period) << name;
        if (needs_period) {
            EXPECT_EQ(refusal_of(nullptr, plain).key, "--period-ms");
        }
        Wish with_period = plain;
        with_period.period_ms = 100;
        const auto rate = orders_of(nullptr, with_period, 0);
        EXPECT_EQ(rate.has_value(), needs_period) << name;
        if (!rate && !is_calibration) {
            EXPECT_EQ(rate.error().error.key, "--period-ms") << name;
        }
        EXPECT_TRUE(!rate || rate->front().command.argument == 100);
        Wish with_seconds = plain;
        with_seconds.seconds = 30;
        const auto blink = orders_of(nullptr, with_seconds, 0);
        EXPECT_EQ(blink.has_value(), code == CommandCode::identify) << name;
        EXPECT_TRUE(!blink || blink->front().command.argument == 30);
        Wish with_sensor = wish("1", name, "0");
        if (needs_period) with_sensor.period_ms = 100;
        const bool is_of_the_node =
            code == CommandCode::identify || code == CommandCode::reset || code == CommandCode::send_info;
        EXPECT_EQ(orders_of(nullptr, with_sensor, 0).has_value(), !is_calibration && !is_of_the_node) << name;
    }
    EXPECT_EQ(orders_of(nullptr, wish("1", "identify"), 0)->front().command.argument, 10);
    const Error halt = refusal_of(nullptr, wish("1", "halt"));
    EXPECT_EQ(halt.code, ErrorCode::unknown_word);
    EXPECT_EQ(halt.value, "'halt'");
    EXPECT_NE(halt.remedy.find("start, stop, set_rate"), std::string::npos);
}

}  // namespace
}  // namespace octoskin::commanding
