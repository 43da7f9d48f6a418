// The turns of a bring-up that need a neighbour's misbehaviour at one moment, transfer by transfer. Whole
// bring-ups: node_bring_up_test.cpp.
#include "firmware/core/bring_up.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "firmware/core/time_bracket.hpp"
#include "tests/support/i2c/scripted_i2c_bus.hpp"

namespace octoskin::node {
namespace {

using wire::SensorFault;

// Asked twice before "nobody" is believed. The sensor's own address is 0x30, so the parking address is 0x77.
const std::string kSilence29 = "ADDRESS 29 | R 010F 2 ! nack_address | R 010F 2 ! nack_address | ";
const std::string kSilence30 = "ADDRESS 30 | R 010F 2 ! nack_address | R 010F 2 ! nack_address | ";
const std::string kSilence77 = "ADDRESS 77 | R 010F 2 ! nack_address | R 010F 2 ! nack_address | ";
const std::string kAnswer29 = "ADDRESS 29 | R 010F 2 -> EA CC | ";
const std::string kAnswer30 = "ADDRESS 30 | R 010F 2 -> EA CC | ";
const std::string kBooted = "ADDRESS 29 | R 00E5 1 -> 03 | ";
const std::string kNobodyBoots = "ADDRESS 29 | R 00E5 1 ! nack_address | ";
const std::string kParked29 = "ADDRESS 29 | W 0001 77 | ADDRESS 77 | R 010F 2 -> EA CC | ";
const std::string kParked30 = "ADDRESS 30 | W 0001 77 | ADDRESS 77 | R 010F 2 -> EA CC | ";

class Line final : public XshutLines {
  public:
    void set(std::uint8_t line, bool is_high) override {
        EXPECT_EQ(line, 3);
        is_raised = is_high;
    }
    bool is_raised = true;
};

class BringUpTest : public testing::Test {
  protected:
    BringUpTest() { default_address_.reserve(config_.address); }

    static SensorConfig config() {
        SensorConfig config;
        config.address = 0x30;
        config.xshut_line = 3;
        return config;
    }
    /// What it fails with, on a bus that says this.
    SensorFault fault_on(const std::string& script) {
        bus_.expect(script);
        bring_up_.begin(now_);
        for (int turns = 0; turns < 1'000 && bring_up_.outcome() == BringUp::Outcome::under_way; ++turns) {
            const auto due = bring_up_.due();
            EXPECT_TRUE(due.has_value());
            now_ = later_of(now_ + Microseconds{10}, due.value_or(now_));
            static_cast<void>(bring_up_.advance(now_));
        }
        EXPECT_EQ(bring_up_.outcome(), BringUp::Outcome::failed);
        EXPECT_TRUE(bus_.is_finished());
        EXPECT_FALSE(line_.is_raised) << "in reset it cannot be taken for its neighbour";
        EXPECT_TRUE(default_address_.is_free());
        EXPECT_EQ(bring_up_.due(), std::nullopt);
        return bring_up_.fault();
    }

