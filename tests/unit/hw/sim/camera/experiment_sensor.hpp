// The experiment's moving arm in a world of two boxes, for tests of what its range sensors see.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "hw/sim/camera/sensor_scene.hpp"
#include "hw/sim/world/shapes.hpp"

namespace octoskin::sim {

inline constexpr SimTime kStart{3'000'000};
inline const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";
inline const std::vector<std::string> kMount = {"panda_link7", "panda_link8"};

template <class T, class E>
T expect_read(Result<T, E> result) {
    EXPECT_TRUE(result.has_value());
    return std::move(*result);
}

class ExperimentSensor : public testing::Test {
  protected:
    RangingScene scene(const Eigen::Isometry3d& T_flange_sensor, double sigma_m = 0.0, std::uint64_t seed = 0,
                       std::uint32_t noise_id = 0) const {
        return ranging_scene(surroundings(sigma_m, seed), {"panda_link8", T_flange_sensor, noise_id});
    }
    SensorSurroundings surroundings(double sigma_m, std::uint64_t seed) const {
        return {.world = world_,
                .arm = arm_,
                .trajectory = trajectory_,
                .body = body_,
                .ignored_links = kMount,
                .optics = {sigma_m, 0.04, 4.0},
                .seed = seed};
    }

    /// The flange points down, so its z is -z of base, its y is -y, and its x is x.
    static Eigen::Isometry3d looking(const Eigen::Vector3d& direction_flange) {
        const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
        const Eigen::Vector3d axis = z.cross(direction_flange);
        return Eigen::Isometry3d(
            Eigen::AngleAxisd(std::acos(z.dot(direction_flange)),
                              axis.isZero() ? Eigen::Vector3d::UnitX() : axis.normalized()));
    }

    static Solid box_at(const Eigen::Vector3d& size_m, const Eigen::Vector3d& centre) {
        const auto mesh = transformed(box_mesh(size_m), Eigen::Isometry3d(Eigen::Translation3d(centre)));
        return {"box/body/box", "box", mesh.vertices, mesh.triangles, true};
    }

    /// Of the experiment's world only the floor, top at z = -0.02, and the left shelf's back panel, front at
    /// x = 1.165.
    World world_{std::vector<Solid>{box_at({10, 10, 0.1}, {0, 0, -0.07}),
                                    box_at({0.03, 0.845, 1.0}, {1.18, 0.5075, 0.48})}};
    Scenario scenario_ = expect_read(read_scenario(kHw / "worlds/experiment.scenario.yaml"));
    Arm arm_ = expect_read(Arm::read(kHw / "robots/panda.urdf", "panda_link0",
                                     {"panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                                      "panda_joint5", "panda_joint6", "panda_joint7"}));
    Trajectory trajectory_ = expect_read(Trajectory::circle(arm_, scenario_.motion, kStart));
    Body body_ = Body(expect_read(rig::read_capsules(kHw / "robots/panda.urdf", {})));
};

}  // namespace octoskin::sim
