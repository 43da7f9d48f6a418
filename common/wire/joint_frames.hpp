// One joint sample as the four frames that carry it: three pairs of joints, then the last one with the time.
#pragma once

#include <array>
#include <cstdint>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::wire {

inline constexpr std::size_t kFramesPerJointSample = 4;

/// In sending order. `position_urad`: microradians (micrometres for a prismatic joint), 24 bits signed each;
/// `sampled`: span kFdTimeSpanUs.
[[nodiscard]] std::array<CanFrame, kFramesPerJointSample> joint_frames(
    NodeId node_id, std::uint8_t sequence, const std::array<std::int32_t, kJointsPerSample>& position_urad,
    const TimeResidue& sampled) noexcept;

}  // namespace octoskin::wire
