#include "tests/support/i2c_device/fault_command.hpp"

#include <gmock/gmock.h>

namespace octoskin::test {
namespace {

sim::SensorFaults faults_of(const std::string& line) {
    const auto command = std::get<SensorFaultCommand>(parse_fault_command(line).value());
    EXPECT_EQ(command.sensor, "front");
    EXPECT_FALSE(command.is_brown_out);
    return command.faults;
}

TEST(FaultCommand, a_sensors_fault_is_the_only_one) {
    EXPECT_TRUE(faults_of("front absent").is_absent);
    EXPECT_TRUE(faults_of("front never_boots").never_boots);
    EXPECT_TRUE(faults_of("front wrong_id").has_wrong_id);
    EXPECT_TRUE(faults_of("front ignores_xshut").ignores_xshut);
    EXPECT_TRUE(faults_of("front freezes_stream").freezes_stream);
    EXPECT_TRUE(faults_of("front never_ready").never_ready);
    EXPECT_TRUE(faults_of("front always_ready").is_always_ready);
    EXPECT_EQ(faults_of("front status 0x44").device_status, 0x44);
    EXPECT_FALSE(faults_of("front never_ready").is_absent);
    EXPECT_FALSE(faults_of("front none").is_absent);
    EXPECT_EQ(faults_of("front none").device_status, std::nullopt);
}

TEST(FaultCommand, a_brown_out_happens_once) {
    const auto command = std::get<SensorFaultCommand>(parse_fault_command("front brown_out").value());
    EXPECT_TRUE(command.is_brown_out);
}

TEST(FaultCommand, a_buss_fault_has_a_count_a_position_and_perhaps_an_address) {
    const auto any = std::get<BusFaultCommand>(parse_fault_command("bus nack_byte 3 17").value()).fault;
    EXPECT_EQ(any.kind, sim::I2cFaultKind::nack_byte);
    EXPECT_EQ(any.first, 0U);
    EXPECT_EQ(any.count, 3U);
    EXPECT_EQ(any.position, 17U);
    EXPECT_EQ(any.address, std::nullopt);
    const auto one = std::get<BusFaultCommand>(parse_fault_command("bus stretch 1 0 0x30").value()).fault;
    EXPECT_EQ(one.kind, sim::I2cFaultKind::stretch);
    EXPECT_EQ(one.address, 0x30);
}

TEST(FaultCommand, refuses_what_it_does_not_understand) {
    for (const char* line :
         {"", "front", "front asleep", "front absent now", "front status", "front status 256",
          "front status -1", "front status 0x", "bus", "bus nack_address", "bus nack_address 1",
          "bus nack_address 1 x", "bus nack_address 1 0 256", "bus nack_address 1 0 0x30 1", "bus hum 1 0",
          "bus absent"}) {
        EXPECT_FALSE(parse_fault_command(line)) << line;
    }
}

}  // namespace
}  // namespace octoskin::test
