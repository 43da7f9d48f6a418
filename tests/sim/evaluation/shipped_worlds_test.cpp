// The worlds that come with the house, each with its scenario and its rig: that the arm can do its motion and
// touches nothing, that the camera does not see what is called hidden while some sensor does, and that the
// two ground truths agree. Oracles: single rays, distances to points of the surfaces, and each ground truth
// for the other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <ostream>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/lab/evaluation/truth.hpp"
#include "host/lab/study/study.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/arm/trajectory.hpp"
#include "hw/sim/scenario/hidden_models.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/triangle_lattice.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {
namespace {

const std::filesystem::path kHw = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw";

struct Shipped {
    std::string scenario;
    std::string rig;
};
void PrintTo(const Shipped& shipped, std::ostream* out) {
    *out << shipped.scenario << " with " << shipped.rig;
}

template <class T, class E>
T read_or_fail(Result<T, E> result) {
    if (!result) throw std::runtime_error(result.error().message());
    return std::move(*result);
}

class ShippedWorld : public testing::TestWithParam<Shipped> {
  protected:
    static Truth truth_of_seed(std::uint64_t seed, const sim::Scenario& scenario, const sim::World& world,
                               const rig::Rig& rig) {
        TruthConfig config = truth_config_of(scenario, 0.04);
        config.external_cameras = rig.external_cameras();
        Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
        T_map_base.translation() = scenario.map_shift_m(seed);
        return build_truth(world, render_survey(world, survey_config_of(scenario)), config, T_map_base)
            .value();
    }

    const sim::Scenario scenario_ =
        read_or_fail(sim::read_scenario(kHw / "worlds" / (GetParam().scenario + ".scenario.yaml")));
    const sim::World world_ = read_or_fail(sim::World::read(scenario_.world));
    const rig::Rig rig_ = read_or_fail(rig::read_rig(kHw / "rigs" / (GetParam().rig + ".yaml")));
    const sim::Arm arm_ = read_or_fail(sim::Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()));
};

class WorldBeforeCamera : public ShippedWorld {};
class WorldOfTwoTruths : public ShippedWorld {};
class WorldOfThinThings : public ShippedWorld {};
class WorldOfAnArm : public ShippedWorld {};

/// Voxels of both ground truths.
struct TruthCounts {
    explicit TruthCounts(const Truth& truth) {
        for (std::size_t i = 0; i < truth.camera.size(); ++i) {
            const SurfaceVoxel& voxel = truth.surface[i];
            surface += voxel.is_surface;
            occupied += truth.camera[i] == Occupancy::occupied;
            occupied_elsewhere += truth.camera[i] == Occupancy::occupied && !voxel.is_surface;
            unseen += !voxel.is_interior && truth.camera[i] == Occupancy::unknown;
            occluded += voxel.is_occluded;
            hidden += voxel.is_hidden_object && voxel.is_occluded;
        }
    }
    int surface = 0, occupied = 0, occupied_elsewhere = 0, unseen = 0, occluded = 0, hidden = 0;
};

/// The surfaces of a world as points about 5 mm apart.
class SurfacePoints {
  public:
    explicit SurfacePoints(const sim::World& world) {
        for (const sim::Solid& solid : world.solids()) {
            for (const Eigen::Vector3i& triangle : solid.triangles) {
                std::array<Eigen::Vector3d, 3> corners;
                Eigen::AlignedBox3d box;
                for (int i = 0; i < 3; ++i) {
                    corners[static_cast<std::size_t>(i)] =
                        solid.vertices[static_cast<std::size_t>(triangle[i])];
                    box.extend(corners[static_cast<std::size_t>(i)]);
                }
                // TriangleLattice wants the longest side first.
                const auto side = [&] { return (corners[1] - corners[0]).norm(); };
                const double longest =
                    std::max({side(), (corners[2] - corners[1]).norm(), (corners[0] - corners[2]).norm()});
                while (side() < longest) std::rotate(corners.begin(), corners.begin() + 1, corners.end());
                triangles_.push_back({box, sim::TriangleLattice(corners, 0.005)});
            }
        }
    }

