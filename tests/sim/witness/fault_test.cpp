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

/// Who may be expected to be found: the noise may take half of what a fault says of itself.
constexpr double kTellingFrom = 2.0 * SensorJudge::kNamedFrom;

using Image = std::vector<KeptReading>;
/// What a sensor says with an image; empty: nothing.
using Says = std::function<std::optional<double>(const Image&, std::size_t image, SensorNumber)>;

std::vector<Compared> compared_with(const Image& image, std::size_t number, const Says& says) {
    std::vector<Compared> compared;
    for (SensorNumber i = 0; i < kSensors; ++i) {
        const auto range_m = says(image, number, i);
        if (!range_m) continue;
        compared.push_back({static_cast<std::uint16_t>(i), image[i].beam, image[i].predictions});
        compared.back().beam.range_m = range_m;
    }
    return compared;
}

std::optional<double> sound(const Image& image, std::size_t, SensorNumber sensor) {
    return image[sensor].beam.range_m;
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

/// `before`, if any, is asked with each image before it is judged.
Outcome outcome_of(const KeptRun& run, const Says& says,
                   const std::function<void(const SensorJudge&, const std::vector<Compared>&)>& before = {},
                   const std::function<void(const SensorJudge&)>& after = {}) {
    SensorJudge judge = judge_of_rig();
    Outcome outcome;
    for (std::size_t number = 0; number < run.images.size(); ++number) {
        const auto compared = compared_with(run.images[number], number, says);
        if (before) before(judge, compared);
        judge.judge(compared);
        if (after) after(judge);
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

/// A fault that one sensor has, and the evidence for it that its geometry gives without noise.
struct Fault {
    const char* name;
    std::function<Says(SensorNumber faulty)> says;
    std::function<double(const SensorJudge&, const std::vector<Compared>&, const Compared& of)> gain;
    /// Who else says what is not true; the sensor itself: nobody.
    std::function<SensorNumber(SensorNumber faulty)> partner = [](SensorNumber faulty) { return faulty; };
};

Fault altered(const char* name, double by_m) {
    return {.name = name,
            .says = [by_m](SensorNumber faulty) -> Says {
                return [=](const Image& image, std::size_t number, SensorNumber sensor) {
                    auto range_m = sound(image, number, sensor);
                    if (range_m && sensor == faulty) *range_m += by_m;
                    return range_m;
                };
            },
            .gain = [by_m](const SensorJudge& judge, const auto&,
                           const Compared& of) { return judge.gain_if_off(of, by_m); }};
}

Fault turned(std::size_t turn) {
    return {.name = "turned",
            .says = [turn](SensorNumber faulty) -> Says {
                return [=](const Image& image, std::size_t number, SensorNumber sensor) {
                    return sensor == faulty ? image[sensor].turned_m[turn] : sound(image, number, sensor);
                };
            },
            .gain = [turn](const SensorJudge& judge, const auto&,
                           const Compared& of) { return judge.gain_if_turned(of, turn); }};
}

Fault exchanged(const char* name, std::size_t steps) {
    return {
        .name = name,
        .says = [steps](SensorNumber faulty) -> Says {
            const SensorNumber partner = partner_of(faulty, steps);
            return [=](const Image& image, std::size_t number, SensorNumber sensor) {
                return sound(image, number, sensor == faulty ? partner : sensor == partner ? faulty : sensor);
            };
        },
        .gain =
            [steps](const SensorJudge& judge, const std::vector<Compared>& all, const Compared& of) {
                const auto other = std::ranges::find(all, partner_of(of.sensor, steps), &Compared::sensor);
                return other == all.end() ? 0.0 : judge.gain_if_exchanged(of, *other);
            },
        .partner = [steps](SensorNumber faulty) { return partner_of(faulty, steps); }};
}

Fault every_third_short() {
    return {.name = "every third range half as long",
            .says = [](SensorNumber faulty) -> Says {
                return [=](const Image& image, std::size_t number, SensorNumber sensor) {
                    auto range_m = sound(image, number, sensor);
                    if (range_m && sensor == faulty && number % 3 == 0) *range_m *= 0.5;
                    return range_m;
                };
            },
            .gain = {}};
}

/// Of every sensor, what the fault adds to the evidence over a run if there is no noise.
std::vector<double> expected_evidence(const KeptRun& run, const Fault& fault) {
    std::vector<double> expected(kSensors);
    if (fault.gain) {
        std::size_t number = 0;
        outcome_of(run, sound, [&](const SensorJudge& judge, const std::vector<Compared>& compared) {
            const Image& image = run.images[number];
            for (Compared of : compared) {
                of.beam.range_m = fault.says(of.sensor)(image, number, of.sensor);
                if (of.beam.range_m) expected[of.sensor] += fault.gain(judge, compared, of);
            }
            ++number;
        });
        return expected;
    }
    // One short range between two that agree, for each three images in a row that can be compared.
    std::vector<std::uint64_t> agreed(kSensors);
    std::vector<int> in_a_row(kSensors);
    outcome_of(run, sound, {}, [&](const SensorJudge& judge) {
        for (SensorNumber i = 0; i < kSensors; ++i) {
            const auto now = judge.verdict(static_cast<std::uint16_t>(i)).agreed;
            in_a_row[i] = now > agreed[i] ? in_a_row[i] + 1 : 0;
            agreed[i] = now;
            if (in_a_row[i] >= 3) expected[i] += (2.8 - 0.15 - 0.55) / 3.0;
        }
    });
    return expected;
}

struct Row {
    std::size_t telling = 0;       ///< sensors whose geometry tells
    std::size_t found = 0;         ///< of those
    std::size_t others_found = 0;  ///< of the sensors that see anything that can be compared
    std::size_t others = 0;
    std::size_t wronged = 0;
    std::vector<double> after_s;
};

void inject(const KeptRun& run, const Fault& fault, Row& row) {
    const std::vector<double> expected = expected_evidence(run, fault);
    for (SensorNumber faulty = 0; faulty < kSensors; ++faulty) {
        if (!(expected[faulty] > 0.0)) continue;
        const Outcome outcome = outcome_of(run, fault.says(faulty));
        const bool tells = expected[faulty] >= kTellingFrom;
        const auto& named_s = outcome.named_s[faulty];
        (tells ? row.telling : row.others) += 1;
        (tells ? row.found : row.others_found) += named_s ? 1U : 0U;
        if (tells && !named_s)
            std::printf("  missed: sensor %zu, expected %.0f, reached %.1f\n", faulty, expected[faulty],
                        outcome.evidence_max[faulty]);
        if (tells && named_s) row.after_s.push_back(*named_s);
        for (SensorNumber i = 0; i < kSensors; ++i)
            row.wronged += i != faulty && i != fault.partner(faulty) && outcome.named_s[i] ? 1U : 0U;
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
    const std::vector<std::string> rigs = {"experiment.yaml", "experiment_cone.yaml"};
    const auto runs = keep_runs(rigs, kPixelDivisor, {.seed = 0, .revolutions = 3, .has_turned = true});
    for (std::size_t rig = 0; rig < rigs.size(); ++rig) {
        std::vector<std::pair<const char*, std::vector<Fault>>> faults = {
            {"6 cm too long", {altered("", 0.06)}},
            {"6 cm too short", {altered("", -0.06)}},
            {"every third range half as long", {every_third_short()}},
            {"turned by 10 degrees, 8 ways", {}},
            {"exchanged with the neighbour", {exchanged("", 1)}},
            {"exchanged with the other side", {exchanged("", 8)}}};
        for (std::size_t turn = 0; turn < kTurns; ++turn) faults[3].second.push_back(turned(turn));
        for (const auto& [name, all] : faults) {
            Row row;
            for (const Fault& fault : all) inject(runs[rig], fault, row);
            print(rigs[rig].c_str(), name, row);
            // What a cone sees changes by little more than its noise when it turns.
            const bool is_turned_cone = rig == 1 && all.size() == kTurns;
            EXPECT_GE(static_cast<double>(row.found),
                      (is_turned_cone ? 0.7 : 0.9) * static_cast<double>(row.telling))
                << rigs[rig] << ", " << name;
            EXPECT_GT(row.telling, 0U) << rigs[rig] << ", " << name << ": nothing was tried";
            EXPECT_EQ(row.wronged, 0U) << rigs[rig] << ", " << name;
        }
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
