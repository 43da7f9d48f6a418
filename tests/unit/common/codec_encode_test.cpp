// What encoding does with values that do not fit: saturate where documented, assert everywhere else.
#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "common/wire/codec.hpp"

namespace octoskin::wire {
namespace {

constexpr TimeResidue kNoon{.value_us = 64, .span_us = 1U << 18U};
constexpr TimeResidue kFdNoon{.value_us = 1, .span_us = 1U << 24U};

Range range_of(std::uint16_t range_mm, std::uint16_t sigma_quarter_mm) {
    return {.reading = {.range_mm = range_mm, .sigma_quarter_mm = sigma_quarter_mm, .capture = kNoon}};
}
RangeReading sent_and_heard(const Range& range) {
    const auto heard = decode(encode(range, 1));
    EXPECT_TRUE(heard);
    return std::get<Range>(heard->message).reading;
}

TEST(CodecEncode, classical_range_saturates_at_8191_mm) {
    EXPECT_EQ(sent_and_heard(range_of(8190, 0)).range_mm, 8190);
    EXPECT_EQ(sent_and_heard(range_of(8191, 0)).range_mm, 8191);
    EXPECT_EQ(sent_and_heard(range_of(8192, 0)).range_mm, 8191);
    EXPECT_EQ(sent_and_heard(range_of(65'535, 0)).range_mm, 8191);
}

TEST(CodecEncode, classical_sigma_is_rounded_up_to_whole_millimetres_and_saturates_at_127) {
    const std::array<std::array<std::uint16_t, 2>, 11> sent_then_heard = {{{0, 0},
                                                                           {1, 4},
                                                                           {3, 4},
                                                                           {4, 4},
                                                                           {5, 8},
                                                                           {504, 504},
                                                                           {505, 508},
                                                                           {508, 508},
                                                                           {509, 508},
                                                                           {512, 508},
                                                                           {65'535, 508}}};
    for (const auto& [sent, heard] : sent_then_heard) {
        EXPECT_EQ(sent_and_heard(range_of(0, sent)).sigma_quarter_mm, heard) << sent;
    }
}

TEST(CodecEncode, classical_capture_time_is_rounded_down_to_64_us) {
    Range range = range_of(0, 0);
    range.reading.capture.value_us = 127;
    EXPECT_EQ(sent_and_heard(range).capture, kNoon);
    range.reading.capture.value_us = (1U << 18U) - 1;
    EXPECT_EQ(sent_and_heard(range).capture.value_us, (1U << 18U) - 64);
}

TEST(CodecEncode, degraded_sensors_saturate_at_31) {
    for (const std::uint8_t sensors : std::to_array<std::uint8_t>({31, 32, 34, 255})) {
        const auto heard = decode(encode(Heartbeat{.degraded_sensors = sensors}, 1));
        ASSERT_TRUE(heard);
        EXPECT_EQ(std::get<Heartbeat>(heard->message).degraded_sensors, 31) << int{sensors};
    }
}

TEST(CodecEncode, fd_readings_beyond_the_count_are_not_sent) {
    RangeFd frame{.count = 1};
    frame.entries[0].reading.capture = kFdNoon;
    const CanFrame alone = encode(frame, 1);
    frame.entries[1].reading.range_mm = 99;
    EXPECT_EQ(encode(frame, 1), alone);
}

TEST(CodecEncode, every_message_goes_under_its_own_type) {
    const std::array<std::pair<Message, FrameType>, 15> types = {{{Range{}, FrameType::range},
                                                                  {RangeAux{}, FrameType::range_aux},
                                                                  {RangeFd{}, FrameType::range_fd},
                                                                  {Heartbeat{}, FrameType::heartbeat},
                                                                  {NodeInfo{}, FrameType::node_info},
                                                                  {SensorHealth{}, FrameType::sensor_health},
                                                                  {Sync{}, FrameType::sync},
                                                                  {FollowUp{}, FrameType::follow_up},
                                                                  {SyncReport{}, FrameType::sync_report},
                                                                  {JointState{}, FrameType::joint_state},
                                                                  {Mark{}, FrameType::mark},
                                                                  {Command{}, FrameType::command},
                                                                  {Reflex{}, FrameType::reflex},
                                                                  {BlackBox{}, FrameType::black_box},
                                                                  {Calibration{}, FrameType::calibration}}};
    for (const auto& [message, type] : types) {
        EXPECT_EQ(type_of(message), type) << message.index();
    }
}

class CodecEncodeDeathTest : public testing::Test {
  protected:
    CodecEncodeDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(CodecEncodeDeathTest, asserts_on_a_node_id_its_type_does_not_allow) {
    EXPECT_DEATH(static_cast<void>(encode(Sync{}, 1)), "is_allowed");
    EXPECT_DEATH(static_cast<void>(encode(Heartbeat{}, 0)), "is_allowed");
    EXPECT_DEATH(static_cast<void>(encode(Heartbeat{}, 63)), "is_allowed");
    EXPECT_DEATH(static_cast<void>(encode(Command{}, 0)), "is_allowed");
    EXPECT_DEATH(static_cast<void>(encode(Command{}, 64)), "is_allowed");
}

TEST_F(CodecEncodeDeathTest, asserts_on_a_number_out_of_its_range) {
    Range range = range_of(0, 0);
    range.reading.sensor = kAllSensors;
    EXPECT_DEATH(static_cast<void>(encode(range, 1)), "field.max");
    range.reading.sensor = 0;
    range.reading.zone = 16;
    EXPECT_DEATH(static_cast<void>(encode(range, 1)), "field.max");
    EXPECT_DEATH(static_cast<void>(encode(RangeFd{.count = 0}, 1)), "");
    EXPECT_DEATH(static_cast<void>(encode(RangeFd{.count = 5}, 1)), "");
    EXPECT_DEATH(static_cast<void>(encode(JointState(JointPair{.index = 3}), 1)), "field.max");
    EXPECT_DEATH(static_cast<void>(encode(JointState(JointPair{.position_urad = {8'388'608, 0}}), 1)),
                 "half");
    EXPECT_DEATH(static_cast<void>(encode(JointState(JointPair{.position_urad = {0, -8'388'609}}), 1)),
                 "half");
    EXPECT_DEATH(static_cast<void>(encode(FollowUp{.host_time_us = 1ULL << 48U}, 0)), "field.max");
}

TEST_F(CodecEncodeDeathTest, asserts_on_a_time_of_another_span_or_beyond_it) {
    Range range = range_of(0, 0);
    range.reading.capture = kFdNoon;
    EXPECT_DEATH(static_cast<void>(encode(range, 1)), "span_us");
    range.reading.capture = {.value_us = 1U << 18U, .span_us = 1U << 18U};
    EXPECT_DEATH(static_cast<void>(encode(range, 1)), "span_us");
}

TEST_F(CodecEncodeDeathTest, asserts_on_an_enumerator_that_does_not_exist) {
    EXPECT_DEATH(static_cast<void>(encode(Heartbeat{.reset_cause = static_cast<ResetCause>(6)}, 1)),
                 "is_known");
    EXPECT_DEATH(static_cast<void>(encode(Command{.code = static_cast<CommandCode>(0)}, 1)), "is_known");
}

}  // namespace
}  // namespace octoskin::wire
