#include "common/wire/joint_frames.hpp"

#include "common/wire/codec.hpp"

namespace octoskin::wire {

std::array<CanFrame, kFramesPerJointSample> joint_frames(
    NodeId node_id, std::uint8_t sequence, const std::array<std::int32_t, kJointsPerSample>& position_urad,
    const TimeResidue& sampled) noexcept {
    std::array<CanFrame, kFramesPerJointSample> frames{};
    for (std::uint8_t pair = 0; pair < 3; ++pair) {
        const std::size_t first = std::size_t{2} * pair;
        const JointPair message{pair, sequence, {position_urad[first], position_urad[first + 1]}};
        frames[pair] = encode(JointState{message}, node_id);
    }
    frames.back() = encode(JointState{JointLast{sequence, position_urad.back(), sampled}}, node_id);
    return frames;
}

}  // namespace octoskin::wire
