#include "host/apps/rig/sensor_ring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {
namespace {

TEST(SensorRing, is_read_from_its_text) {
    const auto ring = sensor_ring_of("forearm,8,-0.25");
    ASSERT_TRUE(ring);
    EXPECT_EQ(ring->link, "forearm");
    EXPECT_EQ(ring->count, 8U);
    EXPECT_EQ(ring->height_m, -0.25);
    EXPECT_EQ(sensor_ring_of("a,b,34,2")->link, "a,b");
    for (const char* wrong : {"", ",", ",,", "a", "a,8", "a,8,", ",8,0.1", "a,0,0.1", "a,35,0.1", "a,-1,0.1",
                              "a,8,2.1", "a,8,nan", "a,8,0.1x", "a,1.5,0.1", "a, 8,0.1"})
        EXPECT_EQ(sensor_ring_of(wrong).error().code, ErrorCode::bad_argument) << wrong;
}

TEST(SensorRing, lies_on_the_surface_around_the_middle_of_the_cut) {
    // Beside the link's z, two capsules side by side.
    const std::vector<rig::Capsule> body{{"arm", {0.2, 0.05, 0.0}, {0.2, 0.05, 0.5}, 0.06},
                                         {"arm", {0.2, -0.05, 0.0}, {0.2, -0.05, 0.5}, 0.06},
                                         {"other", {0.2, 0.0, 0.0}, {0.2, 0.0, 0.5}, 0.5}};
    const auto places = places_of({"arm", 12, 0.3}, body);
    ASSERT_TRUE(places);
    ASSERT_EQ(places->size(), 12U);
    for (std::size_t i = 0; i < places->size(); ++i) {
        const RingPlace& place = (*places)[i];
        EXPECT_NEAR(place.azimuth_deg, 30.0 * static_cast<double>(i), 1e-12);
        const double azimuth = place.azimuth_deg * std::numbers::pi / 180.0;
        const Eigen::Vector3d outward(std::cos(azimuth), std::sin(azimuth), 0.0);
        const Eigen::Vector3d from_middle = place.p_link - Eigen::Vector3d(0.2, 0.0, 0.3);
        EXPECT_NEAR(from_middle.normalized().dot(outward), 1.0, 1e-9);
        double distance_m = 1.0;
        for (std::size_t k = 0; k < 2; ++k)
            distance_m = std::min(
                distance_m,
                distance_to_surface({body[k].p_link_a, body[k].p_link_b, body[k].radius_m, 0}, place.p_link));
        EXPECT_GE(distance_m, -2e-9) << i;
        EXPECT_LT(distance_m, 1e-3) << i;
    }
    EXPECT_NEAR((*places)[3].p_link.y(), 0.11, 1e-9);
}

TEST(SensorRing, needs_a_body_at_its_height) {
    const std::vector<rig::Capsule> body{{"arm", {0, 0, 0}, {0, 0, 0.5}, 0.06}};
    EXPECT_TRUE(places_of({"arm", 4, 0.559}, body));
    EXPECT_EQ(places_of({"arm", 4, 0.561}, body).error().code, ErrorCode::no_data);
    EXPECT_EQ(places_of({"hand", 4, 0.1}, body).error().code, ErrorCode::no_data);
    const std::vector<rig::Capsule> ball{{"arm", {0, 0, 0}, {0, 0, 0}, 0.06}};
    EXPECT_NEAR((*places_of({"arm", 1, 0.0}, ball))[0].p_link.x(), 0.06, 1e-9);
}

}  // namespace
}  // namespace octoskin
