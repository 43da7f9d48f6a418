#include "host/core/ingest/local_joints.hpp"

#include <cmath>

#include "common/wire/codec.hpp"

namespace octoskin {
namespace {

constexpr double kMicro = 1e6;

/// A node's 32-bit counter of microseconds, running as the host's clock does.
NodeTime node_time(HostTime time) {
    return {static_cast<std::uint32_t>(time.ns / 1000)};
}

}  // namespace

Result<std::array<wire::CanFrame, LocalJoints::kFrames>, LocalJointFault> LocalJoints::frames(
    HostTime sampled, std::span<const double> position) {
    if (position.size() != joint_count_) return unexpected(LocalJointFault::wrong_count);
    std::array<std::int32_t, wire::kJointsPerSample> micro{};
    for (std::size_t i = 0; i < position.size(); ++i) {
        if (!std::isfinite(position[i])) return unexpected(LocalJointFault::not_a_number);
        if (std::abs(position[i]) > kLargest) return unexpected(LocalJointFault::too_large);
        micro[i] = static_cast<std::int32_t>(std::nearbyint(position[i] * kMicro));
    }
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kJointSequenceCount);
    std::array<wire::CanFrame, kFrames> frames{};
    for (std::uint8_t pair = 0; pair < 3; ++pair) {
        const std::size_t first = std::size_t{2} * pair;
        const wire::JointPair message{pair, sequence_, {micro[first], micro[first + 1]}};
        frames[pair] = wire::encode(wire::JointState{message}, node_id_);
    }
    const wire::JointLast last{sequence_, micro.back(), wire::fd_residue(node_time(sampled))};
    frames.back() = wire::encode(wire::JointState{last}, node_id_);
    return frames;
}

wire::CanFrame LocalJoints::report(std::uint8_t sequence, HostTime ended) const {
    return wire::encode(wire::SyncReport{sequence, node_time(ended)}, node_id_);
}

}  // namespace octoskin
