#include "host/apps/playback/losses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "host/core/pipeline/joint_text.hpp"

namespace octoskin {
namespace {

/// Details that the counters do not contain.
std::string detail(const Loss& loss, const Playback& playback) {
    if (loss.reason != "joints_missing") return {};
    const RobotTracker& robot = playback.pipeline.builder().robot();
    const std::string unknown = unknown_text(robot.times_unknown(), playback.rig.joint_names());
    for (std::size_t i = 0; i < playback.rig.joint_sources.size(); ++i)
        if (const auto& gap = robot.newest_gap(i)) return " " + gap_text(*gap) + unknown;
    return unknown;
}

/// The node of the joint states is reported as working only as far as its joint states are used.
void note_joint_loss(const Loss& loss, Playback& playback) {
    if (loss.unit != "joint samples" || !loss.is_mendable) return;
    const auto is_source = [&](wire::NodeId node) {
        return std::ranges::find(playback.rig.joint_sources, node, &rig::JointSource::node_id) !=
               playback.rig.joint_sources.end();
    };
    for (NodeSummary& node : playback.nodes) {
        if (is_source(node.node_id) && !node.loss) node.loss = loss;
    }
}

/// Causes come before their consequences: without joint states no reading has a pose.
int rank_of(const Loss& loss) {
    constexpr std::array<std::string_view, 6> kUnits{"log lines", "CAN frames",   "joint samples",
                                                     "readings",  "depth images", "depth frames"};
    const bool is_explained = !loss.is_mendable && loss.rejected < loss.of;
    const auto unit = std::ranges::find(kUnits, loss.unit) - kUnits.begin();
    return static_cast<int>(unit) + (is_explained ? 100 : 0);
}

}  // namespace

void find_losses(Playback& playback) {
    const bool is_empty = playback.pipeline.map().known_voxels() == 0;
    for (const CounterTable& table : playback.inputs) {
        auto loss = octoskin::loss_of(table);
        // A camera of which no image is used is lost, whatever the reason.
        const bool is_unused_camera = table.unit == "depth frames" && table.in > 0;
        if (!loss && (is_empty || is_unused_camera) && table.used == 0) loss = most_frequent(table);
        if (!loss) continue;
        auto& said = loss->is_mendable || is_empty || is_unused_camera ? playback.warnings : playback.notes;
        if (loss->reason != "wrong_size")  // the warnings already contain the size
            said.push_back(describe(*loss) + detail(*loss, playback));
        note_joint_loss(*loss, playback);
        playback.losses.push_back(std::move(*loss));
    }
    std::ranges::stable_sort(playback.losses, {}, rank_of);
    for (std::size_t i = 0; i < playback.rig.joint_sources.size(); ++i)
        if (const auto& beyond = playback.pipeline.joint_gate(i).beyond())
            playback.warnings.push_back(beyond_text(*beyond, playback.rig.joint_sources[i].joints));
}

}  // namespace octoskin
