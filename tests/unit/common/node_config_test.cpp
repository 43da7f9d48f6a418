#include "common/config/node_config.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "common/wire/crc.hpp"

namespace octoskin {
namespace {

using Block = std::vector<std::uint8_t>;

Block block_of(const NodeConfig& config) {
    std::array<std::uint8_t, kNodeConfigBytesMax> buffer{};
    const auto used = encode(config, buffer);
    return {used.begin(), used.end()};
}
/// The CRC-32 of all but the last four bytes, put there.
Block signed_again(Block block) {
    const std::size_t covered = block.size() - 4;
    const std::uint32_t crc = crc32(std::span(block).first(covered));
    for (unsigned i = 0; i < 4; ++i) {
        block[covered + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    }
    return block;
}
NodeConfigError error_of(const Block& block) {
    const auto decoded = decode_node_config(block);
    EXPECT_FALSE(decoded);
    return decoded.error();
}

/// Every field differs from its default and from its neighbours.
SensorConfig sensor_config(std::uint8_t i) {
    SensorConfig sensor{.bus = static_cast<std::uint8_t>(i % 4),
                        .xshut_line = static_cast<std::uint8_t>(39 - i),
                        .address = static_cast<std::uint8_t>(0x30 + i),
                        .distance_mode = DistanceMode::short_range,
                        .timing_budget_ms = 0x0123,
                        .inter_measurement_ms = 0x0456,
                        .phase_us = 0x789A,
                        .offset_quarter_mm = -52,
                        .has_offset = true,
                        .crosstalk_raw = 0xBCDE,
                        .sigma_limit_quarter_mm = 0x0F12,
                        .signal_limit_raw = 0x3456,
                        .reflex_below_mm = 0x0789,
                        .applies_gain_factor = true,
                        .zone_count = 2};
    sensor.zones[0] = {.centre_spad = 145, .width = 8, .height = 16};
    sensor.zones[1] = {.centre_spad = 49, .width = 4, .height = 5};
    return sensor;
}
NodeConfig node_config(std::uint8_t sensors) {
    NodeConfig config{.node_id = 0x3D,
                      .board_type = 0x77,
                      .uses_can_fd = false,
                      .nominal_bitrate = 0x0007A120,
                      .data_bitrate = 0x001E8480,
                      .i2c_hz = 0x000493E0,
                      .is_io_2v8 = false,
                      .reads_twice = false,
                      .stream_gate = StreamGate::differs,
                      .aux_every = 9,
                      .zone_guard_us = 0x0BB8,
                      .holds_phases = true,
                      .data_ready_buses = 0x0A,
                      .sensor_count = sensors};
    for (std::uint8_t i = 0; i < sensors; ++i) {
        config.sensors[i] = sensor_config(i);
    }
    return config;
}

TEST(NodeConfig, canonical_form_is_these_bytes) {
    // Header, node, one sensor with two zones, and room for the CRC-32 (its own oracle is in crc_test.cpp).
    const Block expected = {
        'O',  'S',  'K',  'C',  4,    0,    65,   0,     // magic, version, length
        0x3D, 0x77, 0,                                   // node id, board type, CAN FD
        0x20, 0xA1, 0x07, 0,    0x80, 0x84, 0x1E, 0,     // bit rates
        0xE0, 0x93, 0x04, 0,    0,    0,    1,    9,     // I2C, 2.8 V, double read, gate, aux
        0xB8, 0x0B, 1,    0x0A, 1,                       // zone guard, phases, data-ready lines, sensors
        0,    39,   0x30, 1,    0x23, 0x01, 0x56, 0x04,  // bus, line, address, mode, budget, period
        0x9A, 0x78, 0xCC, 0xFF, 1,    0xDE, 0xBC,        // phase, offset, has it, crosstalk
        0x12, 0x0F, 0x56, 0x34, 0x89, 0x07, 1,    2,     // sigma, signal, reflex, gain, zones
        145,  8,    16,   49,   4,    5,                 //
        0,    0,    0,    0};
    Block block = block_of(node_config(1));
    const std::uint32_t hash = node_hash(node_config(1));
    ASSERT_EQ(block, signed_again(expected));
    EXPECT_EQ(hash, crc32(std::span(block).first(block.size() - 4)));
}

/// The same with all that came with layout 5.
NodeConfig newer_config(std::uint8_t sensors) {
    NodeConfig config = node_config(sensors);
    config.verifies_registers = false;
    config.ready_jitter_us = 0x0061;
    config.refuses_commands = true;
    config.left_out_count = 3;
    config.left_out[0] = 0x08;
    config.left_out[1] = 0x47;
    config.left_out[2] = 0x85;
    return config;
}

TEST(NodeConfig, what_is_newer_follows_the_sensors_in_a_block_of_layout_5) {
    const Block plain = block_of(node_config(1));
    const Block newer = block_of(newer_config(1));
    ASSERT_EQ(newer.size(), plain.size() + 8);
    Block expected(plain.begin(), plain.end() - 4);
    expected[4] = 5;
    expected[6] = static_cast<std::uint8_t>(newer.size());
    expected.insert(expected.end(), {0, 0x61, 0x00, 1, 3, 0x08, 0x47, 0x85, 0, 0, 0, 0});
    EXPECT_EQ(newer, signed_again(expected));
    ASSERT_TRUE(decode_node_config(newer));
    EXPECT_EQ(*decode_node_config(newer), newer_config(1));
}

// Recordings and boards of rigs without the newer keys keep the hash that they had.
TEST(NodeConfig, without_anything_newer_the_block_is_one_of_layout_4) {
    EXPECT_EQ(block_of(node_config(2))[4], 4);
    const auto layout_with = [](auto change) {
        NodeConfig config = node_config(2);
        change(config);
        return block_of(config)[4];
    };
    EXPECT_EQ(layout_with([](NodeConfig& c) { c.verifies_registers = false; }), 5);
    EXPECT_EQ(layout_with([](NodeConfig& c) { c.ready_jitter_us = 31; }), 5);
    EXPECT_EQ(layout_with([](NodeConfig& c) { c.refuses_commands = true; }), 5);
    EXPECT_EQ(layout_with([](NodeConfig& c) { c.left_out_count = 1, c.left_out[0] = 0x47; }), 5);
    EXPECT_EQ(layout_with([](NodeConfig& c) { c.left_out[0] = 0x47; }), 4) << "beyond the count";
}

TEST(NodeConfig, a_block_of_layout_5_that_needs_none_is_refused) {
    Block block = block_of(node_config(1));
    block[4] = 5;
    EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::invalid_field) << "cut short";
    block.resize(block.size() - 4);
    block.insert(block.end(), {1, 30, 0, 0, 0, 0, 0, 0, 0});
    block[6] = static_cast<std::uint8_t>(block.size());
    EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::invalid_field)
        << "one hash for one configuration";
}

TEST(NodeConfig, registers_left_out_are_read_back_and_in_ascending_order) {
    const auto is_good = [](std::vector<std::uint8_t> left_out) {
        NodeConfig config = node_config(1);
        config.left_out_count = static_cast<std::uint8_t>(left_out.size());
        std::ranges::copy(left_out, config.left_out.begin());
        return is_valid(config);
    };
    EXPECT_TRUE(is_good({}));
    EXPECT_TRUE(is_good({0x08}));
    EXPECT_TRUE(is_good({0x47, 0x7C, 0x85}));
    EXPECT_FALSE(is_good({0x7C, 0x47}));
    EXPECT_FALSE(is_good({0x47, 0x47}));
    for (const std::uint8_t index : std::to_array<std::uint8_t>({0x00, 0x07, 0x0C, 0x31, 0x32, 0x86, 0xFF}))
        EXPECT_FALSE(is_good({index}));
    std::vector<std::uint8_t> most;
    for (std::uint8_t index = 0x43; index < 0x43 + 32; ++index) most.push_back(index);
    EXPECT_TRUE(is_good(most));
    NodeConfig config = node_config(1);
    config.left_out_count = 33;
    EXPECT_FALSE(is_valid(config));
}

TEST(NodeConfig, every_number_of_sensors_survives_its_block) {
    for (std::uint8_t sensors = 0; sensors <= kNodeSensorsMax; ++sensors) {
        const auto decoded = decode_node_config(block_of(node_config(sensors)));
        ASSERT_TRUE(decoded) << int{sensors};
        EXPECT_EQ(*decoded, node_config(sensors)) << int{sensors};
    }
}

TEST(NodeConfig, the_largest_one_fits_its_block) {
    NodeConfig config = node_config(kNodeSensorsMax);
    for (SensorConfig& sensor : config.sensors) {
        sensor.zone_count = kSensorZonesMax;
    }
    EXPECT_EQ(block_of(config).size(), 1736U);  // of 2048
    config.left_out_count = kRegistersLeftOutMax;
    for (std::uint8_t i = 0; i < kRegistersLeftOutMax; ++i)
        config.left_out[i] = static_cast<std::uint8_t>(0x43 + i);
    EXPECT_EQ(block_of(config).size(), 1773U);
    EXPECT_EQ(*decode_node_config(block_of(config)), config);
}

TEST(NodeConfig, bytes_after_the_block_make_no_difference) {
    Block page = block_of(node_config(3));
    page.resize(2048, 0xFF);
    ASSERT_TRUE(decode_node_config(page));
    EXPECT_EQ(*decode_node_config(page), node_config(3));
}

TEST(NodeConfig, an_erased_page_has_no_magic) {
    EXPECT_EQ(error_of(Block(2048, 0xFF)), NodeConfigError::wrong_magic);
    EXPECT_EQ(error_of(Block(2048, 0x00)), NodeConfigError::wrong_magic);
    EXPECT_EQ(error_of(Block(8, 0xFF)), NodeConfigError::wrong_magic);
    EXPECT_EQ(error_of(Block(7, 0xFF)), NodeConfigError::truncated);
}

TEST(NodeConfig, every_truncation_is_told_as_one) {
    const Block whole = block_of(node_config(2));
    for (std::size_t length = 0; length < whole.size(); ++length) {
        EXPECT_EQ(error_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}),
                  NodeConfigError::truncated)
            << length;
    }
}

