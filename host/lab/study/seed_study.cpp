#include "host/lab/study/seed_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/reading.hpp"
#include "host/lab/study/judged_maps.hpp"
#include "host/lab/study/part_timer.hpp"
#include "host/lab/study/results_folder.hpp"

namespace octoskin {
namespace {

using Say = std::function<void(const std::string&)>;

/// Reports the progress of a long part at every quarter.
class Quarters {
  public:
    Quarters(const Say& say, std::string part) : say_(say), part_(std::move(part)) {}
    void reach(double fraction) {
        const int quarter = static_cast<int>(fraction * 4.0);
        if (quarter <= last_ || quarter >= 4) return;
        last_ = quarter;
        say_(fmt::format("{}: {} %", part_, quarter * 25));
    }

  private:
    const Say& say_;
    std::string part_;
    int last_ = 0;
};

Status<AppError> simulate(const SeedRequest& request, bool is_noise_free, const Say& say,
                          SeedOutcome& outcome) {
    SimulationRequest simulation = request.simulation;
    simulation.is_depth_noise_free = is_noise_free;
    simulation.out = is_noise_free ? request.scratch : request.recording;
    simulation.may_replace = true;
    const PartTimer timer("simulate");
    Quarters quarters(say, is_noise_free ? "simulating without depth noise" : "simulating");
    const auto summary = simulate_recording(simulation, [&](double fraction) { quarters.reach(fraction); });
    if (!summary) return unexpected(summary.error());
    if (request.keeps_recording && !is_noise_free) {
        const auto results = request.recording.parent_to_write();
        if (!results) return fail(ExitCode::cannot_create, to_error(results.error()));
        if (const auto noted = note_result(*results, request.recording.filename()); !noted) return noted;
    }
    outcome.times.push_back(timer.stop());
    say(
        fmt::format("simulated {:.1f} s: {} CAN frames, {} depth frames, first range after {:.2f} s, bus "
                    "{:.0f} % busy ({:.1f} s)",
                    summary->duration_s, summary->can_frames, summary->depth_frames, summary->first_range_s,
                    100.0 * summary->can_busy_fraction, outcome.times.back().wall_s));
    return Done{};
}

RecordingPaths recording_of(const SeedRequest& request, const NamedMapping& configuration) {
    return RecordingPaths(configuration.is_depth_noise_free ? request.scratch : request.recording);
}

/// The default region of `octoskin query --unknown`: a ball around the arm's reach.
PocketRegion region_about_arm(const rig::Rig& rig) {
    const Eigen::Vector3d base = rig.T_map_base.translation();
    return {.centre = base, .radius_m = 1.0, .z_min_m = base.z()};
}

/// Passes the maps to a meter, with the time of the last measurement in them.
class UnknownSpaceWatch final : public CommitListener {
  public:
    explicit UnknownSpaceWatch(const rig::Rig& rig)
        : has_camera_(!rig.cameras.empty()), meter_(region_about_arm(rig)) {}
    void on_joints(const JointMeasurement&) override {}
    void on_reading(const RangeMeasurement& measurement, const Beam&, std::span<const VoxelUpdate>) override {
        captured_ = measurement.captured;
    }
    void on_depth(const DepthFrame& frame, const Evidence&) override { captured_ = frame.captured; }
    void on_maps(std::span<const FedMap> maps) override {
        meter_.see(captured_, depth_of(maps), *find_map(maps, MapFeed::both));
    }

    [[nodiscard]] evaluation::UnknownSpace finish(std::span<const FedMap> maps) {
        return meter_.finish(depth_of(maps), *find_map(maps, MapFeed::both));
    }

  private:
    [[nodiscard]] const FusedMap* depth_of(std::span<const FedMap> maps) const {
        return has_camera_ ? find_map(maps, MapFeed::camera) : nullptr;
    }

