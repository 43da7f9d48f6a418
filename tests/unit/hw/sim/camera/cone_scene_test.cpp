// What a range sensor that sees a cone sees from the experiment's moving arm. Oracle: planes and a post whose
// echoes are summed here, ray by ray, from their equations.
#include <gtest/gtest.h>

#include <cmath>

#include "hw/sim/vl53l1x/ranging_result.hpp"
#include "tests/unit/hw/sim/camera/experiment_sensor.hpp"

namespace octoskin::sim {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr int kConeDraws = 1000;

class ConeSensor : public ExperimentSensor {
  protected:
    RangingScene cone_scene(const Eigen::Isometry3d& T_flange_sensor, std::uint64_t seed = 0,
                            std::uint32_t noise_id = 0, double reflectivity = 0.5) const {
        SensorSurroundings seen = surroundings(0.0, seed);
        seen.optics.reflectivity = reflectivity;
        return ranging_scene(seen, {"panda_link8", T_flange_sensor, noise_id, rig::Cone{}});
    }
    /// Beside the arm, looking down at the floor from so far.
    static Eigen::Isometry3d above_floor(double height_m) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.translation() << 0.0, -2.0, 0.47 - height_m;
        return pose;
    }
    /// The mean over many rangings: the noise has none.
    static double mean_range_m(const RangingScene& scene, int count = kConeDraws) {
        double sum = 0.0;
        for (int i = 0; i < count; ++i) sum += *scene(static_cast<std::uint32_t>(i), {0}, Roi{}).range_m;
        return sum / count;
    }
};

struct PlaneSeen {
    double signal = 0.0;
    double range_m = 0.0;
};

/// A plane at `height_m` along the axis, turned by `tilt` about the sensor's x. All of it counts: for planes
/// whose echoes lie within 15 cm.
PlaneSeen plane_seen(double height_m, double tilt) {
    double weights = 0.0;
    PlaneSeen seen;
    double moment = 0.0;
    for (int i = 0; i < 16; ++i) {
        for (int j = 0; j < 16; ++j) {
            const double x = std::tan((-13.5 + 27.0 * (i + 0.5) / 16.0) * kDegree);
            const double y = std::tan((-13.5 + 27.0 * (j + 0.5) / 16.0) * kDegree);
            const double off_axis = std::atan(std::hypot(x, y));
            if (off_axis > 13.5 * kDegree) continue;
            const double weight = std::exp(-std::pow(off_axis / (7.0 * kDegree), 2.0) / 2.0);
            // Points (x, y, 1) t of the plane y sin(tilt) + z cos(tilt) = height cos(tilt).
            const double toward = y * std::sin(tilt) + std::cos(tilt);
            const double length = std::sqrt(x * x + y * y + 1.0);
            const double range_m = height_m * std::cos(tilt) / toward * length;
            const double signal = weight * 0.5 * (toward / length) / (range_m * range_m);
            weights += weight;
            seen.signal += signal;
            moment += signal * range_m;
        }
    }
    seen.range_m = moment / seen.signal;
    seen.signal /= weights;
    return seen;
}

TEST_F(ConeSensor, plane_head_on_is_a_little_further_than_its_distance) {
    const PlaneSeen expected = plane_seen(0.8, 0.0);
    EXPECT_NEAR(expected.range_m, 0.8, 0.012);  // by less than 1 / cos 13.5 degrees, 0.823
    EXPECT_GT(expected.range_m, 0.8);
    const auto scene = cone_scene(above_floor(0.8));
    const double sigma_m = 0.01 + 0.006 / std::sqrt(expected.signal);
    EXPECT_NEAR(scene(0, {0}, Roi{}).sigma_m, sigma_m, 1e-9);
    EXPECT_NEAR(mean_range_m(scene), expected.range_m, 5.0 * sigma_m / std::sqrt(kConeDraws));
}

TEST_F(ConeSensor, tilted_plane_pulls_the_range_towards_its_near_part) {
    const double tilt = 30.0 * kDegree;
    const PlaneSeen expected = plane_seen(0.4, tilt);
    EXPECT_LT(expected.range_m, plane_seen(0.4, 0.0).range_m);
    Eigen::Isometry3d pose = above_floor(0.4 * std::cos(tilt));
    pose.rotate(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()));
    const auto scene = cone_scene(pose);
    const double sigma_m = 0.01 + 0.006 / std::sqrt(expected.signal);
    EXPECT_NEAR(scene(0, {0}, Roi{}).sigma_m, sigma_m, 1e-9);
    EXPECT_NEAR(mean_range_m(scene), expected.range_m, 5.0 * sigma_m / std::sqrt(kConeDraws));
}

TEST_F(ConeSensor, sees_a_thing_beside_its_axis_that_one_ray_misses) {
    // The panel's front is at x = 1.165; its lower edge stands on the floor, its upper at z = 0.98. Beside
    // it, at y = 0.02, ideal rays along x pass; the panel begins at y = 0.085, 5.4 degrees off the axis at
    // 0.69 m.
    Eigen::Isometry3d pose = looking({1, 0, 0});
    pose.translation() << 0.03, 0.28, 0.0;  // the flange's y is -y of base: y = 0.3 - 0.28
    EXPECT_FALSE(scene(pose)(0, {0}, Roi{}).range_m);
    const auto seen = cone_scene(pose)(0, {0}, Roi{});
    ASSERT_TRUE(seen.range_m);
    EXPECT_NEAR(*seen.range_m, 0.69, 5.0 * seen.sigma_m);
}

