#include "host/core/cross_check/cross_checks.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>

namespace octoskin {
namespace {

int rank_of(CrossCheckFinding verdict) {
    switch (verdict) {
        case CrossCheckFinding::contradicts:
            return 2;
        case CrossCheckFinding::agrees:
            return 1;
        case CrossCheckFinding::cannot_tell:
            break;
    }
    return 0;
}

/// True if the second one is the stronger evidence.
bool is_weaker(const SensorEvidence& a, const SensorEvidence& b) {
    return std::tuple(rank_of(a.verdict()), a.evidence, a.compared) <
           std::tuple(rank_of(b.verdict()), b.evidence, b.compared);
}

void withdraw(SensorEvidence& evidence, SensorDoubt doubt) {
    evidence.is_far_off = false;
    evidence.fault.reset();
    evidence.doubt = doubt;
}

}  // namespace

CrossChecks::CrossChecks(const HostRig& rig, std::span<const CrossCheckConfig> configs) {
    assert(!configs.empty() && configs.size() == rig.cameras.size());
    for (std::size_t camera = 0; camera < configs.size(); ++camera)
        checks_.emplace_back(rig, configs[camera], camera);
}

void CrossChecks::forget_beams() {
    for (CrossCheck& check : checks_) check.forget_beams();
}

CrossChecks::SensorFinding CrossChecks::merged(std::span<const SensorEvidence> by_camera) {
    const auto strongest = std::ranges::max_element(by_camera, is_weaker);
    assert(strongest != by_camera.end());
    SensorFinding found{*strongest, static_cast<std::size_t>(strongest - by_camera.begin())};
    const bool agrees_with_one = std::ranges::any_of(by_camera, [](const SensorEvidence& evidence) {
        return evidence.verdict() == CrossCheckFinding::agrees;
    });
    if (found.evidence.contradicts() && agrees_with_one)
        withdraw(found.evidence, SensorDoubt::cameras_disagree);
    return found;
}

/// Its own finding takes it into account already.
bool CrossChecks::is_joint_suspect_by_another(std::size_t camera) const {
    return std::ranges::any_of(checks_, [&](const CrossCheck& check) {
        const PoseJudge& pose = check.pose();
        const bool is_suspect = pose.joints().is_suspect() || (pose.fault() && pose.fault()->joint);
        return &check != &checks_.at(camera) && is_suspect;
    });
}

std::optional<PoseFault> CrossChecks::pose_fault(std::size_t camera) const {
    std::optional<PoseFault> fault = checks_.at(camera).pose().fault();
    for (const CrossCheck& other : checks_) {
        const auto& of_other = other.pose().fault();
        if (fault && !fault->joint && of_other && of_other->joint) fault->joint = of_other->joint;
    }
    return fault;
}

CrossChecks::SensorFinding CrossChecks::finding(std::uint8_t node_id, std::uint8_t sensor) const {
    std::vector<SensorEvidence> by_camera;
    for (const CrossCheck& check : checks_) by_camera.push_back(check.evidence(node_id, sensor));
    SensorFinding found = merged(by_camera);
    if (found.evidence.contradicts() && is_joint_suspect_by_another(found.camera))
        withdraw(found.evidence, SensorDoubt::joint_is_off);
    return found;
}

bool CrossChecks::is_to_be_refused(std::uint8_t node_id, std::uint8_t sensor) const {
    const SensorFinding found = finding(node_id, sensor);
    return found.evidence.contradicts() && checks_[found.camera].is_to_be_refused(node_id, sensor);
}

}  // namespace octoskin
