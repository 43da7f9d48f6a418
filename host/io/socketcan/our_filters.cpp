#include "host/io/socketcan/our_filters.hpp"

#include "common/wire/frame_type.hpp"

namespace octoskin::socketcan {

std::vector<IdFilter> our_filters(const HostRig& rig) {
    constexpr std::uint32_t kNodeBits = 63;
    std::vector<IdFilter> filters;
    filters.push_back({wire::kHostId, kNodeBits});  // SYNC, FOLLOW_UP and MARK of any host
    for (const HostNode& node : rig.nodes) filters.push_back({node.node_id, kNodeBits});
    for (const HostJointSource& source : rig.joint_sources) filters.push_back({source.node_id, kNodeBits});
    filters.push_back({wire::can_id(wire::FrameType::heartbeat, 0), wire::kStandardIdMax & ~kNodeBits});
    return filters;
}

}  // namespace octoskin::socketcan
