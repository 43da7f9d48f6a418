// The configuration block: all that one node needs of the rig, as a value. hw/rigfile compiles it. The node
// core receives it from flash or from the process that runs it. Its CRC-32 is the node_hash that the host
// requires.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/result.hpp"

namespace octoskin {

inline constexpr std::size_t kNodeSensorsMax = 34;
inline constexpr std::size_t kNodeBusesMax = 4;
inline constexpr std::size_t kSensorZonesMax = 9;
inline constexpr std::uint16_t kReflexLimitMaxMm = 4'000;  ///< the sensor's longest range
inline constexpr std::uint8_t kNodeXshutLinesMax = 48;     ///< five 74HC595 and eight pins
inline constexpr std::size_t kRegistersLeftOutMax = 32;    ///< for more, switch the verification off
/// A sensor's timer alone strays by less than kReadyJitterMinUs.
inline constexpr std::uint16_t kReadyJitterMinUs = 30;
inline constexpr std::uint16_t kReadyJitterMaxUs = 2'000;
/// The jitter is at most 1/20 of a sensor's period. With more, the period is never known well enough to be
/// trimmed.
inline constexpr std::uint32_t kReadyJittersPerPeriodMin = 20;
/// The largest jitter for a rig that holds phases: with more, a ready time does not give a sensor's phase.
inline constexpr std::uint16_t kReadyJitterOfPhasesMaxUs = 100;

enum class DistanceMode : std::uint8_t { short_range = 1, medium_range = 2, long_range = 3 };
enum class StreamGate : std::uint8_t { off = 0, differs = 1, advanced = 2 };

/// Region of interest on the 16 x 16 SPAD array.
struct Roi {
    std::uint8_t centre_spad = 199;
    std::uint8_t width = 16;   ///< 4..16
    std::uint8_t height = 16;  ///< 4..16
    friend constexpr bool operator==(const Roi&, const Roi&) = default;
};

struct SensorConfig {
    std::uint8_t bus = 0;         ///< index of the node's I2C bus
    std::uint8_t xshut_line = 0;  ///< index of the node's XSHUT output
    std::uint8_t address = 0;     ///< 7-bit address after bring-up; never 0x29
    DistanceMode distance_mode = DistanceMode::long_range;
    std::uint16_t timing_budget_ms = 20;
    std::uint16_t inter_measurement_ms = 33;
    std::uint16_t phase_us = 0;  ///< start of this sensor's ranging within the period, to spread bus load
    std::int16_t offset_quarter_mm = 0;          ///< 11.2 format, added by the device
    bool has_offset = false;                     ///< false: the part's own factory offset stays
    std::uint16_t crosstalk_raw = 0;             ///< 7.9 kcps per SPAD
    std::uint16_t sigma_limit_quarter_mm = 360;  ///< 14.2: 90 mm
    std::uint16_t signal_limit_raw = 128;        ///< 9.7 Mcps: 1.0
    std::uint16_t reflex_below_mm = 0;           ///< a hit closer than this is reported by REFLEX; 0: never
    bool applies_gain_factor = false;            ///< 2011/2048 of ST's full API; off as in ST's ULD
    std::uint8_t zone_count = 1;
    std::array<Roi, kSensorZonesMax> zones{};
    friend constexpr bool operator==(const SensorConfig&, const SensorConfig&) = default;
};

struct NodeConfig {
    std::uint8_t node_id = 1;     ///< 1..61
    std::uint8_t board_type = 0;  ///< hw/boards/
    bool uses_can_fd = true;
    std::uint32_t nominal_bitrate = 1'000'000;
    std::uint32_t data_bitrate = 5'000'000;  ///< CAN FD only
    std::uint32_t i2c_hz = 400'000;
    bool is_io_2v8 = true;    ///< I2C and GPIO1 pulled up to AVDD (2.6..3.5 V) rather than 1.8 V
    bool reads_twice = true;  ///< the result block is read twice and must agree
    StreamGate stream_gate = StreamGate::advanced;
    std::uint8_t aux_every = 0;          ///< classical: RANGE_AUX with every n-th reading; 0 = never
    std::uint16_t zone_guard_us = 1000;  ///< a zone write this close to a range start makes its zone unknown
    bool holds_phases = false;           ///< sensors that drift out of their phase are restarted
    std::uint8_t data_ready_buses = 0;   ///< bit b: bus b has a data-ready line; below 2^kNodeBusesMax
    std::uint8_t sensor_count = 0;
    std::array<SensorConfig, kNodeSensorsMax> sensors{};
    bool verifies_registers = true;  ///< what is written to a sensor is read back and must match
    /// How far ready times stray from an even grid because ranges differ in length: from kReadyJitterMinUs
    /// (ranges of equal length) to kReadyJitterMaxUs.
    std::uint16_t ready_jitter_us = kReadyJitterMinUs;
    bool refuses_commands = false;  ///< every COMMAND is refused; SYNC is still answered
    std::uint8_t left_out_count = 0;
    /// Registers that are not compared: each `is_verified`, in ascending order.
    std::array<std::uint8_t, kRegistersLeftOutMax> left_out{};
    friend constexpr bool operator==(const NodeConfig&, const NodeConfig&) = default;
};

/// The id of a node without a configuration; never valid in a configuration.
inline constexpr std::uint8_t kUnconfiguredNodeId = 62;
/// The configuration of a board whose block `decode_node_config` refuses. It is not valid, so the node does
/// not range and its heartbeat reports `bad_config`. The bit rate is unknown: a port sends nothing until it
/// has received a valid frame at the rate that it tries.
[[nodiscard]] constexpr NodeConfig without_configuration() noexcept {
    NodeConfig config;
    config.node_id = kUnconfiguredNodeId;
    return config;
}

/// Whether every field is within what a board can do: counts, indices, addresses (8..119, never 0x29), bit
/// rates, ROI sizes, offsets of 13 bits, jitter, registers left out. Two sensors share neither an XSHUT line
/// nor an address on one bus. The driver checks whether a sensor accepts a timing budget in a distance mode.
[[nodiscard]] bool is_valid(const NodeConfig& config) noexcept;

/// In the order of the checks.
enum class NodeConfigError : std::uint8_t {
    truncated,      ///< shorter than a header, or than the length in it
    wrong_magic,    ///< not a configuration block, for example an erased page
    wrong_length,   ///< the length in the header is impossible
    wrong_crc,      ///< damaged
    wrong_version,  ///< intact, but of another layout
    invalid_field,  ///< not `is_valid`, a flag that is neither 0 nor 1, or fields and length that disagree
};
inline constexpr std::size_t kNodeConfigBytesMax = 2048;

/// Canonical binary form: "OSKC", version and length (16 bits each), fields little-endian, CRC-32 of all
/// bytes before it. It contains only the sensors, zones and registers within their counts. The fields of
/// layout 5 (verification, jitter, refusal of commands) are written only if one of them differs from its
/// default. Otherwise the block has layout 4 and its hash is unchanged. Returns the bytes used in `out`.
/// Counts above the array sizes are a programmer's error.
[[nodiscard]] std::span<const std::uint8_t> encode(const NodeConfig& config,
                                                   std::span<std::uint8_t, kNodeConfigBytesMax> out) noexcept;
/// The configuration in the block at the start of `memory`, which may be longer than the block (a flash
/// page). Accepts the layouts 4 and 5.
[[nodiscard]] Result<NodeConfig, NodeConfigError> decode_node_config(
    std::span<const std::uint8_t> memory) noexcept;
/// The node_hash: the CRC-32 that ends the canonical form.
[[nodiscard]] std::uint32_t node_hash(const NodeConfig& config) noexcept;

}  // namespace octoskin