    const SensorConfig config_ = config();
    const vl53l1x::Options options_;
    const Policy policy_;
    test::ScriptedI2cBus bus_{""};
    vl53l1x::Device device_{bus_, options_};
    DefaultAddress default_address_{bus_, options_};
    Line line_;
    BringUp bring_up_{device_, default_address_, line_, config_, policy_};
    NodeTime now_{4'294'900'000};
};

TEST_F(BringUpTest, is_due_neither_before_it_begins_nor_while_another_has_the_default_address) {
    EXPECT_EQ(bring_up_.due(), std::nullopt);
    default_address_.hold(this);
    bring_up_.begin(now_);
    EXPECT_EQ(bring_up_.due(), std::nullopt);
    default_address_.release(this);
    EXPECT_EQ(bring_up_.due(), now_ + policy_.xshut_low);
}

TEST_F(BringUpTest, somebody_who_comes_to_0x29_meanwhile_is_a_conflict) {
    EXPECT_EQ(fault_on(kSilence29 + kSilence30 + kBooted + kAnswer29 + "ADDRESS 29 | W 0001 30 | " +
                       kAnswer30 + kAnswer29),
              SensorFault::address_conflict);
}

TEST_F(BringUpTest, two_strays_are_parked_and_a_third_is_a_conflict) {
    EXPECT_EQ(fault_on(kAnswer29 + kParked29 + kAnswer29 + kParked29 + kAnswer29),
              SensorFault::address_conflict);
}

TEST_F(BringUpTest, a_part_that_comes_back_to_its_own_address_from_every_parking_is_stuck) {
    EXPECT_EQ(fault_on(kSilence29 + kAnswer30 + kParked30 + kAnswer30 + kParked30 + kAnswer30),
              SensorFault::xshut_stuck);
}

TEST_F(BringUpTest, a_stray_that_does_not_let_itself_be_moved_is_a_conflict) {
    EXPECT_EQ(fault_on(kAnswer29 + "ADDRESS 29 | W 0001 77 ! nack_address | W 0001 77 ! nack_address"),
              SensorFault::address_conflict);
    EXPECT_EQ(fault_on(kAnswer29 + "ADDRESS 29 | W 0001 77 | ADDRESS 77 | R 010F 2 -> 00 00"),
              SensorFault::address_conflict);
}

TEST_F(BringUpTest, a_bus_that_fails_while_parking_or_watching_is_a_bus_error) {
    EXPECT_EQ(fault_on("R 010F 2 ! timeout | R 010F 2 ! timeout"), SensorFault::bus_error);
    EXPECT_EQ(fault_on(kAnswer29 + "ADDRESS 29 | W 0001 77 ! timeout | W 0001 77 ! timeout"),
              SensorFault::bus_error);
}

// The part was found at its own address in reset, and parked. Whoever answers there afterwards, be it
// distortedly, nobody comes when XSHUT rises.
TEST_F(BringUpTest, a_part_parked_from_its_own_address_that_does_not_come_is_stuck) {
    const std::string until_sought = kSilence29 + kAnswer30 + kParked30 + kSilence30;
    EXPECT_EQ(fault_on(until_sought + "ADDRESS 77 | R 010F 2 -> EA CC | " + kNobodyBoots + kSilence29),
              SensorFault::xshut_stuck);
    EXPECT_EQ(fault_on(until_sought + "ADDRESS 77 | R 010F 2 -> EE AC | " + kNobodyBoots + kSilence29),
              SensorFault::xshut_stuck);
}

TEST_F(BringUpTest, a_stray_is_taken_for_a_part_that_does_not_come_unless_that_part_came_since) {
    const std::string stray_is_parked = kAnswer29 + kParked29 + kSilence29 + kSilence30;
    const std::string stray_is_there = kSilence29 + kSilence30 + "ADDRESS 77 | R 010F 2 -> EA CC | ";
    const std::string parked_answers = "ADDRESS 77 | R 010F 2 -> EA CC | ";
    EXPECT_EQ(fault_on(stray_is_parked + parked_answers + kNobodyBoots + kSilence29),
              SensorFault::xshut_stuck);
    EXPECT_EQ(fault_on(stray_is_there + kBooted + kAnswer29 +
                       "ADDRESS 29 | W 0001 30 ! timeout | W 0001 30 ! timeout"),
              SensorFault::bus_error);
    EXPECT_TRUE(bring_up_.has_answered());
    EXPECT_EQ(fault_on(stray_is_there + kNobodyBoots + kSilence29), SensorFault::no_answer);
    EXPECT_FALSE(bring_up_.has_answered());
}

TEST_F(BringUpTest, a_part_that_is_no_longer_where_it_was_parked_and_does_not_come_is_absent) {
    EXPECT_EQ(
        fault_on(kSilence29 + kAnswer30 + kParked30 + kSilence30 + kSilence77 + kNobodyBoots + kSilence29),
        SensorFault::no_answer);
}

std::string polls(int count, const std::string& answer) {
    std::string script;
    for (int i = 0; i < count; ++i) script += "R 00E5 1 -> " + answer + " | ";
    return script;
}
constexpr int kPollsIn5Ms = 11;  // every 0.5 ms, and what the transfers take
constexpr int kPollsIn100Ms = 198;

// From bit 0 on, not from any answer: real parts say 0x02 first.
TEST_F(BringUpTest, no_address_is_written_before_the_boot_is_over) {
    const std::string until_boot = kSilence29 + kSilence30 + "ADDRESS 29 | ";
    EXPECT_EQ(fault_on(until_boot + polls(4, "02") + polls(1, "03") + kAnswer29 +
                       "ADDRESS 29 | W 0001 30 ! timeout | W 0001 30 ! timeout"),
              SensorFault::bus_error);
    EXPECT_FALSE(bring_up_.was_boot_late());
}

TEST_F(BringUpTest, a_boot_that_is_not_over_after_5_ms_is_told_and_waited_for_longer_the_next_time) {
    const std::string until_boot = kSilence29 + kSilence30 + "ADDRESS 29 | ";
    const std::string fails = kAnswer29 + "ADDRESS 29 | W 0001 30 ! timeout | W 0001 30 ! timeout";
    EXPECT_EQ(fault_on(until_boot + polls(kPollsIn5Ms, "02") + fails), SensorFault::bus_error);
    EXPECT_TRUE(bring_up_.was_boot_late());
    EXPECT_EQ(fault_on(until_boot + polls(30, "02") + polls(1, "03") + fails), SensorFault::bus_error);
    EXPECT_TRUE(bring_up_.was_boot_late()) << "for good";
    EXPECT_EQ(fault_on(until_boot + polls(kPollsIn100Ms, "00") + fails), SensorFault::bus_error);
}

}  // namespace
}  // namespace octoskin::node
