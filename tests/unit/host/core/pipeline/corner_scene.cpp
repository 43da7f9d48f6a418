#include "tests/unit/host/core/pipeline/corner_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/core/kinematics/turned_z.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

constexpr std::uint8_t kSideways = 1;
constexpr std::uint8_t kUpwards = 2;

/// The first wall of the corner that a ray meets, as a multiple of `direction`: the back, 1 m behind the
/// column, and one to the side and one above that lean away from it, so that the camera sees all three well.
double to_corner(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
    const std::pair<Eigen::Vector3d, double> walls[] = {
        {{-1.0, 0.0, 0.0}, 1.0}, {{-0.6, 0.8, 0.0}, 1.15}, {{-0.6, 0.0, 0.8}, 1.15}};
    double nearest = 1e9;
    for (const auto& [normal, distance_m] : walls) {
        const double slope = normal.dot(direction);
        if (slope > 0.0) nearest = std::min(nearest, (distance_m - normal.dot(from)) / slope);
    }
    return nearest;
}

}  // namespace

HostRig in_corner(HostRig rig) {
    rig.cameras.front().intrinsics = {
        .width = 100, .height = 100, .fx = 50.0, .fy = 50.0, .cx = 50.0, .cy = 50.0};
    auto& sensors = rig.nodes[0].sensors;
    for (const auto& [sensor, direction] : {std::pair{kSideways, Eigen::Vector3d(0.6, -0.75, 0.1)},
                                            std::pair{kUpwards, Eigen::Vector3d(0.6, 0.1, 0.75)}}) {
        sensors[sensor].T_link_sensor = sensors[kGood].T_link_sensor;
        sensors[sensor].T_link_sensor.linear() = turned_z(direction.normalized());
    }
    return rig;
}

CornerLooks::CornerLooks(MapBuilder& builder, const HostRig& rig, double begin_s)
    : builder_(builder), rig_(rig), begin_s_(begin_s) {
    for (int i = 0; i < 300; ++i) (void)look(std::nullopt);
}

Status<ReadingReason> CornerLooks::look(std::optional<double> off_m) {
    const int place = image_ % 16;  // there and back
    const double angle = M_PI - 0.06 * (place < 8 ? place : 16 - place);
    const double at_s = begin_s_ + 0.1 * image_++;
    now_ = host_at(at_s);
    EXPECT_TRUE(builder_.add({now_, {angle}}));
    for (const std::uint8_t other : {kSpare, kSideways, kUpwards})
        EXPECT_TRUE(builder_.integrate(reading(other, angle, 0.0)));
    const auto fate =
        off_m ? builder_.integrate(reading(kGood, angle, *off_m)) : Status<ReadingReason>(Done{});
    EXPECT_TRUE(builder_.integrate(frame()));
    return fate;
}

int CornerLooks::look_until(double off_m, bool is_refused, int images_max) {
    for (int i = 1; i <= images_max; ++i) {
        if (look(off_m).has_value() != is_refused) return i;
    }
    return 0;
}

RangeMeasurement CornerLooks::reading(std::uint8_t sensor, double angle, double off_m) const {
    const Eigen::Isometry3d T_base_sensor =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * rig_.nodes[0].sensors[sensor].T_link_sensor;
    const double range_m = to_corner(T_base_sensor.translation(), T_base_sensor.linear().col(2));
    return {{kLeft, sensor, 0}, now_, range_m - off_m, 0.02};
}

DepthFrame CornerLooks::frame() const {
    const Eigen::Isometry3d& T_base_camera = rig_.cameras.front().T_link_camera;
    DepthFrame frame{.captured = now_, .width = 100, .height = 100, .depth_mm = {}};
    for (int v = 0; v < 100; ++v) {
        for (int u = 0; u < 100; ++u) {
            const Eigen::Vector3d ray((u + 0.5 - 50.0) / 50.0, (v + 0.5 - 50.0) / 50.0, 1.0);
            const double depth_m = to_corner(T_base_camera.translation(), T_base_camera.linear() * ray);
            frame.depth_mm.push_back(static_cast<std::uint16_t>(std::lround(1e3 * depth_m)));
        }
    }
    return frame;
}

}  // namespace octoskin::test