TEST_F(ConeSensor, sees_the_arm_beside_its_axis) {
    // 0.15 m aside the axis passes the arm's capsules; the cone's edge meets link 6's.
    Eigen::Isometry3d pose = looking({0, 0, -1});
    pose.translation() << 0.0, 0.15, 0.3;
    EXPECT_FALSE(scene(pose)(0, {0}, Roi{}).range_m);
    const auto seen = cone_scene(pose)(0, {0}, Roi{});
    ASSERT_TRUE(seen.range_m);
    EXPECT_LT(*seen.range_m, 0.5);
}

TEST_F(ConeSensor, weak_signal_fails_with_the_logistic_chance) {
    for (const double height_m : {2.9, 3.1, 3.5}) {
        const double signal = plane_seen(height_m, 0.0).signal;
        const auto scene = cone_scene(above_floor(height_m));
        int failed = 0;
        for (std::uint32_t i = 0; i < kConeDraws; ++i)
            failed += scene(i, {0}, Roi{}).peak_signal_mcps < 1.0 ? 1 : 0;
        const double chance = 1.0 / (1.0 + std::exp((signal - 0.05) / 0.01));
        EXPECT_NEAR(static_cast<double>(failed) / kConeDraws, chance,
                    5.0 * std::sqrt(chance * (1.0 - chance) / kConeDraws))
            << "at " << height_m;
    }
}

TEST_F(ConeSensor, nothing_in_view_is_no_return_and_next_to_no_signal) {
    Eigen::Isometry3d up = looking(Eigen::Vector3d(0, -1, -1).normalized());
    up.translation().y() = -1.0;
    const auto seen = cone_scene(up)(3, {0}, Roi{});
    EXPECT_FALSE(seen.range_m);
    EXPECT_LT(seen.peak_signal_mcps, 1.0);
    EXPECT_GT(seen.sigma_m, 1.0);
}

TEST_F(ConeSensor, has_noise_of_its_own_by_ranging_index) {
    const auto scene = cone_scene(above_floor(0.8), 9, 5);
    const auto once = scene(17, {0}, Roi{});
    static_cast<void>(scene(18, {0}, Roi{}));
    EXPECT_EQ(scene(17, {0}, Roi{}).range_m, once.range_m);
    EXPECT_EQ(cone_scene(above_floor(0.8), 9, 5)(17, {0}, Roi{}).peak_signal_mcps, once.peak_signal_mcps);
    EXPECT_NE(cone_scene(above_floor(0.8), 9, 6)(17, {0}, Roi{}).range_m, once.range_m);
    EXPECT_NE(cone_scene(above_floor(0.8), 8, 5)(17, {0}, Roi{}).peak_signal_mcps, once.peak_signal_mcps);
}

TEST_F(ConeSensor, zone_takes_its_part_of_the_signal_and_of_the_light_around) {
    const auto scene = cone_scene(above_floor(0.8));
    const auto whole = scene(0, {0}, Roi{});
    const auto quarter = scene(0, {0}, Roi{.centre_spad = 28, .width = 8, .height = 8});
    EXPECT_GT(quarter.sigma_m, whole.sigma_m);
    EXPECT_DOUBLE_EQ(quarter.ambient_mcps, 0.25 * whole.ambient_mcps);
}

/// The distance of a wall at which a whole array, and zones in its middle, lose half of their ranges.
TEST_F(ConeSensor, zones_reach_as_far_as_the_datasheet_says_to_15_percent) {
    const auto reach_m = [&](std::uint8_t side, double reflectivity) {
        const Roi zone{.centre_spad = 199, .width = side, .height = side};
        const double limit = 0.05 * signal_limit_share(zone);
        double near = 0.2, far = 4.0;  // the wall's signal falls with the square of its distance
        while (far - near > 1e-3) {
            const double middle = 0.5 * (near + far);
            const double sigma_m = cone_scene(above_floor(middle), 0, 0, reflectivity)(0, {0}, zone).sigma_m;
            (std::pow(0.006 / (sigma_m - 0.01), 2.0) > limit ? near : far) = middle;
        }
        return near;
    };
    struct OfDatasheet {  // DS12385 rev 7, table 9: centimetres in the dark
        double reflectivity;
        double whole, of_8_by_8, of_4_by_4;
    };
    for (const auto& [reflectivity, whole, of_8_by_8, of_4_by_4] :
         {OfDatasheet{0.88, 360.0, 308.0, 170.0}, OfDatasheet{0.54, 340.0, 254.0, 143.0},
          OfDatasheet{0.17, 170.0, 119.0, 45.0}}) {
        SCOPED_TRACE(reflectivity);
        const double seen = reach_m(16, reflectivity);
        EXPECT_NEAR(reach_m(8, reflectivity) / seen, of_8_by_8 / whole, 0.15 * of_8_by_8 / whole);
        EXPECT_NEAR(reach_m(4, reflectivity) / seen, of_4_by_4 / whole, 0.15 * of_4_by_4 / whole);
    }
}

}  // namespace
}  // namespace octoskin::sim
