// Single faults of single sensors on the experiment's arm: whom the camera finds out, how soon, and that it
// wrongs nobody. The figures are in docs/results.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <vector>

#include "host/core/witness/sensor_judge.hpp"
#include "tests/sim/witness/recorded_arm.hpp"

namespace octoskin {
namespace {

using testing_support::keep_runs;
using testing_support::KeptRange;
using testing_support::KeptReading;
using testing_support::KeptRun;
using testing_support::SensorNumber;

constexpr std::size_t kPerNode = 17;
constexpr std::size_t kSensors = 2 * kPerNode;
constexpr std::uint32_t kPixelDivisor = 2;
/// OCTOSKIN_WITNESS_LONG_SEEDS: so many seeds for three revolutions instead of one.
std::uint64_t long_seeds() {
    const char* text = std::getenv("OCTOSKIN_WITNESS_LONG_SEEDS");
    return text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
}

/// Who must be found: whose fault says twice as much as names it when its ranges have no noise, which may
/// take half.
constexpr double kTellingFrom = 2.0 * SensorJudge::kNamedFrom;

using Image = std::vector<KeptReading>;
/// What a sensor says with an image; empty: nothing.
using Says = std::function<std::optional<KeptRange>(const Image&, std::size_t image, SensorNumber)>;

std::optional<KeptRange> sound(const Image& image, std::size_t, SensorNumber sensor) {
    return image[sensor].sound;
}

SensorJudge judge_of_rig() {
    static constexpr std::size_t kNodes[] = {kPerNode, kPerNode};
    return SensorJudge(kNodes);
}

struct Outcome {
    std::vector<std::optional<double>> named_s = std::vector<std::optional<double>>(kSensors);
    std::vector<double> evidence_max = std::vector<double>(kSensors);
    std::uint64_t compared = 0;
};

Outcome outcome_of(const KeptRun& run, const Says& says) {
    SensorJudge judge = judge_of_rig();
    Outcome outcome;
    for (std::size_t number = 0; number < run.images.size(); ++number) {
        const Image& image = run.images[number];
        std::vector<Compared> compared;
        for (SensorNumber i = 0; i < kSensors; ++i) {
            const auto range = says(image, number, i);
            if (!range) continue;
            compared.push_back({static_cast<std::uint16_t>(i), image[i].beam, image[i].predictions});
            compared.back().beam.range_m = range->range_m;
        }
        judge.judge(compared);
        for (SensorNumber i = 0; i < kSensors; ++i) {
            const auto& verdict = judge.verdict(static_cast<std::uint16_t>(i));
            outcome.evidence_max[i] = std::max(outcome.evidence_max[i], verdict.evidence);
            if (verdict.fault && !outcome.named_s[i])
                outcome.named_s[i] = static_cast<double>(number) / run.images_hz;
        }
    }
    for (SensorNumber i = 0; i < kSensors; ++i)
        outcome.compared += judge.verdict(static_cast<std::uint16_t>(i)).compared;
    return outcome;
}

SensorNumber partner_of(SensorNumber sensor, std::size_t steps) {
    const SensorNumber node_begin = sensor / kPerNode * kPerNode;
    return node_begin + (sensor - node_begin + steps) % kPerNode;
}

/// A fault that one sensor has.
struct Fault {
    std::function<Says(SensorNumber faulty)> says;
    /// Who else says what is not true; the sensor itself: nobody.
    std::function<SensorNumber(SensorNumber faulty)> partner = [](SensorNumber faulty) { return faulty; };
};

Fault altered(double by_m) {
    return {.says = [by_m](SensorNumber faulty) -> Says {
        return [=](const Image& image, std::size_t number, SensorNumber sensor) {
            auto range = sound(image, number, sensor);
            if (range && sensor == faulty) range->range_m += by_m;
            return range;
        };
    }};
}

Fault turned(std::size_t turn) {
    return {.says = [turn](SensorNumber faulty) -> Says {
        return [=](const Image& image, std::size_t number, SensorNumber sensor) {
            return sensor == faulty ? image[sensor].turned[turn] : sound(image, number, sensor);
        };
    }};
}

Fault exchanged(std::size_t steps) {
    return {
        .says = [steps](SensorNumber faulty) -> Says {
            const SensorNumber partner = partner_of(faulty, steps);
            return [=](const Image& image, std::size_t number, SensorNumber sensor) {
                return sound(image, number, sensor == faulty ? partner : sensor == partner ? faulty : sensor);
            };
        },
        .partner = [steps](SensorNumber faulty) { return partner_of(faulty, steps); }};
}

Fault every_third_short() {
    return {.says = [](SensorNumber faulty) -> Says {
        return [=](const Image& image, std::size_t number, SensorNumber sensor) {
            auto range = sound(image, number, sensor);
            if (range && sensor == faulty && number % 3 == 0) {
                range->range_m *= 0.5;
                range->noise_m *= 0.5;
            }
            return range;
        };
    }};
}

/// The same, but the sensor's own ranges have no noise.
Says without_noise(const Says& says, SensorNumber faulty) {
    return [=](const Image& image, std::size_t number, SensorNumber sensor) {
        auto range = says(image, number, sensor);
        if (range && sensor == faulty) range->range_m -= range->noise_m;
        return range;
    };
}

struct Row {
    std::size_t telling = 0;  ///< sensors whose geometry tells
    std::size_t found = 0;    ///< of those
    std::size_t others = 0;   ///< of whose fault a little can be seen
    std::size_t others_found = 0;
    std::size_t wronged = 0;
    std::vector<double> after_s;
};

void inject(const KeptRun& run, const Fault& fault, Row& row) {
    for (SensorNumber faulty = 0; faulty < kSensors; ++faulty) {
        const Says says = fault.says(faulty);
        const double expected = outcome_of(run, without_noise(says, faulty)).evidence_max[faulty];
        const Outcome outcome = outcome_of(run, says);
        for (SensorNumber i = 0; i < kSensors; ++i)
            row.wronged += i != faulty && i != fault.partner(faulty) && outcome.named_s[i] ? 1U : 0U;
        const auto& named_s = outcome.named_s[faulty];
        if (expected < SensorJudge::kNamedFrom / 2.0) continue;
        const bool tells = expected >= kTellingFrom;
        (tells ? row.telling : row.others) += 1;
        (tells ? row.found : row.others_found) += named_s ? 1U : 0U;
        if (tells && named_s) row.after_s.push_back(*named_s);
        if (tells && !named_s)
            std::printf("  missed: sensor %zu, evidence of %.1f at the most\n", faulty,
                        outcome.evidence_max[faulty]);
    }
}

void print(const char* rig, const char* fault, Row& row) {
    std::ranges::sort(row.after_s);
    std::printf(
        "%s, %s: %zu of %zu that it should tell of, half of them within %.1f s; %zu of %zu others; %zu "
        "wronged\n",
        rig, fault, row.found, row.telling, row.after_s.empty() ? 0.0 : row.after_s[row.after_s.size() / 2],
        row.others_found, row.others, row.wronged);
}

TEST(WitnessFaults, are_found_in_thirty_seconds_where_the_geometry_tells_of_them) {
    const std::vector<std::string> rigs = {"experiment.yaml", "experiment_cone.yaml",
                                           "experiment_zones.yaml"};
    // Who must be found is asked of the judge itself: so many it finds, told to or not, lest it become a
    // worse one.
    const std::size_t found_min[] = {105, 31, 35};
    const auto runs = keep_runs(rigs, kPixelDivisor, {.seed = 0, .revolutions = 3, .has_turned = true});
    for (std::size_t rig = 0; rig < rigs.size(); ++rig) {
        std::vector<std::pair<const char*, std::vector<Fault>>> faults = {
            {"6 cm too long", {altered(0.06)}},
            {"6 cm too short", {altered(-0.06)}},
            {"every third range half as long", {every_third_short()}},
            {"turned by 10 degrees, 8 ways", {}},
            {"exchanged with the neighbour", {exchanged(1)}},
            {"exchanged with the other side", {exchanged(8)}}};
        for (std::size_t turn = 0; turn < kTurns; ++turn) faults[3].second.push_back(turned(turn));
        std::size_t found = 0;
        for (const auto& [name, all] : faults) {
            Row row;
            for (const Fault& fault : all) inject(runs[rig], fault, row);
            print(rigs[rig].c_str(), name, row);
            EXPECT_GE(static_cast<double>(row.found), 0.9 * static_cast<double>(row.telling))
                << rigs[rig] << ", " << name;
            EXPECT_EQ(row.wronged, 0U) << rigs[rig] << ", " << name;
            found += row.found + row.others_found;
        }
        EXPECT_GE(found, found_min[rig]) << rigs[rig];
    }
}

TEST(WitnessFaults, are_found_in_no_sound_sensor_over_sixteen_seeds) {
    const std::vector<std::string> rigs = {"experiment.yaml", "experiment_cone.yaml",
                                           "experiment_zones.yaml"};
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
        const auto runs =
            keep_runs(rigs, kPixelDivisor, {.seed = seed, .revolutions = seed < long_seeds() ? 3U : 1U});
        for (std::size_t rig = 0; rig < rigs.size(); ++rig) {
            const Outcome outcome = outcome_of(runs[rig], sound);
            std::printf("%s, seed %lu: %lu compared, evidence of %.1f at the most, %.0f us a prediction\n",
                        rigs[rig].c_str(), static_cast<unsigned long>(seed),
                        static_cast<unsigned long>(outcome.compared),
                        *std::ranges::max_element(outcome.evidence_max), runs[rig].predicted_us_mean);
            for (SensorNumber i = 0; i < kSensors; ++i)
                EXPECT_FALSE(outcome.named_s[i]) << rigs[rig] << ", seed " << seed << ", sensor " << i;
            EXPECT_GT(outcome.compared, 20U) << rigs[rig] << ", seed " << seed << ": nothing was compared";
        }
    }
}

}  // namespace
}  // namespace octoskin
