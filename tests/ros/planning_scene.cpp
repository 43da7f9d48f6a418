#include "tests/ros/planning_scene.hpp"

#include <cmath>
#include <sstream>

#include "ros_types.h"
#include "tests/ros/cdr.hpp"

namespace octoskin::ros {
namespace {

using SceneMessage = moveit_msgs::msg::dds_::PlanningScene_;
using OctomapMessage = octomap_msgs::msg::dds_::Octomap_;
using PoseMessage = geometry_msgs::msg::dds_::Pose_;

/// DDS pads a sample to a multiple of four bytes.
constexpr std::size_t kPadding_max = 3;

/// MoveIt takes a quaternion of four zeros as no rotation, and makes others unit quaternions.
Eigen::Isometry3d pose_of(const PoseMessage& message) {
    const auto& p = message.position_();
    const auto& q = message.orientation_();
    Eigen::Quaterniond rotation(q.w_(), q.x_(), q.y_(), q.z_());
    if (rotation.norm() == 0.0) {
        rotation = Eigen::Quaterniond::Identity();
    }
    return Eigen::Translation3d(p.x_(), p.y_(), p.z_()) * rotation.normalized();
}

bool is_finite(const PoseMessage& message) {
    const auto& p = message.position_();
    const auto& q = message.orientation_();
    const double sum = p.x_() + p.y_() + p.z_() + q.x_() + q.y_() + q.z_() + q.w_();
    return std::isfinite(sum);
}

/// Binary data says free or occupied; other data are log-odds, which FCL compares with a new tree's
/// threshold, 0.5.
std::shared_ptr<const octomap::OcTree> read_tree(const OctomapMessage& message,
                                                 std::vector<std::string>& errors) {
    if (!(message.resolution_() > 0.0)) {
        errors.push_back("resolution is " + std::to_string(message.resolution_()));
        return nullptr;
    }
    auto tree = std::make_shared<octomap::OcTree>(message.resolution_());
    std::stringstream data(std::string(message.data_().begin(), message.data_().end()));
    message.binary_() ? tree->readBinaryData(data) : tree->readData(data);
    if (!data) {
        errors.push_back("octomap data end early");
    } else if (data.peek() != std::stringstream::traits_type::eof()) {
        errors.push_back("octomap data go on behind the tree");
    }
    return tree;
}

std::vector<std::string> fields_that_replace(const SceneMessage& scene) {
    std::vector<std::string> names;
    const auto note = [&](bool is_given, const char* name) {
        if (is_given) {
            names.emplace_back(name);
        }
    };
    note(!scene.robot_model_name_().empty(), "robot_model_name");
    note(!scene.fixed_frame_transforms_().empty(), "fixed_frame_transforms");
    note(!scene.allowed_collision_matrix_().entry_names_().empty(), "allowed_collision_matrix");
    note(!scene.link_padding_().empty(), "link_padding");
    note(!scene.link_scale_().empty(), "link_scale");
    note(!scene.robot_state_().joint_state_().name_().empty(), "robot_state.joint_state");
    note(!scene.robot_state_().attached_collision_objects_().empty(),
         "robot_state.attached_collision_objects");
    note(!scene.world_().collision_objects_().empty(), "world.collision_objects");
    return names;
}

std::vector<std::string> errors_of_flags(const SceneMessage& scene) {
    std::vector<std::string> errors;
    if (!scene.is_diff_()) {
        errors.emplace_back("is_diff is false: MoveIt would replace its whole scene");
    }
    if (!scene.robot_state_().is_diff_()) {
        errors.emplace_back("robot_state.is_diff is false: MoveIt would detach all bodies");
    }
    return errors;
}

}  // namespace

PlanningScene::Outcome PlanningScene::apply(const Bytes& sample) {
    const auto read = read_cdr<SceneMessage>(sample);
    const SceneMessage& scene = read.message;
    Outcome outcome{Change::none, errors_of_flags(scene), fields_that_replace(scene)};
    if (read.unread > kPadding_max) {
        outcome.errors.push_back(std::to_string(read.unread) + " bytes behind the message");
    }
    const auto& map = scene.world_().octomap_();
    if (map.octomap_().id_().empty()) {
        return outcome;
    }
    if (map.octomap_().id_() != "OcTree") {
        outcome.errors.push_back("octomap id is '" + map.octomap_().id_() + "', not 'OcTree'");
    }
    const auto frame = frames_.find(map.header_().frame_id_());
    if (frame == frames_.end()) {
        outcome.errors.push_back("unknown frame '" + map.header_().frame_id_() + "'");
    }
    if (!is_finite(map.origin_())) {
        outcome.errors.emplace_back("origin is not finite");
    }
    const bool is_cleared = map.octomap_().data_().empty();
    const auto tree = is_cleared ? nullptr : read_tree(map.octomap_(), outcome.errors);
    if (!outcome.errors.empty()) {
        return outcome;
    }
    outcome.change = is_cleared ? Change::cleared : Change::replaced;
    octree_ = is_cleared
                  ? nullptr
                  : std::make_unique<PosedOctree>(PosedOctree{tree, frame->second * pose_of(map.origin_())});
    return outcome;
}

}  // namespace octoskin::ros
