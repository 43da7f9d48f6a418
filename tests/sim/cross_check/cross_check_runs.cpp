#include "tests/sim/cross_check/cross_check_runs.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace octoskin::testing_support {
namespace {

const std::string kData = "tests/data/cross_check/";

}  // namespace

const std::vector<Place>& places() {
    static const std::vector<Place> kJudged = {
        {"judged_1", "judged_1", "experiment", {1.8, 1.4, 1.5}, {0.5, 0.0, 0.4}},
        {"judged_2", "judged_2", "experiment", {1.9, -1.3, 1.7}, {0.5, 0.0, 0.4}},
        {"judged_3", "judged_3", "experiment", {2.2, 0.5, 1.6}, {0.5, 0.0, 0.3}},
        {"judged_4", "judged_4", "experiment", {1.6, -1.8, 1.3}, {0.5, 0.0, 0.4}},
        {"judged_5", "judged_5", "experiment", {2.1, -0.4, 1.9}, {0.6, 0.0, 0.2}},
        {"judged_6", "judged_6", "experiment", {1.5, 1.8, 1.6}, {0.5, 0.0, 0.5}},
    };
    static const std::vector<Place> kTuning = {
        {"unseen_1", "unseen_1", "experiment", {1.8, 1.4, 1.5}, {0.5, 0.0, 0.4}},
        {"unseen_2", "unseen_2", "experiment", {1.9, -1.3, 1.7}, {0.5, 0.0, 0.4}},
        {"unseen_3", "unseen_3", "experiment", {2.2, 0.5, 1.6}, {0.5, 0.0, 0.3}},
        {"unseen_4", "unseen_4", "experiment", {1.6, -1.8, 1.3}, {0.5, 0.0, 0.4}},
        {"unseen_5", "unseen_5", "experiment", {2.1, -0.4, 1.9}, {0.6, 0.0, 0.2}},
        {"unseen_6", "unseen_6", "experiment", {1.5, 1.8, 1.6}, {0.5, 0.0, 0.5}},
        {"drawn_1", "drawn_1", "experiment", {1.8, 1.4, 1.5}, {0.5, 0.0, 0.4}},
        {"drawn_2", "drawn_2", "experiment", {1.9, -1.3, 1.7}, {0.5, 0.0, 0.4}},
        {"drawn_3", "drawn_3", "experiment", {2.2, 0.5, 1.6}, {0.5, 0.0, 0.3}},
        {"drawn_4", "drawn_4", "experiment", {1.6, -1.8, 1.3}, {0.5, 0.0, 0.4}},
        {"drawn_5", "drawn_5", "experiment", {2.1, -0.4, 1.9}, {0.6, 0.0, 0.2}},
        {"drawn_6", "drawn_6", "experiment", {1.5, 1.8, 1.6}, {0.5, 0.0, 0.5}},
        {"rods", "rods", "experiment", {1.6, 1.9, 1.5}, {0.5, 0.0, 0.4}},
        {"posts", "posts", "experiment", {1.9, -1.6, 1.3}, {0.5, 0.0, 0.4}},
        {"sheets", "sheets", "cell", {2.1, -1.2, 1.6}, {0.5, 0.0, 0.4}},
        {"bins", "bins", "experiment", {2.3, 0.4, 1.9}, {0.6, 0.0, 0.2}},
        {"frame", "frame", "cell", {2.0, -1.4, 1.4}, {0.5, 0.0, 0.4}},
        {"workplace", "workplace", "cupboard", {1.7, 1.7, 1.7}, {0.5, 0.0, 0.5}},
        {"fence", "fence", "experiment", {1.8, 1.5, 1.6}, {0.5, 0.0, 0.4}},
        {"rack", "rack", "experiment", {1.7, -1.8, 1.5}, {0.5, 0.0, 0.4}},
        {"trestle", "trestle", "experiment", {2.1, -0.9, 1.7}, {0.5, 0.0, 0.3}},
        {"tuning_thin", "tuning_thin", "experiment", {1.7, 1.7, 1.5}, {0.5, 0.0, 0.4}},
        {"tuning_mixed", "tuning_mixed", "experiment", {1.9, -1.5, 1.7}, {0.5, 0.0, 0.4}},
    };
    const char* const chosen = std::getenv("OCTOSKIN_CROSS_CHECK_WORLDS");
    return chosen != nullptr && std::string(chosen) == "tuning" ? kTuning : kJudged;
}

std::uint64_t seeds() {
    const char* const text = std::getenv("OCTOSKIN_CROSS_CHECK_SEEDS");
    return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
}