TEST(NodeConfig, every_flipped_bit_is_refused) {
    const Block whole = block_of(node_config(2));
    for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        Block block = whole;
        block[bit / 8] = static_cast<std::uint8_t>(block[bit / 8] ^ (1U << (bit % 8)));
        const NodeConfigError error = error_of(block);
        if (bit < 32) {
            EXPECT_EQ(error, NodeConfigError::wrong_magic) << bit;
        } else if (bit < 48 || bit >= 64) {
            EXPECT_EQ(error, NodeConfigError::wrong_crc) << bit;
        }
    }
}

TEST(NodeConfig, an_impossible_length_is_refused_before_it_is_used) {
    for (const std::uint16_t length : std::to_array<std::uint16_t>({0, 1, 8, 11, 2049, 65'535})) {
        Block block = block_of(node_config(1));
        block.resize(70'000);
        block[6] = static_cast<std::uint8_t>(length);
        block[7] = static_cast<std::uint8_t>(length >> 8U);
        EXPECT_EQ(error_of(block), NodeConfigError::wrong_length) << length;
    }
}

TEST(NodeConfig, another_layout_version_is_told_as_one_if_the_block_is_whole) {
    Block block = block_of(node_config(1));
    block[4] = 1;
    EXPECT_EQ(error_of(block), NodeConfigError::wrong_crc);
    EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::wrong_version);
    block[4] = 3;
    block[5] = 1;
    EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::wrong_version);
}

/// The block without its last `bytes` before the CRC (or with zeros there, if negative), length and CRC
/// right.
Block resized(int bytes) {
    Block block = block_of(node_config(2));
    block.resize(static_cast<std::size_t>(static_cast<int>(block.size()) - bytes));
    block[6] = static_cast<std::uint8_t>(block.size());
    block[7] = static_cast<std::uint8_t>(block.size() >> 8U);
    return signed_again(block);
}

TEST(NodeConfig, fields_that_end_before_or_after_the_length_are_refused) {
    ASSERT_TRUE(decode_node_config(resized(0)));
    for (int bytes = 1; bytes <= 77; ++bytes) {
        EXPECT_EQ(error_of(resized(bytes)), NodeConfigError::invalid_field) << bytes;
    }
    for (int bytes = 1; bytes <= 4; ++bytes) {
        EXPECT_EQ(error_of(resized(-bytes)), NodeConfigError::invalid_field) << bytes;
    }
}

TEST(NodeConfig, a_flag_is_0_or_1_and_a_count_at_most_its_maximum) {
    const Block good = block_of(node_config(1));
    for (const std::size_t flag : {10U, 23U, 24U, 29U, 44U, 53U}) {
        for (const unsigned value : {2U, 255U}) {
            Block block = good;
            block[flag] = static_cast<std::uint8_t>(value);
            EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::invalid_field) << flag;
        }
    }
    for (const auto& [at, value] :
         std::vector<std::pair<std::size_t, int>>{{31, 35}, {31, 255}, {54, 10}, {54, 255}}) {
        Block block = good;
        block[at] = static_cast<std::uint8_t>(value);
        EXPECT_EQ(error_of(signed_again(block)), NodeConfigError::invalid_field) << at;
    }
}

