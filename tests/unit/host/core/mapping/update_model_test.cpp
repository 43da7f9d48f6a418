#include "host/core/mapping/update_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octoskin {
namespace {

/// Strong et al. 2021, eq. 5.
double probability(float log_odds) {
    return 1.0 - 1.0 / (1.0 + std::exp(static_cast<double>(log_odds)));
}

TEST(UpdateModel, proximity_is_silent_below_4_cm_and_speaks_from_there_on) {
    const HitModel model = UpdateModel{}.proximity;
    EXPECT_EQ(model.log_odds(0.0), 0.0F);
    EXPECT_EQ(model.log_odds(std::nextafter(0.04, 0.0)), 0.0F);
    EXPECT_FLOAT_EQ(model.log_odds(0.04), 0.9972F);
    EXPECT_FLOAT_EQ(model.log_odds(1.0), 0.93F);
    EXPECT_FLOAT_EQ(model.log_odds(4.0), 0.72F);
}

TEST(UpdateModel, depth_is_silent_up_to_and_including_half_a_metre) {
    const HitModel model = UpdateModel{}.depth;
    EXPECT_EQ(model.log_odds(0.4999), 0.0F);
    EXPECT_EQ(model.log_odds(0.5), 0.0F);
    EXPECT_FLOAT_EQ(model.log_odds(std::nextafter(0.5, 1.0)), 0.95F);
    EXPECT_FLOAT_EQ(model.log_odds(2.0), 0.8F);
    EXPECT_FLOAT_EQ(model.log_odds(4.0), 0.6F);
}

// The probabilities of one hit that the paper's own equations give; its prose swaps the two sensors.
TEST(UpdateModel, one_hit_gives_the_probabilities_of_the_equations) {
    const UpdateModel model;
    EXPECT_NEAR(probability(model.proximity.log_odds(0.04)), 0.7305, 5e-5);
    EXPECT_NEAR(probability(model.proximity.log_odds(4.0)), 0.6726, 5e-5);
    EXPECT_NEAR(probability(model.depth.log_odds(0.5000001)), 0.7211, 5e-5);
    EXPECT_NEAR(probability(model.depth.log_odds(4.0)), 0.6457, 5e-5);
    EXPECT_NEAR(probability(model.miss_log_odds), 0.4013, 5e-5);
}

}  // namespace
}  // namespace octoskin