std::vector<std::string> rigs_of(const Place& place) {
    const std::string rig = place.rig;
    return {rig + ".yaml", rig + "_cone.yaml", rig + "_zones.yaml"};
}

KeptChoice choice_of(const Place& place, std::uint64_t seed) {
    return {.seed = seed,
            .revolutions = 3,
            .has_predictions = false,
            .scenario = kData + place.scenario + ".scenario.yaml",
            .camera_at_m = std::array{place.camera_at_m, place.camera_looks_at_m}};
}

namespace {

void add(const PoseJudge& pose, double at_s, Outcome& outcome) {
    outcome.camera_evidence_max = std::max(outcome.camera_evidence_max, pose.camera().evidence().evidence);
    outcome.joint_evidence_max = std::max(outcome.joint_evidence_max, pose.joints().evidence().evidence);
    const auto& fault = pose.fault();
    outcome.fault_at_the_end = fault;
    if (!fault) return;
    if (!outcome.fault_named_s) outcome.fault_named_s = at_s;
    if (fault->joint) outcome.joints.insert(fault->joint->joint);
    if (fault->joint && fault->camera) return;
    auto& named_s = fault->camera ? outcome.camera_named_s : outcome.joint_named_s;
    if (!named_s) named_s = at_s;
}

std::string text_of(const Outcome& outcome) {
    static const std::vector<std::string> kJoints = {"1", "2", "3", "4", "5", "6", "7"};
    const auto seconds = [](const std::optional<double>& at_s) {
        return at_s ? std::to_string(*at_s).substr(0, 4) : std::string("never");
    };
    std::string text = "something off at " + seconds(outcome.fault_named_s) + ", camera alone at " +
                       seconds(outcome.camera_named_s) + " (" + std::to_string(outcome.camera_evidence_max) +
                       "), joint alone at " + seconds(outcome.joint_named_s) + " (" +
                       std::to_string(outcome.joint_evidence_max) + ")";
    if (outcome.fault_at_the_end) text += ", at the end " + describe(*outcome.fault_at_the_end, kJoints);
    return text;
}

}  // namespace

Outcome outcome_of(const KeptRun& run, const Altered& altered) {
    CrossCheck cross_check(run.rig, {});
    Outcome outcome;
    std::vector<bool> is_named(run.sources.size());
    for (std::size_t image = 0; image < run.images.size(); ++image) {
        const auto captured =
            HostTime{static_cast<std::int64_t>(1e9 * static_cast<double>(image) / run.images_hz)};
        for (SensorNumber i = 0; i < run.sources.size(); ++i) {
            const KeptReading& reading = run.images[image][i];
            if (!reading.sound) continue;
            Beam beam = reading.beam;
            beam.range_m = altered ? altered(i, reading.sound->range_m) : reading.sound->range_m;
            cross_check.on_beam(beam, reading.T_map_sensor, reading.twists_map);
        }
        SeenImages seen = run.camera->images[image];
        cross_check.on_depth(seen, run.camera->T_map_camera, captured);
        cross_check.settle();
        const double at_s = static_cast<double>(image) / run.images_hz;
        add(cross_check.pose(), at_s, outcome);
        for (SensorNumber i = 0; i < run.sources.size(); ++i) {
            const SensorEvidence& evidence =
                cross_check.evidence(run.sources[i].node_id, run.sources[i].sensor);
            outcome.evidence_max = std::max(outcome.evidence_max, evidence.evidence);
            if (!evidence.contradicts() || is_named[i]) continue;
            is_named[i] = true;
            outcome.numbers.push_back(i);
            outcome.named.push_back(std::to_string(i) + " at " + std::to_string(at_s) +
                                    " s: " + describe(evidence));
        }
    }
    for (const BeamSource& source : run.sources) {
        const SensorEvidence& evidence = cross_check.evidence(source.node_id, source.sensor);
        outcome.compared += evidence.compared;
        outcome.at_the_end.push_back(evidence.verdict());
    }
    outcome.cannot_tell =
        static_cast<std::size_t>(std::ranges::count(outcome.at_the_end, CrossCheckFinding::cannot_tell));
    return outcome;
}

void print(const std::string& what, const Outcome& outcome) {
    std::printf("%s: %zu named, %zu cannot tell, %lu compared, evidence %.1f; %s\n", what.c_str(),
                outcome.named.size(), outcome.cannot_tell, static_cast<unsigned long>(outcome.compared),
                outcome.evidence_max, text_of(outcome).c_str());
    for (const std::string& named : outcome.named) std::printf("  %s\n", named.c_str());
    std::fflush(stdout);
}

}  // namespace octoskin::testing_support
