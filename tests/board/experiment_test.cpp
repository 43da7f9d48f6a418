// The flashed image on emulated boards against the same node core in this process: same rig, same world, same
// noise, and what comes out must be the same.
#include <gmock/gmock.h>

#include <map>

#include "common/wire/codec.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/experiment/experiment.hpp"

namespace octoskin::sim {
namespace {

using Source = std::pair<std::uint8_t, std::uint8_t>;  ///< node, sensor

/// What one run said on the bus, and what was true.
struct Heard {
    std::map<Source, std::vector<wire::RangeReading>> readings;
    std::map<Source, std::vector<TrueRanging>> truth;
    std::map<Source, std::int64_t> told_bound_us;  ///< the largest bound on capture times that was told
    std::map<std::uint8_t, SimTime> first_frame;   ///< of each node: when it began
    ExperimentSummary summary;
};

/// How far off a run's readings are from what was true.
struct Errors {
    std::size_t compared = 0;
    std::size_t unread = 0;  ///< not reported although a later one was
    std::vector<std::int64_t> capture_us;
    int range_mm_max = 0;
};

/// The error that this share of the capture times does not exceed.
std::int64_t share_within(const Errors& errors, double share) {
    std::vector<std::int64_t> sorted = errors.capture_us;
    std::ranges::sort(sorted);
    return sorted.at(static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1)));
}

class ExperimentTest : public testing::Test {
  protected:
    static constexpr std::size_t kReadingsAtRest = 45;  ///< 1.5 s of the 2
    static constexpr std::int64_t kWallAtStartUs = 1'750'000'000'000'000;

    ExperimentTest() {
        rig_.camera.reset();
        scenario_.rest_s = 2.0;
        scenario_.motion.ticks_per_revolution = 60;  // one revolution in 2 s
    }

    Heard run(const std::optional<EmulatedBoards>& emulated, const std::vector<BoardStart>& starts) {
        const ExperimentInput input{.rig = rig_,
                                    .capsules = capsules_,
                                    .world = world_,
                                    .arm = arm_,
                                    .scenario = scenario_,
                                    .seed = 7,
                                    .is_depth_noise_free = true,
                                    .emulated = emulated,
                                    .board_starts = starts};
        Heard heard;
        const ExperimentOutput output{
            .on_frame = [&](const wire::CanFrame& frame, WallTime stamp) { note(heard, frame, stamp); },
            .on_depth = {},
            .on_progress = {},
            .on_ranging =
                [&](const TrueRanging& ranging) {
                    heard.truth[{ranging.node_id, ranging.sensor}].push_back(ranging);
                }};
        const auto summary = run_experiment(input, output);
        EXPECT_TRUE(summary) << summary.error().what;
        if (summary) heard.summary = *summary;
        return heard;
    }

    void note(Heard& heard, const wire::CanFrame& frame, WallTime stamp) const {
        const auto decoded = wire::decode(frame);
        ASSERT_TRUE(decoded);
        const std::int64_t end_us = stamp.ns / 1000 - kWallAtStartUs;
        const wire::BitRates rates{rig_.bus.nominal_bitrate, rig_.bus.data_bitrate};
        heard.first_frame.try_emplace(decoded->node_id, SimTime{end_us - frame_duration_us(frame, rates)});
        if (const auto* health = std::get_if<wire::SensorHealth>(&decoded->message)) {
            std::int64_t& told = heard.told_bound_us[{decoded->node_id, health->sensor}];
            told = std::max<std::int64_t>(told, 64 * health->capture_bound_64us);
        }
        if (const auto* range = std::get_if<wire::RangeFd>(&decoded->message)) {
            for (std::uint8_t i = 0; i < range->count; ++i) {
                const wire::RangeReading& reading = range->entries.at(i).reading;
                heard.readings[{decoded->node_id, reading.sensor}].push_back(reading);
            }
        }
    }

