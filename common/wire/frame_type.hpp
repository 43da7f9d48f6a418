// All frames: identifier, sender, format, length and checksum of each, in one table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::wire {

/// The type is in the upper 5 bits of the 11-bit identifier, the node id in the lower 6. The lower identifier
/// wins arbitration.
enum class FrameType : std::uint8_t {
    reflex = 0,
    sync = 1,
    follow_up = 2,
    command = 3,
    mark = 4,
    heartbeat = 5,
    joint_state = 6,
    sync_report = 7,
    range = 8,
    range_fd = 9,
    sensor_health = 10,
    node_info = 11,
    range_aux = 12,
    calibration = 13,
    black_box = 31,
};

inline constexpr std::uint32_t kStandardIdMax = 0x7FF;

[[nodiscard]] constexpr std::uint32_t can_id(FrameType type, NodeId node_id) noexcept {
    return (static_cast<std::uint32_t>(type) << 6U) | node_id;
}
/// The two parts of a standard identifier. The type may be unassigned: see `frame_spec`.
[[nodiscard]] constexpr FrameType type_of(std::uint32_t standard_id) noexcept {
    return static_cast<FrameType>((standard_id >> 6U) & 31U);
}
[[nodiscard]] constexpr NodeId node_of(std::uint32_t standard_id) noexcept {
    return static_cast<NodeId>(standard_id & 63U);
}

/// Whose node id an identifier carries.
enum class Party : std::uint8_t {
    from_host,  ///< 0
    from_node,  ///< 1..62: the sender
    to_node,    ///< 1..62, or 63 for all: the receiver of a host's frame
};

enum class Checksum : std::uint8_t { crc8 = 1, crc16 = 2 };  ///< the value is the length in bytes

struct FrameSpec {
    FrameType type = FrameType::reflex;
    const char* name = "";
    Party party = Party::from_node;
    bool is_fd = false;
    std::uint8_t payload_len = 0;  ///< with the checksum; for RANGE_FD the largest
    Checksum checksum = Checksum::crc8;
};

/// All assigned types, by priority. Fixed for all protocol versions: the identifiers, the checksums and
/// HEARTBEAT's length.
inline constexpr std::array<FrameSpec, 15> kFrameSpecs = {{
    {FrameType::reflex, "REFLEX", Party::from_node, false, 8, Checksum::crc16},
    {FrameType::sync, "SYNC", Party::from_host, false, 3, Checksum::crc16},
    {FrameType::follow_up, "FOLLOW_UP", Party::from_host, false, 8, Checksum::crc8},
    {FrameType::command, "COMMAND", Party::to_node, false, 7, Checksum::crc16},
    {FrameType::mark, "MARK", Party::from_host, false, 8, Checksum::crc8},
    {FrameType::heartbeat, "HEARTBEAT", Party::from_node, false, 8, Checksum::crc16},
    {FrameType::joint_state, "JOINT_STATE", Party::from_node, false, 8, Checksum::crc8},
    {FrameType::sync_report, "SYNC_REPORT", Party::from_node, false, 7, Checksum::crc16},
    {FrameType::range, "RANGE", Party::from_node, false, 8, Checksum::crc8},
    {FrameType::range_fd, "RANGE_FD", Party::from_node, true, 64, Checksum::crc16},
    {FrameType::sensor_health, "SENSOR_HEALTH", Party::from_node, false, 8, Checksum::crc8},
    {FrameType::node_info, "NODE_INFO", Party::from_node, false, 8, Checksum::crc8},
    {FrameType::range_aux, "RANGE_AUX", Party::from_node, false, 8, Checksum::crc16},
    {FrameType::calibration, "CALIBRATION", Party::from_node, false, 8, Checksum::crc8},
    {FrameType::black_box, "BLACK_BOX", Party::from_node, false, 8, Checksum::crc8},
}};

/// Null for an unassigned type.
[[nodiscard]] constexpr const FrameSpec* frame_spec(FrameType type) noexcept {
    for (const FrameSpec& spec : kFrameSpecs) {
        if (spec.type == type) {
            return &spec;
        }
    }
    return nullptr;
}

/// Whether an identifier of this kind may contain `node_id`.
[[nodiscard]] constexpr bool is_allowed(Party party, NodeId node_id) noexcept {
    switch (party) {
        case Party::from_host:
            return node_id == kHostId;
        case Party::from_node:
            return node_id != kHostId && node_id < kBroadcastId;
        case Party::to_node:
            return node_id != kHostId && node_id <= kBroadcastId;
    }
    return false;
}

/// The bytes of a RANGE_FD frame with `readings` (1..4): header byte, 14 bytes per reading, CRC-16, and zeros
/// up to the next length of CAN FD: 20, 32, 48 or 64.
[[nodiscard]] constexpr std::uint8_t range_fd_length(std::uint8_t readings) noexcept {
    return next_fd_length(static_cast<std::uint8_t>(1 + 14 * readings + 2));
}

}  // namespace octoskin::wire
