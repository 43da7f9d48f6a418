// What a driver sees of the part besides ranging: power, boot, addresses, the register index. Oracle: the
// datasheet (DS12385 rev 7) unless said otherwise.
#include <gtest/gtest.h>

#include "tests/support/vl53l1x/sensor_bench.hpp"

namespace octoskin::sim {
namespace {

using test::Bytes;

class PartOnBus : public testing::Test {
  protected:
    [[nodiscard]] bool answers(i2c::Address address) {
        return bench_.transfer(address, {0x01, 0x0F}, 2).has_value();
    }
    test::SensorBench bench_;
    SensorModel& part_ = bench_.add(test::wall_at(1.0), {.boot_time = Microseconds{1'200}});
    void boot() {
        bench_.set_xshut(part_, true);
        bench_.wait(Microseconds{1'300});
    }
};

TEST_F(PartOnBus, is_silent_while_xshut_is_low) {
    EXPECT_FALSE(answers(0x29));
    EXPECT_EQ(bench_.bus().error(), i2c::TransferError::nack_address);
}

TEST_F(PartOnBus, answers_only_once_it_has_booted) {
    bench_.set_xshut(part_, true);
    bench_.wait(Microseconds{1'100});
    EXPECT_FALSE(answers(0x29));
    bench_.wait(Microseconds{100});
    EXPECT_TRUE(answers(0x29));
}

TEST_F(PartOnBus, shows_its_reset_values) {
    boot();
    bench_.play(R"(
        R 0001 1 -> 29 | R 0006 2 -> BC 7A | R 0008 4 -> 81 80 07 95 | R 001E 6 -> 00 34 00 28 00 0D
        R 0024 2 -> 0A 00 | R 002E 4 -> 00 00 11 03 | R 0046 1 -> 20 | R 006C 4 -> 00 00 0E 10 | R 007F 1 -> C7
        R 00D8 1 -> 0B | R 00DE 2 -> 00 25 | R 00E5 1 -> 03 | R 010F 3 -> EA CC 10 | R 013E 1 -> C7
        R 0089 1 -> 00)");
}

TEST_F(PartOnBus, may_show_two_before_three_as_its_boot_state) {
    part_.set_faults({.status_two_for = Microseconds{3'000}});
    boot();
    EXPECT_EQ(bench_.read(0x00E5, 1), Bytes{0x02});
    bench_.wait(Microseconds{3'000});
    EXPECT_EQ(bench_.read(0x00E5, 1), Bytes{0x03});
}

TEST_F(PartOnBus, parts_differ_in_oscillator_and_optical_centre) {
    SensorModel& other = bench_.add(test::wall_at(1.0), {.osc_calibrate = 44, .optical_centre_spad = 197});
    bench_.set_xshut(other, true);
    bench_.wait(Microseconds{1'300});
    EXPECT_EQ(bench_.read(0x00DE, 2), (Bytes{0x00, 0x2C}));
    EXPECT_EQ(bench_.read(0x013E, 1), Bytes{0xC5});
}

TEST_F(PartOnBus, new_address_counts_from_the_next_start) {
    boot();
    bench_.write(0x0001, {0x2A});
    EXPECT_FALSE(answers(0x29));
    EXPECT_TRUE(answers(0x2A));
    EXPECT_EQ(bench_.read(0x0001, 1, 0x2A), Bytes{0x2A});
}

TEST_F(PartOnBus, forgets_its_address_and_settings_by_xshut) {
    boot();
    bench_.write(0x006C, {1, 2, 3, 4});
    bench_.write(0x0001, {0x2A});
    bench_.set_xshut(part_, false);
    EXPECT_FALSE(answers(0x29));
    EXPECT_FALSE(answers(0x2A));
    boot();
    EXPECT_EQ(bench_.read(0x006C, 4), (Bytes{0x00, 0x00, 0x0E, 0x10}));
}

TEST_F(PartOnBus, forgets_its_address_by_soft_reset_and_brown_out) {
    boot();
    bench_.write(0x0001, {0x2A});
    bench_.write(0x0000, {0x00}, 0x2A);
    EXPECT_FALSE(answers(0x2A)) << "in soft reset only the register that ends it answers";
    EXPECT_FALSE(bench_.transfer(0x2A, {0x00, 0x87, 0x40}, 0));
    EXPECT_FALSE(bench_.transfer(0x2A, {}, 1));
    EXPECT_FALSE(bench_.transfer(0x2A, {0x00, 0x00, 0x00, 0x55}, 0)) << "nor what follows it in a burst";
    bench_.write(0x0000, {0x01}, 0x2A);
    EXPECT_FALSE(answers(0x29)) << "it boots";
    bench_.wait(Microseconds{1'200});
    EXPECT_TRUE(answers(0x29));

    bench_.write(0x0001, {0x2A});
    part_.brown_out(bench_.time());
    bench_.wait(Microseconds{1'300});
    EXPECT_FALSE(answers(0x2A));
    EXPECT_TRUE(answers(0x29));
}

TEST_F(PartOnBus, soft_reset_shorter_than_100_us_does_not_end) {
    // A write of one byte takes 95 us, and its last byte comes 9 us before the end.
    boot();
    bench_.write(0x0000, {0x00});
    bench_.write(0x0000, {0x01});
    bench_.wait(Microseconds{2'000});
    EXPECT_FALSE(answers(0x29));
    bench_.write(0x0000, {0x01});
    bench_.wait(Microseconds{1'200});
    EXPECT_TRUE(answers(0x29));
}

TEST_F(PartOnBus, parts_may_forget_their_address_as_the_soft_reset_begins) {
    SensorModel& other = bench_.add(test::wall_at(1.0), {.forgets_address_as_soft_reset_begins = true});
    bench_.set_xshut(other, true);
    bench_.wait(Microseconds{1'300});
    bench_.write(0x0001, {0x2A});
    bench_.write(0x0000, {0x00}, 0x2A);
    bench_.wait(Microseconds{100});
    EXPECT_FALSE(bench_.transfer(0x2A, {0x00, 0x00, 0x01}, 0));
    bench_.write(0x0000, {0x01});
    bench_.wait(Microseconds{1'200});
    EXPECT_TRUE(answers(0x29));
}

TEST_F(PartOnBus, a_stuck_register_keeps_its_value_and_an_altered_one_does_not) {
    boot();
    part_.set_faults({.stuck_register = StuckRegister{.index = 0x004C, .value = 0x20}});
    bench_.write(0x004B, {0x0A, 0x21, 0x01});
    EXPECT_EQ(bench_.read(0x004B, 3), (Bytes{0x0A, 0x20, 0x01}));
    part_.alter_register(0x004B, 0x0B);
    EXPECT_EQ(bench_.read(0x004B, 1), Bytes{0x0B});
    bench_.write(0x004B, {0x0A});
    EXPECT_EQ(bench_.read(0x004B, 1), Bytes{0x0A});
}

TEST_F(PartOnBus, brown_out_does_not_lift_it_out_of_xshut) {
    part_.brown_out(bench_.time());
    bench_.wait(Microseconds{2'000});
    EXPECT_FALSE(answers(0x29));
}

TEST_F(PartOnBus, forgets_that_it_was_ranging) {
    for (const bool is_brown_out : {false, true}) {
        bench_.set_xshut(part_, false);
        boot();
        bench_.write(0x0087, {0x40});
        ASSERT_TRUE(bench_.await_ready(Microseconds{300'000}));
        if (is_brown_out) {
            part_.brown_out(bench_.time());
        } else {
            bench_.set_xshut(part_, false);
            bench_.set_xshut(part_, true);
        }
        bench_.wait(Microseconds{1'300});
        EXPECT_FALSE(bench_.await_ready(Microseconds{500'000}));
        EXPECT_EQ(bench_.read(0x0089, 1), Bytes{0x00});
    }
}

TEST_F(PartOnBus, index_advances_with_every_byte_written_and_read) {
    boot();
    bench_.write(0x0072, {0x01, 0x2C, 0x00, 0x64});
    EXPECT_EQ(bench_.read(0x0072, 4), (Bytes{0x01, 0x2C, 0x00, 0x64}));
    EXPECT_EQ(bench_.read(0x0074, 2), (Bytes{0x00, 0x64}));
}

TEST_F(PartOnBus, index_stays_for_a_read_of_its_own) {
    boot();
    EXPECT_TRUE(bench_.transfer(0x29, {0x01, 0x0F}, 0)) << "the index, then STOP";
    EXPECT_EQ(bench_.transfer(0x29, {}, 1), Bytes{0xEA});
    EXPECT_EQ(bench_.transfer(0x29, {}, 2), (Bytes{0xCC, 0x10})) << "and it goes on where it was";
}

TEST_F(PartOnBus, index_is_sixteen_bits_wide) {
    boot();
    bench_.write(0x0074, {0x12});
    bench_.write(0x0174, {0x34});
    EXPECT_EQ(bench_.read(0x0074, 1), Bytes{0x12});
    EXPECT_EQ(bench_.read(0xFFFF, 3), (Bytes{0x00, 0x00, 0x29})) << "wraps to 0x0000 and 0x0001";
}

TEST_F(PartOnBus, accepts_the_default_configuration_in_one_burst) {
    boot();
    Bytes burst;
    for (std::uint8_t i = 0; i < 91; ++i) burst.push_back(static_cast<std::uint8_t>(0x80U + i));
    burst[0x31 - 0x2D] = 0xFE;
    burst.back() = 0x00;
    bench_.write(0x002D, burst);
    const Bytes back = bench_.read(0x002D, 91);
    for (std::size_t i = 0; i < back.size(); ++i) {
        const std::size_t index = 0x2D + i;
        if (index == 0x31) {
            EXPECT_EQ(back[i] & 0xFE, 0xFE) << "bit 0 is the pin's level";
        } else if (index != 0x86) {
            EXPECT_EQ(back[i], burst[i]) << std::hex << index;
        }
    }
}

TEST_F(PartOnBus, identification_status_and_results_cannot_be_written) {
    boot();
    bench_.write(0x010F, {0, 0, 0});
    bench_.write(0x00E5, {0});
    bench_.write(0x0089, {0x09});
    bench_.play("R 010F 3 -> EA CC 10 | R 00E5 1 -> 03 | R 0089 1 -> 00");
}

TEST_F(PartOnBus, two_parts_at_the_default_address_answer_together) {
    boot();
    SensorModel& other = bench_.add(test::wall_at(2.0), {.osc_calibrate = 0x2A});
    bench_.set_xshut(other, true);
    bench_.wait(Microseconds{1'300});
    EXPECT_EQ(bench_.read(0x010F, 2), (Bytes{0xEA, 0xCC}));
    EXPECT_EQ(bench_.read(0x00DE, 2), (Bytes{0x00, 0x25 & 0x2A}));
    bench_.write(0x0001, {0x2A});
    EXPECT_FALSE(answers(0x29)) << "both have moved";
    EXPECT_EQ(bench_.read(0x00DE, 2, 0x2A), (Bytes{0x00, 0x25 & 0x2A}));
}

TEST_F(PartOnBus, faults_of_power_and_identity) {
    part_.set_faults({.has_wrong_id = true});
    boot();
    EXPECT_NE(bench_.read(0x010F, 2), (Bytes{0xEA, 0xCC}));
    part_.set_faults({.is_absent = true});
    EXPECT_FALSE(answers(0x29));
    part_.set_faults({.never_boots = true});
    bench_.set_xshut(part_, false);
    bench_.set_xshut(part_, true);
    bench_.wait(Microseconds{1'000'000});
    EXPECT_FALSE(answers(0x29));
    part_.set_faults({.ignores_xshut = true});
    bench_.set_xshut(part_, false);
    bench_.wait(Microseconds{2'000});
    EXPECT_TRUE(answers(0x29)) << "XSHUT is not wired";
}

TEST_F(PartOnBus, holds_sda_until_it_has_its_clocks_or_is_reset) {
    boot();
    part_.set_faults({.holds_sda_clocks = 9});
    EXPECT_TRUE(answers(0x29)) << "the bus gives nine clocks by itself";
    part_.set_faults({.holds_sda_clocks = 1'000});
    EXPECT_FALSE(answers(0x29));
    EXPECT_EQ(bench_.bus().error(), i2c::TransferError::bus_stuck);
    bench_.set_xshut(part_, false);
    EXPECT_TRUE(bench_.bus().recover());
    boot();
    EXPECT_TRUE(answers(0x29));
}

}  // namespace
}  // namespace octoskin::sim
