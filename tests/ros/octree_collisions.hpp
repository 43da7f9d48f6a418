// Which bodies of a robot touch an octree, by FCL, as in MoveIt 2: what the tree does not know is free.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "tests/ros/planning_scene.hpp"

namespace octoskin::ros {

/// A capsule in the root frame, metres; a sphere if both ends are the same.
struct Body {
    Eigen::Vector3d p_root_a;
    Eigen::Vector3d p_root_b;
    double radius_m = 0;
};

class OctreeCollisions {
  public:
    /// Without an octree nothing collides.
    explicit OctreeCollisions(const PosedOctree* octree);
    ~OctreeCollisions();

    [[nodiscard]] bool touches(const Body& body) const;

  private:
    struct Object;
    std::unique_ptr<Object> object_;
};

}  // namespace octoskin::ros
