#include "host/core/ingest/local_joints.hpp"

#include <cmath>

#include "common/wire/codec.hpp"
#include "common/wire/joint_frames.hpp"

namespace octoskin {
namespace {

constexpr double kMicro = 1e6;

/// A node's 32-bit microsecond counter that runs with the host's clock.
NodeTime node_time(HostTime time) {
    return {static_cast<std::uint32_t>(time.ns / 1000)};
}

}  // namespace

LocalJoints::LocalJoints(wire::NodeId node_id, std::size_t joint_count, double rate_hz)
    : node_id_(node_id), joint_count_(joint_count), distance_min_(std::llround(0.75e9 / rate_hz)) {}

Result<std::array<wire::CanFrame, wire::kFramesPerJointSample>, LocalJointFault> LocalJoints::frames(
    HostTime sampled, std::span<const double> position) {
    if (position.size() != joint_count_) return unexpected(LocalJointFault::wrong_count);
    std::array<std::int32_t, wire::kJointsPerSample> micro{};
    for (std::size_t i = 0; i < position.size(); ++i) {
        if (!std::isfinite(position[i])) return unexpected(LocalJointFault::not_a_number);
        if (std::abs(position[i]) > kLargest) return unexpected(LocalJointFault::too_large);
        micro[i] = static_cast<std::int32_t>(std::nearbyint(position[i] * kMicro));
    }
    // A sample older than the newest one is rejected later, by the intake.
    if (newest_ && sampled >= *newest_ && sampled - *newest_ < distance_min_)
        return unexpected(LocalJointFault::too_soon);
    newest_ = sampled;
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kJointSequenceCount);
    return wire::joint_frames(node_id_, sequence_, micro, wire::fd_residue(node_time(sampled)));
}

wire::CanFrame LocalJoints::report(std::uint8_t sequence, HostTime ended) const {
    return wire::encode(wire::SyncReport{sequence, node_time(ended)}, node_id_);
}

}  // namespace octoskin
