#include "tests/bench/arm_capsules.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <stdexcept>

#include "host/core/kinematics/self_hit.hpp"
#include "host/core/query/segment_cube.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::bench {
namespace {

constexpr std::size_t kPostures = 100;
constexpr std::array kReady = {0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};
constexpr double kTurn_rad = 0.8;

octomap::OcTreeKey key_of(const octomap::OcTree& tree, const Eigen::Vector3d& point) {
    return tree.coordToKey(point.x(), point.y(), point.z());
}

}  // namespace

std::vector<ArmCapsules> postures_of_arm(const std::filesystem::path& rig,
                                         const Eigen::Isometry3d& T_map_arm) {
    const auto read = rig::read_rig(rig);
    if (!read) throw std::runtime_error("the rig cannot be read");
    const auto setup = make_host_setup(*read);
    if (!setup) throw std::runtime_error("the rig's robot cannot be read");
    // The first capsule is the base's, which is where it is in each posture.
    const auto body = RobotBody::build(std::span(setup->rig.body).subspan(1), setup->robot);
    if (!body || setup->robot.joint_count() != kReady.size()) throw std::runtime_error("no Panda in the rig");

    std::mt19937 random(4);
    std::uniform_real_distribution<double> turn_rad(-kTurn_rad, kTurn_rad);
    std::vector<Eigen::Isometry3d> T_base_link(setup->robot.link_count());
    std::vector<ArmCapsules> postures(kPostures);
    for (ArmCapsules& capsules : postures) {
        std::array<double, kReady.size()> position = kReady;
        for (double& joint : position) joint += turn_rad(random);
        setup->robot.forward(position, T_base_link);
        body->pose(T_base_link, capsules);
        for (PosedCapsule& capsule : capsules) {
            capsule.p_a = T_map_arm * capsule.p_a;
            capsule.p_b = T_map_arm * capsule.p_b;
        }
    }
    return postures;
}

CapsuleAnswer worst_in(const octomap::OcTree& tree, const PosedCapsule& capsule) {
    const double half_edge = 0.5 * tree.getResolution();
    const SegmentToCubes segment(capsule.p_a, capsule.p_b);
    const auto lowest = key_of(tree, capsule.p_a.cwiseMin(capsule.p_b).array() - capsule.radius_m);
    const auto highest = key_of(tree, capsule.p_a.cwiseMax(capsule.p_b).array() + capsule.radius_m);
    CapsuleAnswer worst;
    octomap::OcTreeKey key;
    for (key[0] = lowest[0]; key[0] <= highest[0]; ++key[0]) {
        for (key[1] = lowest[1]; key[1] <= highest[1]; ++key[1]) {
            for (key[2] = lowest[2]; key[2] <= highest[2]; ++key[2]) {
                const octomap::OcTreeNode* const node = tree.search(key);
                if (node != nullptr && !tree.isNodeOccupied(node)) continue;
                const Occupancy state = node == nullptr ? Occupancy::unknown : Occupancy::occupied;
                if (worst.state == Occupancy::occupied && state == Occupancy::unknown) continue;
                const Eigen::Vector3d centre(tree.keyToCoord(key[0]), tree.keyToCoord(key[1]),
                                             tree.keyToCoord(key[2]));
                const double distance_m = segment.distance(centre, half_edge);
                if (distance_m > capsule.radius_m) continue;
                if (worst.state == state && worst.distance_m <= distance_m) continue;
                worst = {state, VoxelKey{key[0], key[1], key[2]}, distance_m};
            }
        }
    }
    return worst;
}

}  // namespace octoskin::bench
