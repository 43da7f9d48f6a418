// What MoveIt 2 does with the octomap of a planning scene message: a stand-in for its PlanningScene.
//
// The rules are those of moveit_core's PlanningScene::setPlanningSceneDiffMsg and processOctomapMsg, and of
// octomap_msgs' readTree, as read in moveit2 (branch main, August 2026) and described here; the code is not
// theirs. Where MoveIt goes on with a message in the log, this refuses the sample, so that a test fails.
#pragma once

#include <octomap/OcTree.h>
#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/ros/codec.hpp"

namespace octoskin::ros {

/// The frames that MoveIt knows: T_root_frame of each.
using Frames = std::map<std::string, Eigen::Isometry3d>;

struct PosedOctree {
    std::shared_ptr<const octomap::OcTree> tree;
    Eigen::Isometry3d T_root_map = Eigen::Isometry3d::Identity();
};

class PlanningScene {
  public:
    enum class Change { none, replaced, cleared };

    struct Outcome {
        Change change = Change::none;
        std::vector<std::string> errors;  ///< Why the sample is refused; then nothing changes.
        std::vector<std::string>
            also_changes;  ///< Fields, not empty, which replace something of MoveIt's scene.
    };

    explicit PlanningScene(Frames frames) : frames_(std::move(frames)) {}

    /// Applies the bytes of a sample of moveit_msgs/PlanningScene.
    Outcome apply(const Bytes& sample);

    /// Null before a map came and after one was cleared.
    [[nodiscard]] const PosedOctree* octree() const { return octree_ ? octree_.get() : nullptr; }

  private:
    Frames frames_;
    std::unique_ptr<PosedOctree> octree_;
};

}  // namespace octoskin::ros
