#include "host/core/kinematics/turned_z.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin {
namespace {

void expect_turns(const Eigen::Vector3d& direction) {
    SCOPED_TRACE(testing::Message() << direction.transpose());
    const Eigen::Matrix3d R = turned_z(direction);
    EXPECT_LT((R * Eigen::Vector3d::UnitZ() - direction).norm(), 1e-15);
    EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_GT(R.determinant(), 0.0);
    // The smallest rotation leaves alone what is across both.
    const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(direction);
    EXPECT_LT((R * across - across).norm(), 1e-14);
}

TEST(TurnedZ, turns_z_into_any_direction) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 1000; ++i)
        expect_turns(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
    for (const double off : {0.0, 1e-200, 1e-15, 1e-9, 1.5e-6, 1e-3}) {
        for (const double z : {1.0, -1.0}) {
            expect_turns(Eigen::Vector3d(off, 0.0, z).normalized());
            expect_turns(Eigen::Vector3d(-off, 0.3 * off, z).normalized());
        }
    }
    EXPECT_EQ(turned_z(Eigen::Vector3d::UnitZ()), Eigen::Matrix3d::Identity());
}

}  // namespace
}  // namespace octoskin