    bool has_camera_;
    evaluation::UnknownSpaceMeter meter_;
    HostTime captured_;
};

Result<Playback, AppError> play(const SeedRequest& request, const NamedMapping& configuration, const Say& say,
                                CommitListener* listener, SeedOutcome& outcome) {
    const RecordingPaths recording = recording_of(request, configuration);
    const PartTimer timer("replay " + configuration.name);
    auto playback = play_recording({.recording = recording,
                                    .mapping = configuration.mapping,
                                    .configuration = configuration.name,
                                    .maps = every_feed(),
                                    .rig = {},
                                    .robot = {},
                                    .listener = listener});
    if (!playback) return playback;
    if (auto failure = failure_of(*playback)) return unexpected(std::move(*failure));
    outcome.times.push_back(timer.stop());
    say(fmt::format("replayed as '{}' ({:.1f} s)", configuration.name, outcome.times.back().wall_s));
    return playback;
}

void judge(const Playback& playback, const NamedMapping& configuration, const evaluation::Truth& truth,
           SeedOutcome& outcome) {
    const PartTimer timer("evaluate");
    std::ranges::move(judge_maps(playback, configuration, outcome.seed, truth),
                      std::back_inserter(outcome.runs));
    outcome.times.push_back(timer.stop());
}

Result<evaluation::Truth, AppError> make_truth(const StudyGround& ground, const rig::Rig& rig,
                                               SeedOutcome& outcome) {
    const PartTimer timer("ground truth");
    evaluation::TruthConfig config = ground.truth;
    config.external_cameras = rig.external_cameras();
    if (auto fault = evaluation::region_fault(config.region, config.resolution_m, rig.T_map_base))
        return fail(ExitCode::bad_config, ground.scenario.error("region", std::move(*fault)));
    auto truth = evaluation::build_truth(ground.world, ground.survey, config, rig.T_map_base);
    if (!truth) return fail(ExitCode::bad_config, ground.scenario.error("region", std::move(truth.error())));
    outcome.times.push_back(timer.stop());
    return std::move(*truth);
}

/// Leftovers are removed with the work folder.
void remove(const FilePlace& folder) {
    if (const auto parent = folder.parent_to_write())
        static_cast<void>(parent->remove_all(folder.filename()));
}

}  // namespace

Result<SeedOutcome, AppError> study_seed(const SeedRequest& request, const StudyGround& ground,
                                         const Say& say) {
    SeedOutcome outcome{.seed = request.simulation.seed,
                        .runs = {},
                        .times = {},
                        .main = {},
                        .truth = {},
                        .unknown_space = {}};
    for (const bool is_noise_free : {false, true}) {
        const auto& all = request.configurations;
        const auto matches = [&](const NamedMapping& c) { return c.is_depth_noise_free == is_noise_free; };
        if (std::none_of(all.begin(), all.end(), matches)) continue;
        if (const auto simulated = simulate(request, is_noise_free, say, outcome); !simulated) {
            return unexpected(simulated.error());
        }
        for (const NamedMapping& configuration : all) {
            if (!matches(configuration)) continue;
            const bool is_main = request.keeps_maps && configuration.name == request.main_configuration;
            std::optional<UnknownSpaceWatch> watch;
            if (is_main) {
                const auto lock = lock_reading();
                const auto rig = read_given_rig(recording_of(request, configuration).rig());
                if (!rig) return unexpected(rig.error());
                watch.emplace(*rig);
            }
            auto playback = play(request, configuration, say, watch ? &*watch : nullptr, outcome);
            if (!playback) return unexpected(playback.error());
            if (!outcome.truth) {
                auto truth = make_truth(ground, playback->rig, outcome);
                if (!truth) return unexpected(truth.error());
                outcome.truth = std::move(*truth);
            }
            judge(*playback, configuration, *outcome.truth, outcome);
            if (is_main) {
                playback->pipeline.set_listener(nullptr);
                outcome.unknown_space = watch->finish(playback->pipeline.maps());
                outcome.main.emplace(std::move(*playback));
            }
        }
    }
    remove(request.scratch);
    if (!request.keeps_recording) remove(request.recording);
    return outcome;
}

}  // namespace octoskin
