// What the comparison with the camera names, sensors or the camera, in six worlds of thin things near the
// arm. Nothing was chosen by what happens in them. The figures are in docs/results/notebook-2026-11.md.
// By default a few runs; all of them with OCTOSKIN_CROSS_CHECK_SEEDS=4; the worlds by which limits were
// chosen with OCTOSKIN_CROSS_CHECK_WORLDS=tuning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "tests/sim/cross_check/cross_check_runs.hpp"

namespace octoskin {
namespace {

using namespace testing_support;

class CrossCheckAmong : public testing::TestWithParam<std::size_t> {};

TEST_P(CrossCheckAmong, thin_things_names_no_sound_sensor) {
    if (GetParam() >= places().size()) GTEST_SKIP() << "there are fewer such worlds";
    const Place& place = places()[GetParam()];
    for (std::uint64_t seed = 0; seed < std::max<std::uint64_t>(1, seeds()); ++seed) {
        // Every day another kind of optics in each world, with half of the pixels a side.
        std::vector<std::string> rigs = rigs_of(place);
        if (seeds() == 0) rigs = {rigs[GetParam() % 3]};
        for (const KeptRun& run : keep_runs(rigs, seeds() == 0 ? 2 : 1, choice_of(place, seed))) {
            const Outcome outcome = outcome_of(run);
            const std::string what =
                std::string(place.world) + ", " + run.rig.name + ", seed " + std::to_string(seed);
            print(what, outcome);
            EXPECT_EQ(outcome.named.size(), 0U) << what;
            EXPECT_FALSE(outcome.fault_named_s) << what;
            EXPECT_GT(outcome.compared, 20U) << what << ": nothing was compared";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Worlds, CrossCheckAmong, testing::Range<std::size_t>(0, 6));

TEST(CrossCheck, names_the_camera_that_is_two_degrees_off_and_no_sensor) {
    std::size_t runs = 0;
    std::size_t named = 0;
    std::size_t with_sensors = 0;
    for (std::uint64_t draw = 0; draw < (seeds() == 0 ? 2U : 10U); ++draw) {
        const Place& place = places()[draw % std::min<std::size_t>(6, places().size())];
        KeptChoice choice = choice_of(place, draw);
        // Axes evenly over the sphere (Fibonacci's lattice).
        const double z = 1.0 - (2.0 * static_cast<double>(draw) + 1.0) / 10.0;
        const double angle = 1.3 + 2.399963 * static_cast<double>(draw);
        choice.camera_error.turn_deg = 2.0 * Eigen::Vector3d(std::sqrt(1.0 - z * z) * std::cos(angle),
                                                             std::sqrt(1.0 - z * z) * std::sin(angle), z);
        const std::string rig = rigs_of(place)[(draw + draw / 6) % 3];
        const KeptRun run = keep_runs({rig}, seeds() == 0 ? 2 : 1, choice).front();
        const Outcome outcome = outcome_of(run);
        print("off by 2 deg, " + std::string(place.world) + ", " + rig + ", draw " + std::to_string(draw),
              outcome);
        with_sensors += outcome.named.empty() ? 0U : 1U;
        named += outcome.camera_named_s ? 1U : 0U;
        ++runs;
    }
    // Of all ten at least nine; of the two of every day both.
    EXPECT_GE(named, runs < 10 ? runs : 9U);
    EXPECT_EQ(with_sensors, 0U);
}

// One sensor at a time of those of the experiment's ring that see most of what the camera sees.
TEST(CrossCheck, names_one_sensor_that_is_stuck_or_far_off) {
    const KeptRun run =
        keep_runs({"experiment.yaml"}, 2, {.revolutions = 3, .has_predictions = false}).front();
    const std::vector<SensorNumber> tried = {0, 1, 8, 16, 17, 26};
    const std::vector<std::tuple<const char*, std::size_t, std::function<double(double)>>> faults = {
        {"0.4 m too long", 4, [](double range_m) { return range_m + 0.4; }},
        {"0.4 m too short", 0, [](double range_m) { return std::max(0.05, range_m - 0.4); }},
        {"stuck at 0.25 m", 1, [](double) { return 0.25; }}};
    for (const auto& [what, at_least, altered] : faults) {
        std::size_t found = 0;
        for (const SensorNumber faulty : tried) {
            const Outcome outcome =
                outcome_of(run, [faulty, &change = altered](SensorNumber sensor, double range_m) {
                    return sensor == faulty ? change(range_m) : range_m;
                });
            for (const SensorNumber named : outcome.numbers) {
                EXPECT_EQ(named, faulty) << what;
                found += named == faulty ? 1U : 0U;
            }
            EXPECT_NE(outcome.at_the_end[faulty], CrossCheckFinding::agrees) << what << ", sensor " << faulty;
            EXPECT_FALSE(outcome.fault_named_s) << what << ", sensor " << faulty;
        }
        std::printf("%s: %zu of %zu found\n", what, found, tried.size());
        EXPECT_GE(found, at_least) << what;
    }
}

}  // namespace
}  // namespace octoskin
