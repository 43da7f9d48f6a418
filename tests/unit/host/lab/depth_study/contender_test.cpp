#include "host/lab/depth_study/contender.hpp"

#include <gmock/gmock.h>

#include "tests/support/errors/error_fields.hpp"
#include "tests/unit/host/lab/depth_study/plate_case.hpp"

namespace octoskin::depth_study {
namespace {

std::vector<std::string> labels_of(const std::vector<Contender>& contenders) {
    std::vector<std::string> labels;
    for (const Contender& contender : contenders) labels.push_back(contender.label());
    return labels;
}

void expect_refused(const AppError& error, ErrorCode code, const std::string& key) {
    EXPECT_EQ(error.exit, ExitCode::usage);
    EXPECT_EQ(error.error.code, code);
    EXPECT_EQ(error.error.key, key);
}

TEST(NamedNoise, is_a_deviation_in_metres) {
    for (const auto& [text, sigma_m] :
         {std::pair("0.001", 0.001), {"0.03", 0.03}, {"1e-2", 0.01}, {"0.1", 0.1}}) {
        const auto noise = named_noise(text);
        ASSERT_TRUE(noise) << text;
        EXPECT_EQ(noise->name, text);
        EXPECT_EQ(std::get<sim::GaussianNoise>(noise->noise.model).sigma_m, sigma_m);
        EXPECT_EQ(noise->law.sigma_m(0.5), sigma_m);
        EXPECT_EQ(noise->law.sigma_m(4.0), sigma_m);
    }
}

TEST(NamedNoise, is_that_of_a_kinect) {
    const auto noise = named_noise("kinect");
    ASSERT_TRUE(noise);
    EXPECT_TRUE(std::holds_alternative<sim::KinectNoise>(noise->noise.model));
    EXPECT_DOUBLE_EQ(noise->law.sigma_m(0.4), 0.0012);
    EXPECT_DOUBLE_EQ(noise->law.sigma_m(2.4), 0.0012 + 4.0 * 0.0019);
}

TEST(NamedNoise, is_nothing_else) {
    for (const char* text : {"", "0", "0.0009", "0.11", "-0.03", "nan", "inf", "3cm", "0.03 ", "Kinect"}) {
        const auto noise = named_noise(text);
        ASSERT_FALSE(noise) << text;
        expect_refused(noise.error(), ErrorCode::bad_value, "--noise");
    }
}

TEST(Contenders, are_each_configuration_with_each_factor_where_noise_is_removed) {
    EXPECT_THAT(labels_of(contenders({"denoised", "paper", "fast"}, *named_noise("0.02"), {0.5, 1.0})),
                testing::ElementsAre("denoised x0.5", "denoised", "paper", "fast x0.5", "fast"));
}

TEST(Contenders, get_the_noise_and_no_robot) {
    const auto noise = named_noise("kinect");
    const auto all = contenders({"denoised", "fast"}, *noise, {2.0});
    ASSERT_EQ(all.size(), 2U);
    for (const Contender& contender : all) {
        EXPECT_FALSE(contender.mapping.removes_robot_from_depth);
        const DepthNoiseLaw& law = contender.mapping.depth_denoiser.noise;
        for (const double depth_m : {0.4, 1.0, 4.0})
            EXPECT_DOUBLE_EQ(law.sigma_m(depth_m), 2.0 * noise->law.sigma_m(depth_m));
        EXPECT_DOUBLE_EQ(contender.mapping.depth_filter.sigma_m, 2.0 * noise->law.sigma_m(2.5));
    }
    EXPECT_EQ(all[0].mapping.depth_update, DepthUpdate::denoised);
    EXPECT_EQ(all[1].mapping.depth_update, DepthUpdate::fast);
}

TEST(Contenders, are_refused_with_a_noise_that_a_filter_does_not_accept) {
    const auto refused =
        contenders_of(find_configurations({"fast"}).value(), {1.0, 10.0}, named_noise("0.1")->law);
    ASSERT_FALSE(refused);
    expect_refused(refused.error(), ErrorCode::out_of_range, "--sigma-factor");
    EXPECT_EQ(contenders({"denoised"}, *named_noise("0.1"), {10.0}).size(), 1U) << "it has no filter";
}

TEST(Contenders, are_refused_for_images_without_noise) {
    const auto refused = contenders_of(find_configurations({"paper_noise_free_robot_seen"}).value(), {1.0},
                                       named_noise("0.03")->law);
    ASSERT_FALSE(refused);
    expect_refused(refused.error(), ErrorCode::unsupported, "--configurations");
}

}  // namespace
}  // namespace octoskin::depth_study
