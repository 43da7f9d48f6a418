// Oracle: FCL's collision of each fitted capsule, posed by the simulator's kinematics, with boxes in the
// places of the occupied voxels.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "host/core/query/robot_query.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "host/io/robot/robot_fit.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/own_arm/own_arm.hpp"
#include "tests/support/sampled_distance.hpp"

namespace octoskin::property {
namespace {

constexpr double kResolution_m = 0.04;
constexpr double kTolerance_m = 1e-6;

rig::Rig fitted_rig(const std::filesystem::path& urdf) {
    const auto text = read_robot_text(urdf, "").value();
    rig::Rig rig;
    rig.urdf = FilePlace::held(fit_robot(text, {}).value().urdf, urdf);
    rig.base_link = text.shapes.base_link;
    rig::JointSource& source = rig.joint_sources.emplace_back();
    for (const rig::ShapedJoint& joint : text.shapes.joints) source.joints.push_back(joint.name);
    return rig;
}

/// Free within reach of the arm, with some occupied voxels.
class Space {
  public:
    explicit Space(std::mt19937_64& random) {
        std::uniform_real_distribution<double> part(0.0, 1.0);
        boxes_.setup();
        for (double x = -1.6; x < 1.6; x += kResolution_m) {
            for (double y = -1.6; y < 1.6; y += kResolution_m) {
                for (double z = -1.2; z < 1.9; z += kResolution_m) {
                    const auto key = *map_.key_of({x + 0.02, y + 0.02, z + 0.02});
                    const bool is_occupied = part(random) < 0.002;
                    EXPECT_TRUE(map_.set_cube({key, 0}, is_occupied ? 1.0F : -1.0F));
                    if (is_occupied) add(key);
                }
            }
        }
        boxes_.setup();
    }
    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }

    [[nodiscard]] bool touches(const rig::Capsule& capsule, const Eigen::Isometry3d& T_map_link) const {
        const Eigen::Vector3d axis = capsule.p_link_b - capsule.p_link_a;
        fcl::Transform3d T_link_capsule = fcl::Transform3d::Identity();
        T_link_capsule.translation() = 0.5 * (capsule.p_link_a + capsule.p_link_b);
        if (axis.norm() > 0.0)
            T_link_capsule.linear() =
                Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
        fcl::CollisionObjectd object(std::make_shared<fcl::Capsuled>(capsule.radius_m, axis.norm()),
                                     T_map_link * T_link_capsule);
        bool is_hit = false;
        const_cast<fcl::DynamicAABBTreeCollisionManagerd&>(boxes_).collide(&object, &is_hit, one_pair);
        return is_hit;
    }

    /// Whether the surface of a capsule passes an occupied voxel within the tolerance.
    [[nodiscard]] bool is_close(const std::vector<PosedCapsule>& capsules) const {
        for (const PosedCapsule& capsule : capsules) {
            for (const VoxelKey key : occupied_) {
                const double distance_m =
                    sampled_distance(capsule.p_a, capsule.p_b, map_.centre_of(key), 0.5 * kResolution_m);
                if (std::abs(distance_m - capsule.radius_m) < kTolerance_m) return true;
            }
        }
        return false;
    }

  private:
    static bool one_pair(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* is_hit) {
        fcl::CollisionResultd result;
        bool& found = *static_cast<bool*>(is_hit);
        found = found || fcl::collide(a, b, fcl::CollisionRequestd(), result) > 0;
        return found;
    }
    void add(VoxelKey key) {
        fcl::Transform3d T_map_box = fcl::Transform3d::Identity();
        T_map_box.translation() = map_.centre_of(key);
        objects_.push_back(std::make_unique<fcl::CollisionObjectd>(
            std::make_shared<fcl::Boxd>(kResolution_m, kResolution_m, kResolution_m), T_map_box));
        boxes_.registerObject(objects_.back().get());
        occupied_.push_back(key);
    }

    FusedMap map_{MapConfig{.resolution_m = kResolution_m}};
    std::vector<VoxelKey> occupied_;
    std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
    fcl::DynamicAABBTreeCollisionManagerd boxes_;
};

TEST(FittedRobotProperty, a_query_answers_as_fcl_does) {
    const testing_support::OwnArm own;
    const rig::Rig rig = fitted_rig(own.urdf());
    const auto capsules = rig::real_body(rig).value();
    const auto arm = sim::Arm::read(rig.urdf, rig.base_link, rig.joint_names()).value();
    const HostSetup setup = make_host_setup(rig).value();
    const RobotQuery query = RobotQuery::build(setup.rig, setup.robot, {.ignores_unmoved = false}).value();
    ASSERT_GT(capsules.size(), 15U);
    ASSERT_EQ(query.capsule_count(), capsules.size());
    std::mt19937_64 random(33);
    std::size_t occupied = 0, free = 0, close = 0;
    constexpr unsigned kSpaces = 10;
    for (unsigned i = 0; i < kSpaces; ++i) {
        const Space space(random);
        for (unsigned k = 0; k < testing_support::cases(10'000) / kSpaces; ++k) {
            Eigen::VectorXd position(static_cast<Eigen::Index>(setup.robot.joint_count()));
            for (Eigen::Index joint = 0; joint < position.size(); ++joint)
                position[joint] = std::uniform_real_distribution<double>(-1.4, 1.4)(random);
            const auto posed =
                query.pose(std::span(position.data(), static_cast<std::size_t>(position.size()))).value();
            const auto answer = worst_of(query, space.map(), posed).value();
            const auto poses = arm.forward(position);
            const bool is_hit = std::ranges::any_of(capsules, [&](const rig::Capsule& capsule) {
                return space.touches(capsule, poses.at(capsule.link));
            });
            if (is_hit != (answer.state == PostureState::occupied)) {
                ASSERT_TRUE(space.is_close(posed)) << "seed 33, space " << i << ", posture " << k;
                ++close;
            }
            (is_hit ? occupied : free) += 1;
        }
    }
    std::printf("%zu capsules: %zu postures occupied, %zu free, %zu too close to tell\n", capsules.size(),
                occupied, free, close);
    EXPECT_GT(occupied, testing_support::cases(10'000) / 20);
    EXPECT_GT(free, testing_support::cases(10'000) / 20);
    EXPECT_LE(close, 2U);
}

}  // namespace
}  // namespace octoskin::property