    /// From a capsule to the nearest point, at most `reach_m`; negative inside.
    [[nodiscard]] double clearance_m(const sim::BodyCapsule& capsule, double reach_m) const {
        Eigen::AlignedBox3d near(capsule.p_base_a);
        near.extend(capsule.p_base_b);
        const Eigen::Vector3d margin = Eigen::Vector3d::Constant(capsule.radius_m + reach_m);
        near = Eigen::AlignedBox3d(near.min() - margin, near.max() + margin);
        const Eigen::Vector3d along = capsule.p_base_b - capsule.p_base_a;
        double clearance_m = reach_m;
        const auto consider = [&](const Eigen::Vector3d& point) {
            const Eigen::Vector3d from_a = point - capsule.p_base_a;
            const double part =
                along.isZero() ? 0.0 : std::clamp(from_a.dot(along) / along.squaredNorm(), 0.0, 1.0);
            clearance_m = std::min(clearance_m, (from_a - part * along).norm() - capsule.radius_m);
        };
        for (const auto& [box, lattice] : triangles_)
            if (box.intersects(near)) lattice.for_each_near(near, consider);
        return clearance_m;
    }

  private:
    std::vector<std::pair<Eigen::AlignedBox3d, sim::TriangleLattice>> triangles_;
};

const Shipped kBench = {"bench", "bench_one_board"};  // without a camera
const Shipped kCell = {"cell", "cell"};
const Shipped kCupboard = {"cupboard", "cupboard"};
const Shipped kExperiment = {"experiment", "experiment"};  // its truths: experiment_truth_test
const Shipped kHand = {"hand", "rods"};                    // not to be judged
const Shipped kMoving = {"moving", "experiment"};          // not to be judged
const Shipped kRods = {"rods", "rods"};
const Shipped kThinBench = {"thin_bench", "thin_bench"};
const Shipped kAll[] = {kBench, kCell, kCupboard, kExperiment, kHand, kMoving, kRods, kThinBench};

std::string name_of(const testing::TestParamInfo<Shipped>& shipped) {
    return shipped.param.scenario;
}

INSTANTIATE_TEST_SUITE_P(All, ShippedWorld, testing::ValuesIn(kAll), name_of);
INSTANTIATE_TEST_SUITE_P(All, WorldBeforeCamera,
                         testing::Values(kCell, kCupboard, kExperiment, kRods, kThinBench), name_of);
INSTANTIATE_TEST_SUITE_P(All, WorldOfTwoTruths, testing::Values(kCell, kCupboard), name_of);
INSTANTIATE_TEST_SUITE_P(All, WorldOfThinThings, testing::Values(kRods, kThinBench), name_of);
// Not the bench, where the wrist dips into the table.
INSTANTIATE_TEST_SUITE_P(All, WorldOfAnArm,
                         testing::Values(kCell, kCupboard, kExperiment, kHand, kMoving, kRods, kThinBench),
                         name_of);

TEST(ShippedWorlds, are_all_tested_here) {
    std::set<std::string> there;
    for (const auto& entry : std::filesystem::directory_iterator(kHw / "worlds")) {
        const std::string file = entry.path().filename().string();
        if (file.ends_with(".scenario.yaml")) there.insert(file.substr(0, file.find('.')));
    }
    std::set<std::string> tested;
    for (const Shipped& shipped : kAll) tested.insert(shipped.scenario);
    EXPECT_EQ(there, tested);
}

TEST_P(ShippedWorld, has_its_hidden_objects_and_every_tick_in_reach) {
    const auto checked = sim::check_hidden_models(scenario_, world_);
    EXPECT_TRUE(checked) << checked.error().message();
    const auto trajectory = sim::Trajectory::circle(arm_, scenario_.motion, sim::SimTime{0});
    EXPECT_TRUE(trajectory) << trajectory.error().message();
}