struct FieldRange {
    std::string name;
    std::function<void(NodeConfig&, int)> set;
    std::vector<int> good;
    std::vector<int> bad;
};

std::vector<FieldRange> field_ranges() {
    using N = NodeConfig;
    const auto u8 = [](int value) { return static_cast<std::uint8_t>(value); };
    const auto u16 = [](int value) { return static_cast<std::uint16_t>(value); };
    const auto u32 = [](int value) { return static_cast<std::uint32_t>(value); };
    return {
        {"node_id", [=](N& c, int v) { c.node_id = u8(v); }, {1, 61}, {0, 62, 63, 255}},
        {"board_type", [=](N& c, int v) { c.board_type = u8(v); }, {0, 255}, {}},
        {"nominal_bitrate",
         [=](N& c, int v) { c.nominal_bitrate = u32(v); },
         {10'000, 1'000'000},
         {0, 9'999, 1'000'001}},
        {"data_bitrate",
         [=](N& c, int v) { c.data_bitrate = u32(v); },
         {500'000, 8'000'000},
         {0, 499'999, 8'000'001}},
        {"i2c_hz", [=](N& c, int v) { c.i2c_hz = u32(v); }, {10'000, 400'000}, {0, 9'999, 400'001}},
        {"stream_gate", [](N& c, int v) { c.stream_gate = static_cast<StreamGate>(v); }, {0, 1, 2}, {3, 255}},
        {"aux_every", [=](N& c, int v) { c.aux_every = u8(v); }, {0, 255}, {}},
        {"zone_guard_us", [=](N& c, int v) { c.zone_guard_us = u16(v); }, {0, 65'535}, {}},
        {"ready_jitter",
         [=](N& c, int v) { c.holds_phases = false, c.ready_jitter_us = u16(v); },
         {30, 2'000},
         {0, 29, 2'001, 65'535}},
        {"ready_jitter of a period",
         [=](N& c, int v) {
             c.holds_phases = false, c.sensors[1].timing_budget_ms = 15, c.sensors[1].phase_us = 0,
             c.sensors[1].inter_measurement_ms = 33, c.ready_jitter_us = u16(v);
         },
         {30, 1'650},
         {1'651, 2'000}},
        {"ready_jitter with phases",
         [=](N& c, int v) { c.ready_jitter_us = u16(v); },
         {30, 100},
         {101, 2'000}},
        {"left_out", [=](N& c, int v) { c.left_out_count = 1, c.left_out[0] = u8(v); }, {0x08, 0x85}, {0x31}},
        {"data_ready_buses", [=](N& c, int v) { c.data_ready_buses = u8(v); }, {0, 15}, {16, 255}},
        {"bus", [=](N& c, int v) { c.sensors[1].bus = u8(v); }, {0, 3}, {4, 255}},
        {"xshut_line", [=](N& c, int v) { c.sensors[1].xshut_line = u8(v); }, {0, 38, 40, 47}, {48, 255}},
        {"shared xshut_line", [=](N& c, int v) { c.sensors[1].xshut_line = u8(v); }, {}, {39}},
        {"address",
         [=](N& c, int v) { c.sensors[1].address = u8(v); },
         {8, 0x28, 0x2A, 0x30, 119},
         {0, 7, 0x29, 120, 255}},
        {"shared address",
         [=](N& c, int v) { c.sensors[1].bus = 0, c.sensors[1].address = u8(v); },
         {0x31},
         {0x30}},
        {"distance_mode",
         [](N& c, int v) { c.sensors[1].distance_mode = static_cast<DistanceMode>(v); },
         {1, 2, 3},
         {0, 4}},
        {"timing_budget",
         [=](N& c, int v) { c.sensors[1].timing_budget_ms = u16(v); },
         {15, 1000},
         {0, 14, 1001}},
        {"inter_measurement",
         [=](N& c, int v) { c.sensors[1].inter_measurement_ms = u16(v); },
         {291, 60'000},
         {0, 290, 60'001}},
        {"phase",
         [=](N& c, int v) {
             c.sensors[1].timing_budget_ms = 15, c.sensors[1].inter_measurement_ms = 33,
             c.sensors[1].phase_us = u16(v);
         },
         {0, 32'999},
         {33'000, 65'535}},
        {"offset",
         [](N& c, int v) { c.sensors[1].offset_quarter_mm = static_cast<std::int16_t>(v); },
         {-4096, 0, 4095},
         {-4097, 4096}},
        {"crosstalk", [=](N& c, int v) { c.sensors[1].crosstalk_raw = u16(v); }, {0, 65'535}, {}},
        {"sigma limit", [=](N& c, int v) { c.sensors[1].sigma_limit_quarter_mm = u16(v); }, {0, 65'535}, {}},
        {"signal limit", [=](N& c, int v) { c.sensors[1].signal_limit_raw = u16(v); }, {0, 65'535}, {}},
        {"reflex", [=](N& c, int v) { c.sensors[1].reflex_below_mm = u16(v); }, {0, 4'000}, {4'001, 65'535}},
        {"zone_count",
         [=](N& c, int v) { c.sensors[1].zone_count = u8(v), c.sensors[1].zones[1] = {}; },
         {1, 2, 9},
         {0}},
        {"centre_spad", [=](N& c, int v) { c.sensors[1].zones[1].centre_spad = u8(v); }, {0, 255}, {}},
        {"width", [=](N& c, int v) { c.sensors[1].zones[1].width = u8(v); }, {4, 16}, {0, 3, 17, 255}},
        {"height", [=](N& c, int v) { c.sensors[1].zones[0].height = u8(v); }, {4, 16}, {0, 3, 17, 255}},
    };
}

TEST(NodeConfig, every_field_is_checked_at_both_ends_of_its_range) {
    for (const FieldRange& field : field_ranges()) {
        for (const int value : field.good) {
            NodeConfig config = node_config(2);
            field.set(config, value);
            EXPECT_TRUE(is_valid(config)) << field.name << " " << value;
            const auto decoded = decode_node_config(block_of(config));
            ASSERT_TRUE(decoded) << field.name << " " << value;
            EXPECT_EQ(*decoded, config) << field.name << " " << value;
        }
        for (const int value : field.bad) {
            NodeConfig config = node_config(2);
            field.set(config, value);
            EXPECT_FALSE(is_valid(config)) << field.name << " " << value;
            EXPECT_EQ(error_of(block_of(config)), NodeConfigError::invalid_field)
                << field.name << " " << value;
        }
    }
}

TEST(NodeConfig, every_field_is_compared_and_hashed) {
    const NodeConfig base = node_config(2);
    EXPECT_EQ(base, node_config(2));
    EXPECT_EQ(node_hash(base), node_hash(node_config(2)));
    std::vector<FieldRange> fields = field_ranges();
    const auto flag = [](std::string name, auto of) {
        return FieldRange{std::move(name), [of](NodeConfig& c, int v) { of(c) = v != 0; }, {0, 1}, {}};
    };
    fields.push_back(flag("uses_can_fd", [](NodeConfig& c) -> bool& { return c.uses_can_fd; }));
    fields.push_back(flag("is_io_2v8", [](NodeConfig& c) -> bool& { return c.is_io_2v8; }));
    fields.push_back(flag("reads_twice", [](NodeConfig& c) -> bool& { return c.reads_twice; }));
    fields.push_back(flag("holds_phases", [](NodeConfig& c) -> bool& { return c.holds_phases; }));
    fields.push_back(flag("verifies", [](NodeConfig& c) -> bool& { return c.verifies_registers; }));
    fields.push_back(flag("refuses_commands", [](NodeConfig& c) -> bool& { return c.refuses_commands; }));
    fields.push_back(flag("has_offset", [](NodeConfig& c) -> bool& { return c.sensors[1].has_offset; }));
    fields.push_back(flag("gain", [](NodeConfig& c) -> bool& { return c.sensors[1].applies_gain_factor; }));
    for (const FieldRange& field : fields) {
        if (field.good.size() < 2) {
            continue;
        }
        NodeConfig one = base;
        NodeConfig other = base;
        field.set(one, field.good[0]);
        field.set(other, field.good[1]);
        EXPECT_NE(one, other) << field.name;
        EXPECT_NE(node_hash(one), node_hash(other)) << field.name;
    }
    EXPECT_NE(node_config(1), node_config(2));
}

TEST(NodeConfig, more_sensors_or_zones_than_there_is_room_for_are_not_valid) {
    NodeConfig config = node_config(2);
    config.sensor_count = kNodeSensorsMax + 1;
    EXPECT_FALSE(is_valid(config));
    config = node_config(2);
    config.sensors[0].zone_count = kSensorZonesMax + 1;
    EXPECT_FALSE(is_valid(config));
}

TEST(NodeConfig, no_two_sensors_share_a_line_or_on_one_bus_an_address) {
    const NodeConfig config = node_config(kNodeSensorsMax);
    ASSERT_TRUE(is_valid(config));
    for (std::size_t i = 0; i < kNodeSensorsMax; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            NodeConfig shared_line = config;
            shared_line.sensors[i].xshut_line = config.sensors[j].xshut_line;
            EXPECT_FALSE(is_valid(shared_line)) << i << ' ' << j;
            NodeConfig shared_address = config;
            shared_address.sensors[i].address = config.sensors[j].address;
            EXPECT_EQ(is_valid(shared_address), i % 4 != j % 4) << i << ' ' << j;
        }
    }
}

TEST(NodeConfig, what_lies_beyond_the_counts_is_not_in_the_hash) {
    NodeConfig config = node_config(2);
    const std::uint32_t hash = node_hash(config);
    config.sensors[2].address = 0x55;
    config.sensors[0].zones[2].width = 5;
    EXPECT_EQ(node_hash(config), hash);
    config.sensors[0].zones[1].width = 5;
    EXPECT_NE(node_hash(config), hash);
}

TEST(NodeConfigDeathTest, asserts_on_more_sensors_or_zones_than_the_arrays_have) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    NodeConfig config = node_config(2);
    config.sensor_count = kNodeSensorsMax + 1;
    EXPECT_DEATH(static_cast<void>(node_hash(config)), "most");
    config = node_config(2);
    config.sensors[0].zone_count = kSensorZonesMax + 1;
    EXPECT_DEATH(static_cast<void>(node_hash(config)), "most");
}

}  // namespace
}  // namespace octoskin
