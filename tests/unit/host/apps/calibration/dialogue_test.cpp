// The host's half of a calibration against a scripted node: it asks only whom it should, believes only what
// answers its question, and always ends.
#include "host/apps/calibration/dialogue.hpp"

#include <gtest/gtest.h>

#include "common/wire/codec.hpp"
#include "common/wire/names.hpp"

namespace octoskin::calibrating {
namespace {

using wire::Calibration;
using wire::CalibrationOutcome;
using wire::CalibrationQuantity;

constexpr HostTime kStart{1'000'000'000'000};
constexpr std::uint32_t kHash = 0xABCD1234;

HostTime after_ms(std::int64_t ms) {
    return kStart + Nanoseconds{ms * 1'000'000};
}
Question question() {
    return {.node_id = 7,
            .node_name = "ring",
            .node_hash = kHash,
            .sensor = 3,
            .sensor_name = "left",
            .quantity = CalibrationQuantity::crosstalk,
            .target_mm = 600,
            .inter_measurement_ms = 33,
            .sequence = 9};
}
wire::CanFrame heartbeat(std::uint16_t hash_low = 0x1234, wire::NodeId id = 7) {
    return wire::encode(wire::Heartbeat{.state = wire::NodeState::ranging, .node_hash_low = hash_low}, id);
}
Calibration said(CalibrationOutcome outcome) {
    return {.sensor = 3,
            .quantity = CalibrationQuantity::crosstalk,
            .outcome = outcome,
            .sequence = 9,
            .offset_quarter_mm = 0,
            .crosstalk_raw = 512};
}
wire::CanFrame frame_of(const Calibration& calibration, wire::NodeId id = 7) {
    return wire::encode(calibration, id);
}
/// Heard a heartbeat at 10 ms, and asked.
Dialogue asked() {
    Dialogue dialogue(question(), kStart);
    dialogue.on_frame(heartbeat(), after_ms(10));
    (void)dialogue.take_frame();
    return dialogue;
}
Error failure(const Dialogue& dialogue) {
    if (dialogue.outcome() && !*dialogue.outcome()) return dialogue.outcome()->error().error;
    ADD_FAILURE() << "no error";
    return {};
}

TEST(CalibrationDialogue, asks_once_after_a_heartbeat_with_the_rigs_hash) {
    Dialogue dialogue(question(), kStart);
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);
    dialogue.on_frame(heartbeat(0x9999, 8), after_ms(5));  // another node's
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);
    dialogue.on_frame(heartbeat(), after_ms(10));
    const wire::Command expected{
        .code = wire::CommandCode::calibrate_crosstalk, .sensor = 3, .argument = 600, .sequence = 9};
    EXPECT_EQ(dialogue.take_frame(), wire::encode(expected, 7));
    dialogue.on_frame(heartbeat(), after_ms(110));
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);
    EXPECT_EQ(dialogue.outcome(), std::nullopt);
}

TEST(CalibrationDialogue, names_the_rigs_key_where_a_node_refuses_all_commands) {
    Dialogue dialogue = asked();
    dialogue.on_frame(wire::encode(wire::NodeInfo{wire::InfoFault{.kind = wire::FaultKind::watchdog}}, 7),
                      after_ms(12));
    EXPECT_EQ(dialogue.outcome(), std::nullopt);
    dialogue.on_frame(
        wire::encode(wire::NodeInfo{wire::InfoFault{.kind = wire::FaultKind::commands_refused}}, 7),
        after_ms(15));
    EXPECT_EQ(failure(dialogue).code, ErrorCode::no_permission);
    EXPECT_NE(failure(dialogue).remedy.find("refuses_commands"), std::string::npos);
}

