#include "tests/ros/octree_collisions.hpp"

#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

namespace octoskin::ros {
namespace {

/// FCL's capsule lies along z, its centre at the origin.
fcl::Transform3d T_root_capsule(const Body& body) {
    fcl::Transform3d T = fcl::Transform3d::Identity();
    T.translation() = 0.5 * (body.p_root_a + body.p_root_b);
    T.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), body.p_root_b - body.p_root_a)
                     .toRotationMatrix();
    return T;
}

bool collide(const fcl::CollisionGeometryd& tree, const fcl::Transform3d& T_root_tree,
             const fcl::CollisionGeometryd& shape, const fcl::Transform3d& T_root_shape) {
    fcl::CollisionResultd result;
    return fcl::collide(&tree, T_root_tree, &shape, T_root_shape, fcl::CollisionRequestd(), result) > 0;
}

}  // namespace

struct OctreeCollisions::Object {
    explicit Object(const PosedOctree& octree) : tree(octree.tree) {
        T_root_map.matrix() = octree.T_root_map.matrix();
        tree.computeLocalAABB();
    }
    fcl::OcTreed tree;
    fcl::Transform3d T_root_map;
};

OctreeCollisions::OctreeCollisions(const PosedOctree* octree)
    : object_(octree == nullptr ? nullptr : std::make_unique<Object>(*octree)) {}

OctreeCollisions::~OctreeCollisions() = default;

bool OctreeCollisions::touches(const Body& body) const {
    if (object_ == nullptr) {
        return false;
    }
    const double length_m = (body.p_root_b - body.p_root_a).norm();
    if (length_m == 0.0) {
        fcl::Transform3d T_root_sphere = fcl::Transform3d::Identity();
        T_root_sphere.translation() = body.p_root_a;
        return collide(object_->tree, object_->T_root_map, fcl::Sphered(body.radius_m), T_root_sphere);
    }
    return collide(object_->tree, object_->T_root_map, fcl::Capsuled(body.radius_m, length_m),
                   T_root_capsule(body));
}

}  // namespace octoskin::ros
