#include "common/wire/frame_type.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "common/wire/bits.hpp"
#include "common/wire/names.hpp"

namespace octoskin::wire {
namespace {

TEST(FrameType, identifier_is_type_above_node_id) {
    EXPECT_EQ(can_id(FrameType::sync, 0), 0x040U);
    EXPECT_EQ(can_id(FrameType::range, 2), 0x202U);
    EXPECT_EQ(can_id(FrameType::black_box, 62), 0x7FEU);
    for (std::uint32_t id = 0; id <= kStandardIdMax; ++id) {
        EXPECT_EQ(can_id(type_of(id), node_of(id)), id);
    }
}

TEST(FrameType, reflex_wins_over_all_and_black_box_loses_to_all) {
    for (const FrameSpec& spec : kFrameSpecs) {
        if (spec.type != FrameType::reflex) {
            EXPECT_LT(can_id(FrameType::reflex, 63), can_id(spec.type, 0)) << spec.name;
        }
        if (spec.type != FrameType::black_box) {
            EXPECT_GT(can_id(FrameType::black_box, 0), can_id(spec.type, 63)) << spec.name;
        }
    }
}

TEST(FrameType, each_assigned_type_has_one_specification_in_order_of_priority) {
    for (std::size_t i = 0; i < kFrameSpecs.size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(kFrameSpecs.at(i).type), i + 1 < kFrameSpecs.size() ? i : 31);
        EXPECT_EQ(frame_spec(kFrameSpecs.at(i).type), &kFrameSpecs.at(i));
    }
    for (unsigned type = 14; type <= 30; ++type) {
        EXPECT_EQ(frame_spec(static_cast<FrameType>(type)), nullptr) << type;
    }
}

TEST(FrameType, node_ids_are_0_for_the_host_1_to_62_for_nodes_and_63_for_all) {
    for (unsigned node = 0; node < 256; ++node) {
        const auto id = static_cast<NodeId>(node);
        EXPECT_EQ(is_allowed(Party::from_host, id), node == 0) << node;
        EXPECT_EQ(is_allowed(Party::from_node, id), node >= 1 && node <= 62) << node;
        EXPECT_EQ(is_allowed(Party::to_node, id), node >= 1 && node <= 63) << node;
        EXPECT_FALSE(is_allowed(static_cast<Party>(3), id));
    }
}

TEST(FrameType, range_fd_of_1_to_4_readings_has_20_32_48_or_64_bytes) {
    EXPECT_EQ(range_fd_length(1), 20);
    EXPECT_EQ(range_fd_length(2), 32);
    EXPECT_EQ(range_fd_length(3), 48);
    EXPECT_EQ(range_fd_length(4), 64);
}

TEST(CanFrame, fd_lengths_are_0_to_8_12_16_20_24_32_48_and_64) {
    const std::set<std::size_t> lengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
    for (std::size_t length = 0; length < 300; ++length) {
        EXPECT_EQ(is_fd_length(length), lengths.contains(length)) << length;
        if (length <= 64) {
            EXPECT_EQ(next_fd_length(static_cast<std::uint8_t>(length)), *lengths.lower_bound(length))
                << length;
        }
    }
}

TEST(CanFrame, frames_that_differ_in_one_member_are_not_equal) {
    const CanFrame frame;
    const auto differs = [&frame](auto member, auto value) {
        CanFrame other = frame;
        other.*member = value;
        return !(other == frame);
    };
    EXPECT_EQ(frame, CanFrame{});
    EXPECT_TRUE(differs(&CanFrame::can_id, 1U));
    EXPECT_TRUE(differs(&CanFrame::is_extended, true));
    EXPECT_TRUE(differs(&CanFrame::is_remote, true));
    EXPECT_TRUE(differs(&CanFrame::is_error, true));
    EXPECT_TRUE(differs(&CanFrame::is_fd, true));
    EXPECT_TRUE(differs(&CanFrame::has_bit_rate_switch, true));
    EXPECT_TRUE(differs(&CanFrame::payload_len, std::uint8_t{1}));
    EXPECT_TRUE(differs(&CanFrame::data, std::array<std::uint8_t, 64>{1}));
}

/// Every enumerator is in its table under its own name, and nothing else is known.
template <class E>
void expect_names(const std::set<std::pair<int, std::string>>& expected) {
    std::set<std::pair<int, std::string>> names;
    for (int value = 0; value < 256; ++value) {
        const E enumerator = static_cast<E>(value);
        EXPECT_EQ(is_known(enumerator), std::string(name(enumerator)) != "?") << value;
        if (is_known(enumerator)) {
            names.emplace(value, name(enumerator));
        }
    }
    EXPECT_EQ(names, expected);
    EXPECT_EQ(values_of(E{}).size(), expected.size());
}

TEST(Names, are_those_of_the_protocol) {
    expect_names<NodeState>({{0, "starting"},
                             {1, "ranging"},
                             {2, "stopped"},
                             {3, "safe"},
                             {4, "bad_config"},
                             {5, "id_conflict"},
                             {6, "bus_fault"},
                             {7, "can_fault"}});
    expect_names<ResetCause>({{0, "power_on"},
                              {1, "brown_out"},
                              {2, "watchdog"},
                              {3, "software"},
                              {4, "pin"},
                              {5, "fault"},
                              {7, "unknown"}});
    expect_names<FaultKind>({{0, "none"},
                             {1, "assertion"},
                             {2, "hard_fault"},
                             {3, "stack_guard"},
                             {4, "watchdog"},
                             {5, "brown_out"},
                             {6, "clock_fault"},
                             {7, "xshut_stuck"},
                             {8, "stray_sensor"},
                             {9, "register_fixed"},
                             {10, "data_ready_ignored"},
                             {11, "register_alike"},
                             {12, "boot_late"},
                             {13, "commands_refused"},
                             {15, "unknown"}});
    expect_names<InfoPage>({{0, "uid_low"},
                            {1, "uid_high"},
                            {2, "identity"},
                            {3, "build"},
                            {4, "counters"},
                            {5, "traffic"},
                            {6, "fault"}});
    expect_names<SensorState>(
        {{0, "absent"}, {1, "starting"}, {2, "ranging"}, {3, "stopped"}, {4, "degraded"}, {5, "lost"}});
    expect_names<SensorFault>({{0, "none"},
                               {1, "no_answer"},
                               {2, "wrong_id"},
                               {3, "boot_timeout"},
                               {4, "config_mismatch"},
                               {5, "no_data_ready"},
                               {6, "stale_stream"},
                               {7, "reads_disagree"},
                               {8, "implausible_block"},
                               {9, "bus_error"},
                               {10, "address_conflict"},
                               {11, "xshut_stuck"},
                               {12, "hardware_fail"}});
    expect_names<MarkKind>({{0, "stop"}, {1, "start"}});
    expect_names<CommandCode>({{1, "start"},
                               {2, "stop"},
                               {3, "set_rate"},
                               {4, "reinitialise_sensor"},
                               {5, "identify"},
                               {6, "reset"},
                               {7, "send_info"},
                               {8, "send_black_box"},
                               {9, "calibrate_offset"},
                               {10, "calibrate_crosstalk"}});
    expect_names<CalibrationQuantity>({{0, "offset"}, {1, "crosstalk"}});
    expect_names<CalibrationOutcome>({{0, "under_way"},
                                      {1, "done"},
                                      {2, "refused"},
                                      {3, "not_brought_up"},
                                      {4, "device_failed"},
                                      {5, "no_result"},
                                      {6, "no_target"},
                                      {7, "out_of_range"}});
}

TEST(Bits, fields_follow_one_another_lowest_bit_first_across_byte_borders) {
    std::array<std::uint8_t, 9> bytes{};
    BitWriter writer(bytes);
    writer.put(0b101, 3);
    writer.put(0x1FF, 9);
    writer.put(0, 4);
    writer.put(0x123456789ABC, 48);
    writer.put(0xA5, 8);
    EXPECT_EQ(writer.bits_used(), 72U);
    EXPECT_EQ(bytes, (std::array<std::uint8_t, 9>{0xFD, 0x0F, 0xBC, 0x9A, 0x78, 0x56, 0x34, 0x12, 0xA5}));

    BitReader reader(bytes);
    EXPECT_EQ(reader.get(3), 0b101U);
    EXPECT_EQ(reader.get(9), 0x1FFU);
    EXPECT_EQ(reader.get(0), 0U);
    EXPECT_EQ(reader.get(4), 0U);
    EXPECT_EQ(reader.bits_left(), 56U);
    EXPECT_EQ(reader.get(48), 0x123456789ABCU);
    EXPECT_EQ(reader.get(8), 0xA5U);
    EXPECT_EQ(reader.bits_left(), 0U);
}

TEST(Bits, a_field_may_have_64_bits_at_any_offset) {
    for (unsigned offset = 0; offset < 8; ++offset) {
        std::array<std::uint8_t, 9> bytes{};
        BitWriter writer(bytes);
        writer.put(0, offset);
        writer.put(0xFEDCBA9876543210U, 64);
        BitReader reader(bytes);
        EXPECT_EQ(reader.get(offset), 0U);
        EXPECT_EQ(reader.get(64), 0xFEDCBA9876543210U) << offset;
    }
    EXPECT_EQ(max_of_bits(64), 0xFFFFFFFFFFFFFFFFU);
    EXPECT_EQ(max_of_bits(63), 0x7FFFFFFFFFFFFFFFU);
    EXPECT_EQ(max_of_bits(0), 0U);
}

TEST(BitsDeathTest, asserts_on_values_too_wide_and_buffers_too_short) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    std::array<std::uint8_t, 1> byte{};
    EXPECT_DEATH(BitWriter(byte).put(4, 2), "max_of_bits");
    EXPECT_DEATH(BitWriter(byte).put(0, 9), "size");
    EXPECT_DEATH(static_cast<void>(BitReader(byte).get(9)), "bits_left");
    EXPECT_DEATH(static_cast<void>(next_fd_length(65)), "kFdPayloadMax");
}

}  // namespace
}  // namespace octoskin::wire
