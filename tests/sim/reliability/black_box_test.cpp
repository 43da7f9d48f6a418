// A fault in the field becomes a unit test: a node with a sensor that fails, what it says about it as a
// candump log, the script that comes out of the log, and the driver that fails in the same way on the script.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "host/core/black_box/dump_assembler.hpp"
#include "host/core/black_box/transfer_script.hpp"
#include "host/io/candump/log_line.hpp"
#include "tests/sim/reliability/oracles.hpp"
#include "tests/support/i2c/scripted_i2c_bus.hpp"

namespace octoskin::test {
namespace {

/// The node's frames as a log's lines, and what `octoskin black-box` makes of them.
std::vector<std::string> scripts_of(const NodeRig& rig) {
    std::vector<std::string> scripts;
    DumpAssembler assembler;
    for (const wire::CanFrame& frame : rig.frames()) {
        const std::string line = candump::format_line({.stamp = {}, .interface = "can0", .frame = frame});
        const auto entry = candump::parse_line(std::string_view(line).substr(0, line.size() - 1));
        EXPECT_TRUE(entry);
        const auto decoded = wire::decode(entry->frame);
        const auto* piece = std::get_if<wire::BlackBox>(&decoded->message);
        if (piece == nullptr) continue;
        if (const auto dump = assembler.take(decoded->node_id, *piece)) {
            EXPECT_TRUE(dump->is_complete);
            scripts.push_back(transfer_script(*dump));
        }
    }
    EXPECT_TRUE(assembler.finish().empty());
    return scripts;
}

vl53l1x::Progress run(vl53l1x::Device& device) {
    for (std::uint32_t us = 0; us < 2'000'000; us += 1'000) {
        const vl53l1x::Progress progress = device.poll(NodeTime{us});
        if (progress != vl53l1x::Progress::busy) return progress;
    }
    return vl53l1x::Progress::busy;
}

TEST(BlackBox, of_a_sensor_with_a_wrong_id_makes_a_script_on_which_the_driver_fails_alike) {
    std::vector<SensorSetup> setups(1);
    setups[0].faults.has_wrong_id = true;
    NodeRig rig(fleet_config(1, 1), setups);
    rig.run_for(20 * kSecond);
    const auto scripts = scripts_of(rig);
    ASSERT_EQ(scripts.size(), 1U) << "the first failure, and no more within a minute";

    // The node asks whether anything is at 0x29, then at the sensor's own address, waits for the boot at
    // 0x29, and reads the identification.
    ScriptedI2cBus bus(scripts[0]);
    vl53l1x::Device device(bus, {});
    device.begin_probe(0x29);
    EXPECT_EQ(run(device), vl53l1x::Progress::failed);
    EXPECT_EQ(device.error(), vl53l1x::Error::no_answer);
    device.begin_probe(0x30);
    EXPECT_EQ(run(device), vl53l1x::Progress::failed);
    EXPECT_EQ(device.error(), vl53l1x::Error::no_answer);
    device.begin_await_boot_at_default(false);
    EXPECT_EQ(run(device), vl53l1x::Progress::done);
    device.begin_probe(0x29);
    EXPECT_EQ(run(device), vl53l1x::Progress::failed);
    EXPECT_EQ(device.error(), vl53l1x::Error::wrong_id);
    EXPECT_TRUE(bus.is_finished()) << "the script ends with the fault";
}

TEST(BlackBox, holds_what_led_to_a_sensor_that_stopped_answering_while_it_ranged) {
    NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
    rig.run_for(1'033 * kMillisecond);  // the last reading is one after which no register is read back
    const std::int64_t hurt_us = rig.now().us;
    rig.bus(0).inject(
        {.kind = sim::I2cFaultKind::nack_address, .first = rig.bus(0).transfer_count(), .count = 2});
    rig.run_for(30 * kSecond);
    const auto scripts = scripts_of(rig);
    ASSERT_EQ(scripts.size(), 1U);
    const Trace trace = parse_trace(scripts[0]);
    ASSERT_GE(trace.size(), 40U);
    ASSERT_LE(trace.size(), 64U);
    // The last two entries are the poll that failed and its retry; all before went well.
    for (std::size_t i = 0; i < trace.size(); ++i) {
        EXPECT_EQ(trace[i].error.has_value(), i + 2 >= trace.size()) << trace[i].text;
        EXPECT_EQ(trace[i].address, 0x30);
    }
    // A reading's worth of it, replayed: the driver reads the last result as the node did, then fails alike.
    std::size_t poll = trace.size() - 3;
    const auto is_ready_poll = [](const TraceEntry& entry) {
        return entry.write == std::vector<std::uint8_t>{0x00, 0x31} && entry.read.at(0) == 0x02;
    };
    while (poll > 0 && !is_ready_poll(trace[poll])) --poll;
    ASSERT_GT(poll, 0U) << "no reading in the record";
    ScriptedI2cBus bus("ADDRESS 30\n R 010F 2 -> EA CC");
    bus.expect(Trace(trace.begin() + static_cast<std::ptrdiff_t>(poll), trace.end()));
    vl53l1x::Device device(bus, {});
    device.begin_probe(0x30);
    ASSERT_EQ(run(device), vl53l1x::Progress::done);
    device.begin_read();
    ASSERT_EQ(run(device), vl53l1x::Progress::done);
    ASSERT_TRUE(device.has_measurement());
    const auto readings = rig.readings_of(0);
    const auto after = std::ranges::find_if(
        readings, [hurt_us](const SaidReading& said) { return said.end.us > hurt_us + 5'000; });
    EXPECT_EQ(device.measurement().range_mm, std::prev(after)->reading.range_mm);
    device.begin_read();
    EXPECT_EQ(run(device), vl53l1x::Progress::failed);
    EXPECT_EQ(device.error(), vl53l1x::Error::no_answer);
    EXPECT_TRUE(bus.is_finished());
}

TEST(BlackBox, comes_on_command_from_all_buses_that_have_sensors) {
    NodeRig rig(fleet_config(3, 2), std::vector<SensorSetup>(3));
    rig.run_for(1 * kSecond);
    EXPECT_TRUE(rig.said_of<wire::BlackBox>().empty());
    rig.send_from_host(wire::Command{.code = wire::CommandCode::send_black_box}, 5);
    rig.run_for(40 * kSecond);
    const auto scripts = scripts_of(rig);
    ASSERT_EQ(scripts.size(), 2U);
    for (const std::string& script : scripts) {
        for (const TraceEntry& entry : parse_trace(script)) EXPECT_FALSE(entry.error) << entry.text;
    }
    // Readings do not suffer from it.
    EXPECT_EQ(rig.node().counts().late + rig.node().counts().displaced, 0U);
    const auto times = rig.times_of<wire::BlackBox>();
    for (std::size_t i = 20; i < times.size(); ++i) EXPECT_GE(times[i].us - times[i - 20].us, 990'000);
}

}  // namespace
}  // namespace octoskin::test
