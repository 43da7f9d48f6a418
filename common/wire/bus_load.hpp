// The share of the bus that a rig's frames need in the worst case. It is computed, not measured: a rig that
// could overload its bus is refused when it is loaded.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/wire/can_frame.hpp"
#include "common/wire/frame_type.hpp"

namespace octoskin::wire {

/// A rig above this is refused. The rest is for retransmissions, commands and the frames of other devices.
inline constexpr double kBusLoadLimit = 0.70;

struct BitRates {
    std::uint32_t nominal = 1'000'000;
    std::uint32_t data = 5'000'000;  ///< after the bit rate switch; CAN FD only
};

/// The bits of one frame, with worst-case stuffing and the 3 bits between frames.
struct FrameBits {
    std::uint32_t nominal = 0;  ///< at the nominal bit rate
    std::uint32_t data = 0;     ///< at the data bit rate; 0 in classical format
};

/// Classical data frame with an 11-bit identifier and `payload_len` <= 8 bytes: 135 bits for 8. Source:
/// Davis, Burns, Bril, Lukkien 2007, "Controller Area Network (CAN) schedulability analysis", equation 1.
[[nodiscard]] FrameBits worst_case_bits_classical(std::uint8_t payload_len) noexcept;

/// CAN FD frame with an 11-bit identifier, bit rate switch and `payload_len` a CAN FD length. Source: the
/// frame format of ISO 11898-1:2015; the derivation is in the .cpp.
[[nodiscard]] FrameBits worst_case_bits_fd(std::uint8_t payload_len) noexcept;

/// The longest time in seconds for which this frame occupies a bus of these rates. A CAN FD frame without bit
/// rate switch has all its bits at the nominal rate.
[[nodiscard]] double worst_case_seconds(const CanFrame& frame, const BitRates& rates) noexcept;

/// Frames of one kind on one bus, all nodes together.
struct Traffic {
    FrameType type = FrameType::range;
    std::uint8_t payload_len = 8;
    double frames_per_s = 0.0;
};

/// The share of time for which `traffic` keeps the bus busy: 1.0 is a full bus, and the result may exceed it.
/// The types must be assigned ones. O(traffic).
[[nodiscard]] double bus_load(std::span<const Traffic> traffic, const BitRates& rates) noexcept;

/// The bus traffic of a rig.
struct BusUse {
    std::uint32_t nodes = 0;                 ///< all nodes, with the sender of joint states
    std::uint32_t sensors = 0;               ///< all nodes together
    double readings_per_s = 0.0;             ///< all sensors together
    double aux_per_s = 0.0;                  ///< RANGE_AUX frames, all nodes together; classical only
    double joint_samples_per_s = 0.0;        ///< of four frames each
    bool uses_can_fd = false;                ///< readings are sent as RANGE_FD, not as RANGE
    std::uint8_t readings_per_fd_frame = 1;  ///< 1..4; 1 is the worst case
};

/// All that such a rig sends regularly: readings, joint states, heartbeats at 10 Hz; each second one
/// SENSOR_HEALTH per sensor, all NODE_INFO pages of each node, and SYNC, FOLLOW_UP and the reports. Commands,
/// marks and health reports on a change are rare; `kBusLoadLimit` leaves room for them.
[[nodiscard]] std::array<Traffic, 9> traffic_of(const BusUse& use) noexcept;

}  // namespace octoskin::wire
