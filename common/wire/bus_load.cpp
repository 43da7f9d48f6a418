#include "common/wire/bus_load.hpp"

#include <cassert>

namespace octoskin::wire {
namespace {

constexpr std::uint32_t kInterframeSpace = 3;
constexpr std::uint32_t kAckAndEnd = 1 + 1 + 7;  // ACK slot, ACK delimiter, end of frame

/// A stuff bit follows five equal bits and is the first bit of the next run. Worst case: the first after 5
/// bits, then one after every 4.
constexpr std::uint32_t worst_case_stuff_bits(std::uint32_t stuffed_bits) {
    return (stuffed_bits - 1) / 4;
}

double seconds(const FrameBits& bits, const BitRates& rates) {
    return static_cast<double>(bits.nominal) / rates.nominal + static_cast<double>(bits.data) / rates.data;
}

constexpr double kHeartbeatsPerS = 10.0;
constexpr double kJointFrames = 4.0;

std::uint8_t full_length(FrameType type) {
    return frame_spec(type)->payload_len;
}

}  // namespace

FrameBits worst_case_bits_classical(std::uint8_t payload_len) noexcept {
    assert(payload_len <= kClassicalPayloadMax);
    // Stuffed: SOF, identifier, RTR, IDE, r0, DLC, data and CRC. Not stuffed: the CRC delimiter and all after
    // it.
    const std::uint32_t stuffed = 1 + 11 + 1 + 1 + 1 + 4 + 8U * payload_len + 15;
    return {.nominal = stuffed + worst_case_stuff_bits(stuffed) + 1 + kAckAndEnd + kInterframeSpace};
}

FrameBits worst_case_bits_fd(std::uint8_t payload_len) noexcept {
    assert(is_fd_length(payload_len));
    // At the nominal rate: SOF, identifier, RRS, IDE, FDF, res, BRS. IDE = 0, FDF = 1, res = 0, BRS = 1
    // alternate, so no run of five equal bits extends past IDE: only SOF..IDE (14 bits) can be stuffed. The
    // bits in which the rate changes (BRS, CRC delimiter) count at the nominal rate, which is at most two
    // nominal bits too many.
    const std::uint32_t head = 1 + 11 + 1 + 1 + 1 + 1 + 1;
    const std::uint32_t head_stuffed = 14;
    // At the data rate: ESI, DLC and payload, stuffed in runs that may begin with BRS. Then the CRC field,
    // which contains the stuff count, with a fixed stuff bit at its start and after every 4 bits.
    const std::uint32_t body = 1 + 4 + 8U * payload_len;
    const std::uint32_t crc_field = 4 + (payload_len <= 16 ? 17U : 21U);
    const std::uint32_t fixed_stuff_bits = 1 + (crc_field - 1) / 4;
    return {.nominal = head + worst_case_stuff_bits(head_stuffed) + 1 + kAckAndEnd + kInterframeSpace,
            .data = body + worst_case_stuff_bits(1 + body) + crc_field + fixed_stuff_bits};
}

double worst_case_seconds(const CanFrame& frame, const BitRates& rates) noexcept {
    if (!frame.is_fd) return seconds(worst_case_bits_classical(frame.payload_len), rates);
    const std::uint32_t data_rate = frame.has_bit_rate_switch ? rates.data : rates.nominal;
    return seconds(worst_case_bits_fd(frame.payload_len), {.nominal = rates.nominal, .data = data_rate});
}

double bus_load(std::span<const Traffic> traffic, const BitRates& rates) noexcept {
    double load = 0.0;
    for (const Traffic& item : traffic) {
        const FrameSpec* spec = frame_spec(item.type);
        assert(spec != nullptr);
        const FrameBits bits =
            spec->is_fd ? worst_case_bits_fd(item.payload_len) : worst_case_bits_classical(item.payload_len);
        load += item.frames_per_s * seconds(bits, rates);
    }
    return load;
}

std::array<Traffic, 9> traffic_of(const BusUse& use) noexcept {
    const auto every_s = [](FrameType type, double frames_per_s) {
        return Traffic{.type = type, .payload_len = full_length(type), .frames_per_s = frames_per_s};
    };
    const Traffic readings = use.uses_can_fd
                                 ? Traffic{.type = FrameType::range_fd,
                                           .payload_len = range_fd_length(use.readings_per_fd_frame),
                                           .frames_per_s = use.readings_per_s / use.readings_per_fd_frame}
                                 : every_s(FrameType::range, use.readings_per_s);
    const double nodes = use.nodes;
    return {readings,
            every_s(FrameType::range_aux, use.aux_per_s),
            every_s(FrameType::joint_state, kJointFrames * use.joint_samples_per_s),
            every_s(FrameType::heartbeat, kHeartbeatsPerS * nodes),
            every_s(FrameType::sensor_health, use.sensors),
            every_s(FrameType::node_info, kInfoPages * nodes),
            every_s(FrameType::sync, 1.0),
            every_s(FrameType::follow_up, 1.0),
            every_s(FrameType::sync_report, nodes)};
}

}  // namespace octoskin::wire
