// Converts joint states of this machine to CAN frames, as if a node whose clock is the host's own had sent
// them. They take the same path as bus frames and are recorded in the same log.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/joint_frames.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// Why a sample cannot be converted to frames.
enum class LocalJointFault : std::uint8_t {
    wrong_count,  ///< number of values differs from the number of the rig's joints
    not_a_number,
    too_large,  ///< beyond the +-8.38 rad of the wire format
    too_soon,   ///< too soon after the sample before
};
[[nodiscard]] constexpr std::array<const char*, 4> names_of(LocalJointFault) {
    return {"wrong_count", "not_a_number", "too_large", "too_soon"};
}

class LocalJoints {
  public:
    /// `node_id`: the rig's source of joint states. `joint_count`: number of joints it sends, 1..7.
    /// `rate_hz`: the rig's rate. An arm's driver may deliver 1000 samples a second. Samples less than three
    /// quarters of a period after the one before are refused, because their sequence numbers would wrap too
    /// fast.
    LocalJoints(wire::NodeId node_id, std::size_t joint_count, double rate_hz);

    static constexpr double kLargest = 8.388607;  ///< limit of a frame's signed 24-bit field
    /// The frames of one sample taken at `sampled` on the host's clock. `position`: radians (metres for a
    /// prismatic joint), in the rig's order.
    [[nodiscard]] Result<std::array<wire::CanFrame, wire::kFramesPerJointSample>, LocalJointFault> frames(
        HostTime sampled, std::span<const double> position);

    /// The answer to a SYNC that ended at `ended`.
    [[nodiscard]] wire::CanFrame report(std::uint8_t sequence, HostTime ended) const;

  private:
    wire::NodeId node_id_;
    std::size_t joint_count_;
    Nanoseconds distance_min_;        ///< minimum time between two samples
    std::optional<HostTime> newest_;  ///< time of the newest sample that became frames
    std::uint8_t sequence_ = 0;
};

}  // namespace octoskin
