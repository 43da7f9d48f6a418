// The two ground truths of the experiment's world come from different code (rays and log-odds; sampled
// surfaces and solids), so each is the other's oracle.
#include <gtest/gtest.h>

#include "host/lab/evaluation/seen.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::evaluation {
namespace {

struct Counts {
    int camera_occupied = 0;
    int camera_occupied_beside_surface = 0;
    int surface = 0;
    int surface_unseen_by_tour = 0;
    int outside_unknown_to_tour = 0;
    int occluded = 0;
    int hidden_object = 0;
    int hidden_object_seen = 0;
};

Counts count(const Truth& truth) {
    Counts counts;
    for (std::size_t i = 0; i < truth.camera.size(); ++i) {
        const auto camera = truth.camera[i];
        const auto& surface = truth.surface[i];
        counts.camera_occupied += camera == Occupancy::occupied;
        counts.camera_occupied_beside_surface += camera == Occupancy::occupied && !surface.is_surface;
        counts.surface += surface.is_surface;
        counts.surface_unseen_by_tour += surface.is_surface && camera == Occupancy::unknown;
        counts.outside_unknown_to_tour +=
            !surface.is_surface && !surface.is_interior && camera == Occupancy::unknown;
        counts.occluded += surface.is_occluded;
        counts.hidden_object += surface.is_hidden_object;
        counts.hidden_object_seen += surface.is_hidden_object && surface.is_seen;
    }
    return counts;
}

class ExperimentTruth : public ::testing::Test {
  protected:
    static sim::World read_world() {
        auto world = sim::World::read(hw() / "worlds" / "experiment.sdf");
        EXPECT_TRUE(world) << world.error().message();
        return std::move(*world);
    }
    static rig::Camera read_camera() {
        const auto rig = rig::read_rig(hw() / "rigs" / "experiment.yaml");
        EXPECT_TRUE(rig) << rig.error().message();
        return rig->cameras.at(0);
    }
    static Eigen::Isometry3d shifted(double x, double y, double z) {
        Eigen::Isometry3d T_map_base = Eigen::Isometry3d::Identity();
        T_map_base.translation() << x, y, z;
        return T_map_base;
    }
    static Truth at(double x, double y, double z) {
        const sim::World world = read_world();
        TruthConfig config;
        config.hidden_models = {"cone", "crate"};
        config.external_cameras = {read_camera()};
        return build_truth(world, render_survey(world, SurveyConfig{}), config, shifted(x, y, z)).value();
    }

  private:
    static std::filesystem::path hw() { return std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw"; }
};

TEST_F(ExperimentTruth, the_tour_sees_every_surface_and_nothing_else) {
    const Truth truth = at(0.002990, 0.020829, 0.001814);
    const Counts counts = count(truth);
    EXPECT_EQ(truth.region().size(), 105000U);
    EXPECT_GT(counts.surface, 4000);
    EXPECT_LE(counts.camera_occupied_beside_surface, 2);
    EXPECT_LE(counts.surface_unseen_by_tour, 5);
    EXPECT_LE(counts.outside_unknown_to_tour, 5) << "the tour must leave no corner unseen";
    // What the tour calls free although a surface passes through: corners that most rays miss, under 4 %.
    EXPECT_GT(counts.camera_occupied, 0.96 * counts.surface);
}

TEST_F(ExperimentTruth, the_external_camera_sees_nothing_of_the_hidden_objects) {
    const Counts counts = count(at(0.018570, 0.037851, 0.036570));
    EXPECT_GT(counts.hidden_object, 250);
    EXPECT_EQ(counts.hidden_object_seen, 0);
    // The shelves' compartments: about a third of all surfaces.
    EXPECT_GT(counts.occluded, counts.surface / 4);
    EXPECT_LT(counts.occluded, counts.surface / 2);
}

/// The map of one image by OctoMap's own rule, any end is a hit, with space round the region.
FusedMap map_of_image(const sim::World& world, const rig::Camera& camera, const SeenTruth& truth,
                      const Eigen::Isometry3d& T_map_base) {
    const Survey one_view{{render_view(world, camera, camera.T_link_camera, 1)}};
    const KeyBox box = truth.region().padded(4);
    const auto grid = camera_truth(one_view, CameraTruthConfig{}, box, truth.resolution_m, T_map_base);
    std::vector<VoxelUpdate> terms;
    for (std::size_t i = 0; i < grid.size(); ++i) {
        if (grid[i] != Occupancy::unknown)
            terms.push_back({box.key_at(i), grid[i] == Occupancy::occupied ? 2.0F : -1.0F});
    }
    FusedMap map{MapConfig{}};
    feed(map, terms);
    return map;
}

TEST_F(ExperimentTruth, a_noise_free_image_is_right_in_all_that_it_sees) {
    const sim::World world = read_world();
    const rig::Camera camera = read_camera();
    const Eigen::Isometry3d T_map_base = shifted(0.002990, 0.020829, 0.001814);
    const auto truth = seen_truth(world, {&camera, 1}, TruthConfig{}, T_map_base);
    ASSERT_TRUE(truth) << truth.error().message();
    EXPECT_GT(truth->voxels.size(), 1500U);
    EXPECT_EQ(truth->p_map_clear_spheres.size(), 3000U);
    const SeenMetrics metrics = seen_metrics(map_of_image(world, camera, *truth, T_map_base), *truth);
    EXPECT_EQ(metrics.seen_occupied.value(), 1.0);
    EXPECT_EQ(metrics.body_2cm.value(), 0.0);
    EXPECT_EQ(metrics.body_5cm.value(), 0.0);
    EXPECT_GT(metrics.precision.value(), 0.998);
    EXPECT_GT(metrics.f1_seen.value(), 0.999);
    EXPECT_GT(metrics.availability_5cm.value(), 0.99);
}

}  // namespace
}  // namespace octoskin::evaluation