TEST(CalibrationDialogue, ends_with_what_the_node_found) {
    Dialogue dialogue = asked();
    dialogue.on_frame(frame_of(said(CalibrationOutcome::under_way)), after_ms(20));
    EXPECT_TRUE(dialogue.is_under_way());
    EXPECT_EQ(dialogue.outcome(), std::nullopt);
    dialogue.on_frame(frame_of(said(CalibrationOutcome::done)), after_ms(3'000));
    ASSERT_TRUE(dialogue.outcome() && *dialogue.outcome());
    EXPECT_EQ(dialogue.outcome()->value().crosstalk_raw, 512);
    dialogue.on_time(after_ms(1'000'000));
    EXPECT_TRUE(*dialogue.outcome()) << "it has ended";
}

TEST(CalibrationDialogue, believes_no_answer_to_another_question) {
    Dialogue dialogue = asked();
    Calibration other = said(CalibrationOutcome::done);
    other.sensor = 2;
    dialogue.on_frame(frame_of(other), after_ms(20));
    other = said(CalibrationOutcome::done);
    other.quantity = CalibrationQuantity::offset;
    dialogue.on_frame(frame_of(other), after_ms(20));
    other = said(CalibrationOutcome::done);
    other.sequence = 8;
    dialogue.on_frame(frame_of(other), after_ms(20));
    dialogue.on_frame(frame_of(said(CalibrationOutcome::done), 8), after_ms(20));
    EXPECT_EQ(dialogue.outcome(), std::nullopt);
    Dialogue early(question(), kStart);
    early.on_frame(frame_of(said(CalibrationOutcome::done)), after_ms(20));
    EXPECT_EQ(early.outcome(), std::nullopt) << "nothing was asked yet";
}

TEST(CalibrationDialogue, names_each_way_to_fail) {
    for (const auto& [outcome, name] : wire::values_of(CalibrationOutcome{})) {
        if (outcome == CalibrationOutcome::done || outcome == CalibrationOutcome::under_way) continue;
        Dialogue dialogue = asked();
        dialogue.on_frame(frame_of(said(outcome)), after_ms(20));
        EXPECT_EQ(failure(dialogue).key, "node 7 'ring' sensor 3 'left'") << name;
        EXPECT_NE(failure(dialogue).code, ErrorCode::unsupported) << name << ": an unknown outcome";
        EXPECT_EQ(dialogue.outcome()->error().exit, ExitCode::failed);
    }
}

TEST(CalibrationDialogue, does_not_ask_a_node_of_another_configuration_or_version) {
    Dialogue dialogue(question(), kStart);
    dialogue.on_frame(heartbeat(0x1235), after_ms(10));
    EXPECT_EQ(failure(dialogue).code, ErrorCode::mismatch);
    EXPECT_EQ(failure(dialogue).value, "1235");
    EXPECT_NE(failure(dialogue).what.find("node_hash to be 1234"), std::string::npos);
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);

    // A heartbeat of version 2 with a checksum that is right for it: computed apart from the codec.
    Dialogue other(question(), kStart);
    wire::CanFrame frame = heartbeat();
    frame.data[0] = static_cast<std::uint8_t>((frame.data[0] & 0xF8U) | 2U);
    std::uint16_t crc = 0xFFFF;
    const auto add = [&crc](std::uint8_t byte) {
        crc = static_cast<std::uint16_t>(crc ^ (byte << 8U));
        for (int bit = 0; bit < 8; ++bit)
            crc = static_cast<std::uint16_t>((unsigned{crc} << 1U) ^ ((crc & 0x8000U) != 0 ? 0x1021U : 0U));
    };
    add(static_cast<std::uint8_t>(frame.can_id & 0xFFU));
    add(static_cast<std::uint8_t>(frame.can_id >> 8U));
    add(8);
    for (int i = 0; i < 6; ++i) add(frame.data.at(static_cast<std::size_t>(i)));
    frame.data[6] = static_cast<std::uint8_t>(crc >> 8U);
    frame.data[7] = static_cast<std::uint8_t>(crc & 0xFFU);
    other.on_frame(frame, after_ms(10));
    EXPECT_EQ(failure(other).code, ErrorCode::unsupported);
    EXPECT_EQ(failure(other).value, "2");
    EXPECT_NE(failure(other).what.find("protocol version 1"), std::string::npos);
}

// One lost frame, either way.
TEST(CalibrationDialogue, asks_the_same_again_if_no_answer_comes) {
    Dialogue dialogue(question(), kStart);
    dialogue.on_frame(heartbeat(), after_ms(10));
    const auto first = dialogue.take_frame();
    ASSERT_TRUE(first);
    dialogue.on_time(after_ms(1'009));
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);
    dialogue.on_time(after_ms(1'010));
    EXPECT_EQ(dialogue.take_frame(), first) << "a node that has begun already must not begin again";
    dialogue.on_frame(frame_of(said(CalibrationOutcome::under_way)), after_ms(1'020));
    dialogue.on_time(after_ms(2'100));
    EXPECT_EQ(dialogue.take_frame(), std::nullopt);
    EXPECT_TRUE(dialogue.is_under_way());
}

TEST(CalibrationDialogue, gives_up_at_once_a_node_whose_heartbeat_says_that_it_calibrates_nothing) {
    using wire::NodeState;
    for (const auto& [state, name] : wire::values_of(NodeState{})) {
        const bool is_hopeless = state == NodeState::safe || state == NodeState::bad_config ||
                                 state == NodeState::id_conflict || state == NodeState::bus_fault;
        const auto beat = [state = state](std::uint16_t hash_low) {
            return wire::encode(wire::Heartbeat{.state = state, .node_hash_low = hash_low}, 7);
        };
        Dialogue first(question(), kStart);
        first.on_frame(beat(state == NodeState::bad_config ? 0 : 0x1234), after_ms(10));
        EXPECT_EQ(first.take_frame().has_value(), !is_hopeless) << name;
        EXPECT_EQ(first.outcome().has_value(), is_hopeless) << name;
        Dialogue midway = asked();
        midway.on_frame(frame_of(said(CalibrationOutcome::under_way)), after_ms(100));
        midway.on_frame(beat(0x1234), after_ms(200));
        EXPECT_EQ(midway.outcome().has_value(), is_hopeless) << name;
        if (!is_hopeless) continue;
        EXPECT_NE(failure(first).what, "") << name;
        EXPECT_NE(failure(first).remedy, "") << name;
        EXPECT_EQ(failure(first).what.find("node_hash"), std::string::npos) << name;
        EXPECT_EQ(first.outcome()->error().exit, ExitCode::failed);
    }
}

TEST(CalibrationDialogue, every_wait_ends) {
    Dialogue silent(question(), kStart);
    silent.on_time(after_ms(1'999));
    EXPECT_EQ(silent.outcome(), std::nullopt);
    silent.on_time(after_ms(2'000));
    EXPECT_EQ(failure(silent).code, ErrorCode::no_answer);
    EXPECT_NE(failure(silent).what.find("heartbeat"), std::string::npos);

    Dialogue deaf = asked();
    deaf.on_time(after_ms(1'010));
    deaf.on_time(after_ms(2'010));
    deaf.on_time(after_ms(3'009));
    EXPECT_EQ(deaf.outcome(), std::nullopt);
    deaf.on_time(after_ms(3'010));
    EXPECT_EQ(failure(deaf).code, ErrorCode::no_answer);
    EXPECT_EQ(deaf.outcome()->error().exit, ExitCode::unavailable);

    Dialogue endless = asked();
    endless.on_frame(frame_of(said(CalibrationOutcome::under_way)), after_ms(100));
    endless.on_time(after_ms(100 + 14'290 - 1));
    EXPECT_EQ(endless.outcome(), std::nullopt);
    endless.on_time(after_ms(100 + 14'290));
    EXPECT_EQ(failure(endless).code, ErrorCode::time_limit);
}

}  // namespace
}  // namespace octoskin::calibrating
