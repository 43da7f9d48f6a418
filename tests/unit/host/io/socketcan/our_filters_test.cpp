#include "host/io/socketcan/our_filters.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/wire/frame_type.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::socketcan {
namespace {

TEST(OurFilters, pass_the_rigs_identifiers_and_every_heartbeat_of_all_2048) {
    const HostRig rig = test::one_joint_rig();
    const auto filters = our_filters(rig);
    for (std::uint32_t id = 0; id <= wire::kStandardIdMax; ++id) {
        const wire::NodeId node = wire::node_of(id);
        const bool is_of_rig =
            std::ranges::any_of(rig.nodes, [&](const HostNode& of_rig) { return of_rig.node_id == node; });
        const bool is_ours = is_of_rig || node == wire::kHostId || node == rig.joint_sources.at(0).node_id ||
                             wire::type_of(id) == wire::FrameType::heartbeat;
        const bool passes =
            std::ranges::any_of(filters, [&](const IdFilter& filter) { return filter.passes(id); });
        ASSERT_EQ(passes, is_ours) << std::hex << id;
    }
}

}  // namespace
}  // namespace octoskin::socketcan
