// The keys of a node, of its verification and of its board.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "common/config/node_config.hpp"
#include "common/config/verified_registers.hpp"
#include "hw/rigfile/key.hpp"

namespace octoskin::rig::keys {

inline constexpr Range<std::int64_t> kNodeId{1, kUnconfiguredNodeId - 1};

namespace node {
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kIoLevels{{{"2v8", true}, {"1v8", false}}};
inline constexpr std::array<std::pair<std::string_view, StreamGate>, 3> kStreamGates{
    {{"off", StreamGate::off}, {"differs", StreamGate::differs}, {"advanced", StreamGate::advanced}}};
inline constexpr TextKey kName{.path = "nodes[].name", .kind = TextKind::folder_name, .meaning = "unique"};
inline constexpr IntegerKey kNodeId{.path = "nodes[].node_id",
                                    .range = keys::kNodeId,
                                    .meaning = "unique, not that of `joints`",
                                    .is_in_node_block = true};
inline constexpr TableKey kBoard{.path = "nodes[].board",
                                 .expected = "a path or a table",
                                 .meaning =
                                     "a file in `hw/boards/`, or that file's [table](#boards) written "
                                     "out"};
inline constexpr IntegerKey kI2cHz{.path = "nodes[].i2c_hz",
                                   .unit = "Hz",
                                   .range = {10'000, 400'000},
                                   .fallback = {NodeConfig{}.i2c_hz},
                                   .meaning = "clock of all its I2C buses",
                                   .is_in_node_block = true};
/// The meaning of its words: pulled up to AVDD.
inline constexpr WordKey<bool> kIoLevel{
    .path = "nodes[].io_level",
    .words = kIoLevels,
    .fallback = {true},
    .meaning = "pull-up voltage of the sensors' I/O: `2v8` (AVDD, 2.6..3.5 V) or `1v8`",
    .is_in_node_block = true};
inline constexpr FlagKey kReadsTwice{
    .path = "nodes[].reads_twice",
    .fallback = {NodeConfig{}.reads_twice},
    .meaning = "the result block is read twice and must agree: I2C has no checksum",
    .is_in_node_block = true};
inline constexpr WordKey<StreamGate> kStreamGate{.path = "nodes[].stream_gate",
                                                 .words = kStreamGates,
                                                 .fallback = {NodeConfig{}.stream_gate},
                                                 .meaning = "check of the sensor's stream count (below)",
                                                 .is_in_node_block = true};
inline constexpr IntegerKey kAuxEvery{
    .path = "nodes[].aux_every",
    .range = {0, 255},
    .fallback = {NodeConfig{}.aux_every},
    .meaning = "classical CAN: signal and ambient with every n-th reading; 0 is never",
    .is_in_node_block = true};
inline constexpr IntegerKey kZoneGuard{.path = "nodes[].zone_guard_us",
                                       .unit = "us",
                                       .range = {0, 20'000},
                                       .fallback = {NodeConfig{}.zone_guard_us},
                                       .meaning = "guard time of a zone write (below)",
                                       .is_in_node_block = true};
inline constexpr FlagKey kHoldsPhases{
    .path = "nodes[].holds_phases",
    .fallback = {NodeConfig{}.holds_phases},
    .meaning = "restarts sensors that leave their [phase](#phases); costs about 3 readings of 100",
    .is_in_node_block = true};
inline constexpr IntegerKey kDataReadyBuses{
    .path = "nodes[].data_ready_buses[]",
    .range = {0, kNodeBusesMax - 1},
    .fallback = {.text = "none"},
    .meaning = "buses with a wired [data-ready line](hardware/wiring.md#data-ready), as `[0, 2]`",
    .is_in_node_block = true};
inline constexpr IntegerKey kReadyJitter{
    .path = "nodes[].ready_jitter_us",
    .unit = "us",
    .range = {kReadyJitterMinUs, kReadyJitterMaxUs},
    .fallback = {NodeConfig{}.ready_jitter_us},
    .meaning = "by how much the length of a sensor's ranges may differ ([below](#ranges-of-any-length))",
    .is_in_node_block = true};
inline constexpr TableKey kVerification{.path = "nodes[].verification",
                                        .fallback = {.text = "all registers"},
                                        .meaning = "registers that are read back and compared (below)",
                                        .is_in_node_block = true};
inline constexpr FlagKey kRefusesCommands{.path = "nodes[].refuses_commands",
                                          .fallback = {NodeConfig{}.refuses_commands},
                                          .meaning = "the node refuses each COMMAND, from any sender (below)",
                                          .is_in_node_block = true};
inline constexpr IntegerKey kPinnedBuildId{
    .path = "nodes[].pinned_build_id",
    .range = {0, 0xFFFF'FFFF},
    .fallback = {.text = "none"},
    .meaning = "the only firmware build that the host accepts: the first 32 bits of its commit"};
inline constexpr ListKey kSensors{
    .path = "nodes[].sensors",
    .items = "sensors",
    .count = {1, kNodeSensorsMax},
    .meaning =
        "[the sensors](#sensors-and-sensor_defaults), at most as many as the board has; their order "
        "is the sensor index on the wire",
    .is_in_node_block = true};
}  // namespace node

namespace verification {
inline constexpr FlagKey kEnabled{.path = "nodes[].verification.enabled",
                                  .fallback = {NodeConfig{}.verifies_registers},
                                  .meaning = "false: no register is compared",
                                  .is_in_node_block = true};
inline constexpr IntegerKey kLeaveOut{
    .path = "nodes[].verification.leave_out[]",
    .range = {0, kVerifiedRegisterMax},
    .fallback = {.text = "none"},
    .meaning = "up to 32 registers that are not compared, by their index, each once",
    .is_in_node_block = true};
static_assert(kRegistersLeftOutMax == 32);
}  // namespace verification

/// The same in a file in hw/boards/, at its top.
namespace board {
inline constexpr Range<std::int64_t> kSensors{1, kNodeSensorsMax};
inline constexpr TextKey kName{.path = "nodes[].board.name",
                               .kind = TextKind::folder_name,
                               .meaning = "its name; of a shipped board also that of its file"};
inline constexpr IntegerKey kBoardType{.path = "nodes[].board.board_type",
                                       .range = {0, 255},
                                       .meaning = "its number in NODE_INFO and in the configuration block",
                                       .is_in_node_block = true};
inline constexpr IntegerKey kI2cBusCount{
    .path = "nodes[].board.i2c_bus_count", .range = {1, kNodeBusesMax}, .meaning = "I2C buses"};
inline constexpr IntegerKey kXshutLineCount{
    .path = "nodes[].board.xshut_line_count", .range = {1, kNodeXshutLinesMax}, .meaning = "XSHUT outputs"};
inline constexpr IntegerKey kSensorsMax{
    .path = "nodes[].board.sensors_max", .range = kSensors, .meaning = "sensors of a node"};
inline constexpr IntegerKey kSensorsPerBusMax{
    .path = "nodes[].board.sensors_per_bus_max", .range = kSensors, .meaning = "sensors of one bus"};
inline constexpr FlagKey kSupportsCanFd{.path = "nodes[].board.supports_can_fd",
                                        .meaning = "whether `protocol: can_fd` is possible"};
inline constexpr FlagKey kHasDataReadyLines{
    .path = "nodes[].board.has_data_ready_lines",
    .fallback = {false},
    .meaning = "whether each bus has an input for its sensors' GPIO1"};
}  // namespace board

}  // namespace octoskin::rig::keys