TEST_P(WorldOfAnArm, leaves_room_for_the_arm) {
    const auto trajectory = sim::Trajectory::circle(arm_, scenario_.motion, sim::SimTime{0});
    ASSERT_TRUE(trajectory) << trajectory.error().message();
    std::vector<rig::Capsule> capsules = read_or_fail(rig::real_body(rig_));
    std::erase_if(capsules, [&](const rig::Capsule& capsule) { return capsule.link == rig_.base_link; });
    ASSERT_FALSE(capsules.empty());
    const SurfacePoints surfaces(world_);
    double clearance_m = 0.1;
    for (std::int64_t us = 0; us <= trajectory->end().us; us += 200'000)
        for (const auto& capsule : sim::posed_body(capsules, arm_.forward(trajectory->at(sim::SimTime{us}))))
            clearance_m = std::min(clearance_m, surfaces.clearance_m(capsule, 0.1));
    EXPECT_GT(clearance_m, 0.03);
}

TEST_P(WorldBeforeCamera, hides_its_hidden_objects_from_every_pixel_of_the_camera) {
    ASSERT_FALSE(rig_.cameras.empty());
    const rig::Camera& camera = rig_.cameras.front();
    std::set<std::string> seen;
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
            const Eigen::Vector3d ray((u + 0.5 - camera.cx) / camera.fx, (v + 0.5 - camera.cy) / camera.fy,
                                      1.0);
            const auto hit = world_.cast(camera.T_link_camera.translation(),
                                         camera.T_link_camera.linear() * ray.normalized(), 20.0);
            if (hit) seen.insert(world_.solids()[hit->solid].model);
        }
    }
    EXPECT_GT(seen.size(), 2u) << "the camera must see something of the world";
    for (const std::string& hidden : scenario_.hidden_models)
        EXPECT_THAT(seen, testing::Not(testing::Contains(hidden)));
}

TEST_P(ShippedWorld, shows_its_hidden_objects_to_some_sensor_that_is_never_inside_a_solid) {
    const auto trajectory = sim::Trajectory::circle(arm_, scenario_.motion, sim::SimTime{0});
    ASSERT_TRUE(trajectory) << trajectory.error().message();
    std::set<std::string> met;
    for (std::int64_t us = 0; us <= trajectory->end().us; us += 100'000) {
        const auto poses = arm_.forward(trajectory->at(sim::SimTime{us}));
        for (const rig::Node& node : rig_.nodes) {
            for (const rig::Sensor& sensor : node.sensors) {
                const Eigen::Isometry3d T_base_sensor = poses.at(sensor.link) * sensor.T_link_sensor;
                EXPECT_FALSE(world_.is_inside(T_base_sensor.translation())) << sensor.name << " at " << us;
                const auto hit = world_.cast(T_base_sensor.translation(), T_base_sensor.linear().col(2),
                                             scenario_.ranges.max_m);
                if (hit) met.insert(world_.solids()[hit->solid].model);
            }
        }
    }
    EXPECT_GT(met.size(), 1u);
    for (const std::string& hidden : scenario_.hidden_models) EXPECT_THAT(met, testing::Contains(hidden));
}

TEST_P(WorldOfTwoTruths, has_two_ground_truths_that_agree) {
    const TruthCounts count(truth_of_seed(0, scenario_, world_, rig_));
    EXPECT_LE(count.occupied_elsewhere, 2);
    // Dark corners: none in the cell; in the cupboard the floor behind the drum, 1 %.
    EXPECT_LE(count.unseen, 0.015 * count.surface);
    // Corners and round sides that most rays pass: 2 % of the cell's surfaces, 6 % of the cupboard's.
    EXPECT_GT(count.occupied, 0.92 * count.surface);
    EXPECT_GT(count.occluded, count.surface / 10);
    EXPECT_LT(count.occluded, count.surface / 2);
    EXPECT_GT(count.hidden, 50);
}

TEST_P(WorldOfThinThings, has_two_ground_truths_that_agree) {
    const TruthCounts count(truth_of_seed(0, scenario_, world_, rig_));
    EXPECT_LE(count.occupied_elsewhere, 2);
    EXPECT_LE(count.unseen, 0.025 * count.surface);
    // Rods that most rays pass.
    EXPECT_GT(count.occupied, 0.9 * count.surface);
}

}  // namespace
}  // namespace octoskin::evaluation
