// Joint states that come from this machine rather than from the bus: a node in all but the wire, whose clock
// is the host's own. So they take the same way, and a recording's log holds them, as if a node had sent them.
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

/// Why a sample cannot be put into frames.
enum class LocalJointFault : std::uint8_t {
    wrong_count,  ///< not one value for each of the rig's joints
    not_a_number,
    too_large,  ///< beyond the +-8.38 rad of the wire
    too_soon,   ///< after the sample before it
};
[[nodiscard]] constexpr std::array<const char*, 4> names_of(LocalJointFault) {
    return {"wrong_count", "not_a_number", "too_large", "too_soon"};
}

class LocalJoints {
  public:
    /// `node_id`: the rig's source of joint states; `joint_count`: as many as it sends, 1..7. `rate_hz`: the
    /// rig's. An arm's driver may tell a thousand samples a second: those less than three quarters of a
    /// period after the one before are left out, since nobody on the bus can tell so many apart.
    LocalJoints(wire::NodeId node_id, std::size_t joint_count, double rate_hz);

    static constexpr double kLargest = 8.388607;  ///< what a frame's 24 bits with sign hold
    /// The frames of one sample, taken at `sampled` on the host's clock. Radians (metres for a prismatic
    /// joint), in the rig's order.
    [[nodiscard]] Result<std::array<wire::CanFrame, wire::kFramesPerJointSample>, LocalJointFault> frames(
        HostTime sampled, std::span<const double> position);

    /// The answer to a SYNC that ended at `ended`.
    [[nodiscard]] wire::CanFrame report(std::uint8_t sequence, HostTime ended) const;

  private:
    wire::NodeId node_id_;
    std::size_t joint_count_;
    Nanoseconds distance_min_;        ///< the least time between two samples
    std::optional<HostTime> newest_;  ///< when the newest sample was taken that became frames
    std::uint8_t sequence_ = 0;
};

}  // namespace octoskin
