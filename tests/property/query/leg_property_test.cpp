// Oracle: the way itself, looked at every half millimetre, of the experiment's arm and one occupied voxel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <vector>

#include "host/core/query/path_query.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "tests/support/cases.hpp"

namespace octoskin::property {
namespace {

constexpr double kEdge_m = 0.04;
constexpr double kReach_m = 0.5;

HostSetup setup() {
    const auto rig =
        rig::read_rig(std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/rigs/experiment_zones.yaml");
    EXPECT_TRUE(rig) << rig.error().message();
    auto setup = make_host_setup(*rig);
    EXPECT_TRUE(setup) << setup.error().message();
    return std::move(setup).value();
}

/// Free as far as the arm reaches.
FusedMap free_room() {
    FusedMap map{MapConfig{.resolution_m = kEdge_m}};
    constexpr std::array<std::uint16_t, 2> kSides{32704, 32768};
    for (const auto x : kSides)
        for (const auto y : kSides)
            for (const auto z : kSides) EXPECT_TRUE(map.set_cube({{x, y, z}, 6}, -1.0F));
    return map;
}

class LegProperty : public testing::Test {
  protected:
    LegProperty() : setup_(setup()), robot_(RobotQuery::build(setup_.rig, setup_.robot).value()) {}

    double within(double min, double max) { return std::uniform_real_distribution(min, max)(random_); }

    /// Within the limits.
    std::vector<double> anywhere() {
        std::vector<double> position;
        for (const JointLimits& limit : setup_.robot.limits())
            position.push_back(within(limit.min, limit.max));
        return position;
    }
    std::vector<double> near(const std::vector<double>& from, double most) {
        std::vector<double> to;
        for (std::size_t i = 0; i < from.size(); ++i) {
            const JointLimits& limit = setup_.robot.limits()[i];
            to.push_back(std::clamp(from[i] + within(-most, most), limit.min, limit.max));
        }
        return to;
    }
    static std::vector<double> between(const std::vector<double>& from, const std::vector<double>& to,
                                       double share) {
        std::vector<double> position;
        for (std::size_t i = 0; i < from.size(); ++i) position.push_back(from[i] + share * (to[i] - from[i]));
        return position;
    }
    /// Where a capsule passes, or a little beside it.
    Eigen::Vector3d beside_the_way(const std::vector<double>& from, const std::vector<double>& to) {
        const auto capsules = robot_.pose(between(from, to, within(0.0, 1.0))).value();
        const auto of = static_cast<std::size_t>(within(0.0, static_cast<double>(capsules.size()) - 1e-9));
        const PosedCapsule& capsule = capsules.at(of);
        const Eigen::Vector3d away(within(-1.0, 1.0), within(-1.0, 1.0), within(-1.0, 1.0));
        return capsule.p_a + within(0.0, 1.0) * (capsule.p_b - capsule.p_a) +
               away.normalized() * (capsule.radius_m + within(0.0, 3.0 * kEdge_m));
    }

    /// The least distance on the way to the only occupied voxel.
    double least_on_way(const FusedMap& map, VoxelKey voxel, const std::vector<double>& from,
                        const std::vector<double>& to) const {
        double turned = 0.0;
        for (std::size_t i = 0; i < from.size(); ++i) turned += std::abs(to[i] - from[i]);
        const double looks = std::ceil(turned / 5e-4);  // no point of the arm is 1 m from any of its axes
        double least_m = kReach_m;
        for (double look = 0.0; look <= looks; look += 1.0) {
            const auto capsules = robot_.pose(between(from, to, look / looks));
            for (const PosedCapsule& capsule : *capsules) {
                const double diagonal_m = 0.5 * std::sqrt(3.0) * kEdge_m;
                if (distance_to_surface(capsule, map.centre_of(voxel)) - diagonal_m >= least_m) continue;
                least_m = std::min(least_m, clearance(map, capsule, kReach_m)->occupied_m.value_or(kReach_m));
            }
        }
        return least_m;
    }

    std::mt19937 random_{17};
    HostSetup setup_;
    RobotQuery robot_;
};

TEST_F(LegProperty, is_free_only_if_all_of_the_way_is_and_if_all_that_is_near_it_is_too) {
    const FusedMap room = free_room();
    unsigned touched = 0;
    unsigned reported_free = 0;
    for (unsigned i = 0; i < testing_support::cases(150); ++i) {
        const std::vector<double> from = anywhere();
        const std::vector<double> to = near(from, i % 2 == 0 ? 0.3 : 1.5);
        const auto voxel = room.key_of(beside_the_way(from, to)).value();
        FusedMap map = room.copy();
        ASSERT_TRUE(map.set_cube({voxel, 0}, 1.0F));
        const double step = i % 3 == 0 ? 10.0 : Leg::kStep;  // the guarantee is none of the steps'
        const auto answer = ask(robot_, map, Leg(robot_, map, from, to, step), {.reach_m = kReach_m});
        ASSERT_TRUE(answer);
        const double least_m = least_on_way(map, voxel, from, to);
        const bool is_free = answer->worst.state == PostureState::free;
        touched += least_m > 0.0 ? 0U : 1U;
        reported_free += is_free ? 1U : 0U;
        const double reported_m = answer->clearance.occupied_m.value_or(kReach_m);
        EXPECT_EQ(is_free, reported_m > 0.0) << i;
        EXPECT_LE(reported_m, least_m + 1e-9) << "leg " << i << " says it is further away than it comes";
        EXPECT_GE(reported_m, least_m - 0.25 * kEdge_m - 5e-4) << "leg " << i << " says it is nearer";
    }
    EXPECT_GT(touched, testing_support::cases(150) / 4);
    EXPECT_GT(reported_free, testing_support::cases(150) / 8);
}

TEST_F(LegProperty, has_for_each_capsule_on_the_way_a_larger_one_that_holds_it) {
    const FusedMap map = free_room();
    for (unsigned i = 0; i < testing_support::cases(200); ++i) {
        const std::vector<double> from = anywhere();
        const std::vector<double> to = near(from, i % 2 == 0 ? 0.05 : 1.5);
        const Leg leg(robot_, map, from, to, 10.0);
        const auto parts = static_cast<double>(leg.postures() - 1);
        for (unsigned k = 0; k < 100; ++k) {
            const double share = within(0.0, 1.0);
            const auto on_way = robot_.pose(between(from, to, share));
            const auto asked = leg.pose(robot_, static_cast<std::size_t>(share * parts));
            ASSERT_TRUE(on_way && asked);
            for (std::size_t c = 0; c < on_way->size(); ++c) {
                const double larger_m = (*asked)[c].radius_m - (*on_way)[c].radius_m;
                EXPECT_LE(larger_m, 0.25 * kEdge_m + 1e-12);
                EXPECT_LE(((*asked)[c].p_a - (*on_way)[c].p_a).norm(), larger_m + 1e-12) << i;
                EXPECT_LE(((*asked)[c].p_b - (*on_way)[c].p_b).norm(), larger_m + 1e-12) << i;
            }
        }
    }
}

/// What is not known of how fast the arm gets between two looks costs up to seven postures more.
TEST_F(LegProperty, has_no_more_postures_than_the_arm_moves_voxels) {
    const FusedMap map = free_room();
    for (unsigned i = 0; i < 100; ++i) {
        const std::vector<double> from = anywhere();
        const std::vector<double> to = near(from, 1.0);
        const Leg leg(robot_, map, from, to, 10.0);
        double length_m = 0.0;  // of the way of the end that goes furthest, were it always as fast
        constexpr int kLooks = 1000;
        auto before = robot_.pose(from).value();
        for (int look = 1; look <= kLooks; ++look) {
            auto now = robot_.pose(between(from, to, look / 1000.0)).value();
            for (std::size_t c = 0; c < now.size(); ++c)
                length_m = std::max({length_m, kLooks * (now[c].p_a - before[c].p_a).norm(),
                                     kLooks * (now[c].p_b - before[c].p_b).norm()});
            before = now;
        }
        const double parts = static_cast<double>(leg.postures()) - 1.0;
        EXPECT_GE(parts * 0.5 * kEdge_m, length_m * (1.0 - 1e-6)) << i;
        EXPECT_LE((parts - 1.0) * 0.5 * kEdge_m, 1.01 * length_m + 0.13) << i;
    }
}

}  // namespace
}  // namespace octoskin::property
