// The keys of the depth denoiser, and the camera's noise that other parts use.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "host/io/mapping/mapping_file.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::ScratchFolder;

Result<MappingConfig, Error> read_text(const std::string& text) {
    const ScratchFolder folder;
    return read_mapping(folder.write("my.yaml", text).string());
}
Error error_of(const std::string& text) {
    return error_in(read_text(text));
}

TEST(DenoiserKeys, are_refused_out_of_their_range) {
    struct Range {
        const char* key;
        const char* least;
        const char* below;
        const char* most;
        const char* above;
    };
    for (const Range& range :
         {Range{"noise_m", "0.0001", "0.00009", "1", "1.01"}, Range{"noise_per_m", "0", "-0.01", "1", "1.01"},
          Range{"noise_from_m", "0", "-0.01", "10", "10.1"}, Range{"gate_sigmas", "0.1", "0", "100", "101"},
          Range{"step_sigmas", "0.1", "0", "100", "101"}, Range{"drift_sigmas", "0.1", "0", "100", "101"},
          Range{"drift_memory", "0", "-0.01", "0.99", "1"}, Range{"count_max", "1", "0", "10000", "10001"},
          Range{"pair_sigmas", "0.1", "0", "100", "101"}, Range{"min_support", "0", "-1", "24", "25"},
          Range{"bias_per_m", "0", "-0.01", "0.1", "0.11"},
          Range{"doubt_sigmas", "0", "-0.1", "100", "101"}}) {
        const std::string key = std::string("depth_denoiser.") + range.key;
        const auto text = [&](const char* value) {
            return std::string("depth_denoiser:\n  ") + range.key + ": " + value + "\n";
        };
        for (const char* value : {range.least, range.most}) EXPECT_TRUE(read_text(text(value))) << key;
        for (const char* value : {range.below, range.above, ".nan", "much"})
            EXPECT_THAT(error_of(text(value)), AllOf(line_is(2), key_is(key))) << value;
    }
    EXPECT_THAT(error_of("depth_denoiser: {count_max: 2.5}\n"), code_is(ErrorCode::wrong_type));
    EXPECT_THAT(error_of("depth_denoiser: {sigma_m: 0.03}\n"), code_is(ErrorCode::unknown_key));
    EXPECT_THAT(error_of("moving_miss_log_odds: 0.1\n"),
                AllOf(code_is(ErrorCode::out_of_range), key_is("moving_miss_log_odds")));
}

TEST(DenoiserKeys, give_the_camera_s_noise_with_the_update_that_uses_them) {
    EXPECT_EQ(read_text("base: fast\ndepth_filter: {sigma_m: 0.01}\n")->camera_sigma_m(), 0.01);
    const auto config =
        read_text("depth_denoiser: {noise_m: 0.0012, noise_per_m: 0.0019, noise_from_m: 0.5}\n");
    EXPECT_DOUBLE_EQ(config->camera_sigma_m(), 0.0012 + 0.0019 * 4.0) << "at 2.5 m";
    EXPECT_TRUE(config->removes_camera_noise());
    EXPECT_TRUE(fast_mapping().removes_camera_noise());
    EXPECT_FALSE(paper_mapping().removes_camera_noise());
}

}  // namespace
}  // namespace octoskin
