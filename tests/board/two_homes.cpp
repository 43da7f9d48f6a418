#include "tests/board/two_homes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/wire/codec.hpp"

namespace octoskin::sim {
namespace {

struct SaidReading {
    wire::RangeReading reading;
    WallTime stamp{};
};
struct SaidBound {
    std::int64_t bound_us = 0;
    WallTime stamp{};
};

/// Of a wrapping capture time against the middle of a window.
std::int64_t error_us(const wire::RangeReading& reading, const NodeClock& clock, const TrueRanging& truth) {
    const std::int64_t span = reading.capture.span_us;
    const std::int64_t true_us = clock.to_node(truth.window_middle).us % span;
    const std::int64_t difference = (std::int64_t{reading.capture.value_us} - true_us + span) % span;
    return difference > span / 2 ? difference - span : difference;
}

/// A bound that was exceeded is told at once, and what a message tells is the largest since the one before.
std::int64_t bound_nearest(const std::vector<SaidBound>& said, WallTime stamp) {
    const auto distance = [stamp](const SaidBound& bound) { return std::abs(bound.stamp.ns - stamp.ns); };
    return std::ranges::min_element(said, {}, distance)->bound_us;
}

/// Each reading belongs to the ranging that is nearest, and a later one to a later ranging.
std::vector<JudgedReading> judge(const std::vector<SaidReading>& said, const std::vector<SaidBound>& bounds,
                                 const std::vector<TrueRanging>& truth, const NodeClock& clock) {
    std::vector<JudgedReading> judged;
    std::size_t at = 0;
    for (const auto& [reading, stamp] : said) {
        const auto off = [&](std::size_t i) { return std::abs(error_us(reading, clock, truth[i])); };
        while (at + 1 < truth.size() && off(at + 1) < off(at)) ++at;
        judged.push_back(
            {reading, truth[at], error_us(reading, clock, truth[at]), bound_nearest(bounds, stamp)});
    }
    return judged;
}

/// The first ranging belongs to the bring-up; between two runs there is one odd interval.
std::vector<EvenRun> even_runs(const std::vector<TrueRanging>& truth) {
    std::vector<EvenRun> runs;
    const auto interval = [&truth](std::size_t i) {
        return truth[i + 1].window_middle.us - truth[i].window_middle.us;
    };
    for (std::size_t i = 1; i + 2 < truth.size(); ++i) {
        const bool is_even = interval(i) == interval(i + 1);
        if (is_even && (runs.empty() || runs.back().period_us != interval(i)))
            runs.push_back({.first = truth[i].index, .period_us = interval(i)});
    }
    return runs;
}

}  // namespace

struct TwoHomes::Log {
    std::map<Source, std::vector<SaidReading>> readings;
    std::map<Source, std::vector<SaidBound>> bounds;
    std::map<Source, std::vector<TrueRanging>> truth;
};

TwoHomes::TwoHomes(SlowClockSpread slow_clocks)
    : rig_(rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml").value()),
      scenario_(read_scenario(OCTOSKIN_SOURCE_DIR "/hw/worlds/experiment.scenario.yaml").value()),
      world_(World::read(scenario_.world).value()),
      arm_(Arm::read(rig_.urdf, rig_.base_link, rig_.joint_names()).value()),
      body_(rig::read_capsules(rig_.urdf, {}).value()) {
    rig_.cameras.clear();
    scenario_.rest_s = 2.0;
    scenario_.motion.ticks_per_revolution = 60;
    scenario_.slow_clocks = slow_clocks;
}

Heard TwoHomes::run_flashed() const {
    return run(EmulatedBoards{OCTOSKIN_BOARD_PROGRAM, OCTOSKIN_FLASHED_IMAGE}, {});
}

Heard TwoHomes::run_core(const std::vector<BoardStart>& starts) const {
    return run(std::nullopt, starts);
}

Heard TwoHomes::run(const std::optional<EmulatedBoards>& emulated,
                    const std::vector<BoardStart>& starts) const {
    const ExperimentInput input{.rig = rig_,
                                .body = body_,
                                .world = world_,
                                .arm = arm_,
                                .scenario = scenario_,
                                .seed = 7,
                                .is_depth_noise_free = true,
                                .emulated = emulated,
                                .board_starts = starts};
    Log log;
    const ExperimentOutput output{
        .on_frame = [&](const wire::CanFrame& frame, WallTime stamp) { note(log, frame, stamp); },
        .on_depth = {},
        .on_progress = {},
        .on_ranging =
            [&](const TrueRanging& ranging) {
                log.truth[{ranging.node_id, ranging.sensor}].push_back(ranging);
            }};
    const auto summary = run_experiment(input, output);
    EXPECT_TRUE(summary) << summary.error().message();
    return summary ? judged(log, *summary) : Heard{};
}

void TwoHomes::note(Log& log, const wire::CanFrame& frame, WallTime stamp) const {
    const auto decoded = wire::decode(frame);
    ASSERT_TRUE(decoded);
    if (const auto* health = std::get_if<wire::SensorHealth>(&decoded->message)) {
        const std::int64_t bound_us = std::int64_t{wire::kClassicalTimeStepUs} * health->capture_bound_64us;
        if (bound_us > 0) log.bounds[{decoded->node_id, health->sensor}].push_back({bound_us, stamp});
    }
    if (const auto* range = std::get_if<wire::RangeFd>(&decoded->message)) {
        for (std::uint8_t i = 0; i < range->count; ++i) {
            const wire::RangeReading& reading = range->entries.at(i).reading;
            log.readings[{decoded->node_id, reading.sensor}].push_back({reading, stamp});
        }
    }
}

Heard TwoHomes::judged(const Log& log, const ExperimentSummary& summary) const {
    Heard heard{.readings = {}, .runs = {}, .summary = summary};
    for (const auto& [source, said] : log.readings) {
        const auto& truth = log.truth.at(source);
        heard.readings[source] = judge(said, log.bounds.at(source), truth, clock_of(source.first, summary));
        heard.runs[source] = even_runs(truth);
    }
    return heard;
}

const NodeClock& TwoHomes::clock_of(std::uint8_t node_id, const ExperimentSummary& summary) const {
    const auto node = std::ranges::find(rig_.nodes, node_id,
                                        [](const rig::Node& candidate) { return candidate.config.node_id; });
    return summary.board_starts.at(static_cast<std::size_t>(node - rig_.nodes.begin())).clock;
}

}  // namespace octoskin::sim