    /// Each reading belongs to the true ranging whose middle is nearest, in the same order.
    Errors errors_of(const Heard& heard) const {
        Errors errors;
        for (const auto& [source, readings] : heard.readings) {
            const NodeClock clock = heard.summary.node_clocks.at(node_index(source.first));
            const auto& truth = heard.truth.at(source);
            std::size_t at = 0;
            for (std::size_t i = 0; i < readings.size(); ++i) {
                const std::size_t before = at;
                while (at + 1 < truth.size() &&
                       off_us(readings[i], clock, truth[at + 1]) < off_us(readings[i], clock, truth[at]))
                    ++at;
                if (i > 0) {
                    EXPECT_GT(at, before) << "two readings of one ranging";
                    errors.unread += at - before - 1;
                }
                const std::int64_t off = off_us(readings[i], clock, truth[at]);
                errors.capture_us.push_back(off);
                EXPECT_LE(off, heard.told_bound_us.at(source)) << "beyond the bound that the node told";
                if (is_valid_status(readings[i]) && truth[at].seen.range_m) {
                    const double mm = *truth[at].seen.range_m * 1000.0;
                    errors.range_mm_max =
                        std::max(errors.range_mm_max, static_cast<int>(std::abs(mm - readings[i].range_mm)));
                }
                ++errors.compared;
            }
        }
        return errors;
    }
    /// 19 is 9 behind a start. A sensor starts anew when its period is trimmed, one reading sooner or later.
    static std::uint8_t status_of(const wire::RangeReading& reading) {
        return reading.device_status == 19 ? std::uint8_t{9} : reading.device_status;
    }
    static bool is_valid_status(const wire::RangeReading& reading) {
        return reading.device_status == 9 || reading.device_status == 19;
    }
    [[nodiscard]] std::size_t node_index(std::uint8_t node_id) const {
        for (std::size_t i = 0; i < rig_.nodes.size(); ++i) {
            if (rig_.nodes[i].config.node_id == node_id) return i;
        }
        ADD_FAILURE() << "no node " << int{node_id};
        return 0;
    }
    static std::int64_t off_us(const wire::RangeReading& reading, const NodeClock& clock,
                               const TrueRanging& truth) {
        const std::int64_t span = reading.capture.span_us;
        const std::int64_t true_us = clock.to_node(truth.window_middle).us % span;
        const std::int64_t difference = (std::int64_t{reading.capture.value_us} - true_us + span) % span;
        return std::min(difference, span - difference);
    }

    rig::Rig rig_ = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml").value();
    Scenario scenario_ = read_scenario(OCTOSKIN_SOURCE_DIR "/hw/worlds/experiment.scenario.yaml").value();
    World world_ = World::read(scenario_.world).value();
    Arm arm_ = Arm::read(rig_.urdf, rig_.base_link, rig_.joints.joints).value();
    std::vector<rig::Capsule> capsules_ = rig::read_capsules(rig_.urdf, {}).value();
};

TEST_F(ExperimentTest, the_flashed_image_says_what_the_node_core_says) {
    const Heard flashed = run(EmulatedBoards{OCTOSKIN_BOARD_PROGRAM, OCTOSKIN_FLASHED_IMAGE}, {});
    EXPECT_EQ(flashed.summary.violations, "");
    ASSERT_EQ(flashed.readings.size(), 34U);

    // The core here starts when the image's does, on a clock that is 0 when the chip's counter is.
    std::vector<BoardStart> starts;
    for (std::size_t i = 0; i < rig_.nodes.size(); ++i) {
        starts.push_back(
            {flashed.summary.node_clocks.at(i), flashed.first_frame.at(rig_.nodes.at(i).config.node_id)});
    }
    const Heard core = run(std::nullopt, starts);
    ASSERT_EQ(core.readings.size(), 34U);

    // At rest what a sensor sees depends on the how-manieth ranging it is, and on nothing else: the homes may
    // start a sensor a period apart, and trim its period differently, as their buses take different time.
    std::size_t compared = 0;
    for (const auto& [source, readings] : core.readings) {
        SCOPED_TRACE(testing::Message() << "node " << int{source.first} << " sensor " << int{source.second});
        const auto& others = flashed.readings.at(source);
        EXPECT_NEAR(static_cast<double>(readings.size()), static_cast<double>(others.size()), 2.0);
        for (std::size_t i = 0; i < kReadingsAtRest; ++i) {
            SCOPED_TRACE(testing::Message() << "reading " << i);
            ASSERT_EQ(readings[i].zone, others[i].zone);
            ASSERT_EQ(readings[i].sequence, others[i].sequence);
            ASSERT_EQ(status_of(readings[i]), status_of(others[i]));
            ASSERT_NEAR(readings[i].range_mm, others[i].range_mm, 1);
            ++compared;
        }
    }
    EXPECT_EQ(compared, 34U * kReadingsAtRest);

    // Moving or not, each home tells what was true, and when: within the bound that it promises, as exactly
    // as the other. (Nearer than that the capture times of the homes themselves cannot be compared: each
    // trims its sensors' periods by its own measurements.)
    const Errors of_flashed = errors_of(flashed);
    const Errors of_core = errors_of(core);
    for (const Errors& errors : {of_flashed, of_core}) {
        EXPECT_GT(errors.compared, 34U * 100U);
        std::printf("%zu readings, capture times within %ld us, 95 %% within %ld us, half within %ld us\n",
                    errors.compared, static_cast<long>(share_within(errors, 1.0)),
                    static_cast<long>(share_within(errors, 0.95)),
                    static_cast<long>(share_within(errors, 0.5)));
        EXPECT_EQ(errors.range_mm_max, 0);
        EXPECT_EQ(errors.unread, 0U);
    }
    EXPECT_LE(share_within(of_flashed, 0.95), share_within(of_core, 0.95) + 100);
    EXPECT_LE(share_within(of_flashed, 0.5), share_within(of_core, 0.5) + 30);
}

}  // namespace
}  // namespace octoskin::sim
