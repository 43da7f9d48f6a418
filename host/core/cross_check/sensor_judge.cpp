#include "host/core/cross_check/sensor_judge.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace octoskin {
namespace {

/// Tolerated errors of camera, robot and rig.
constexpr double kToleranceM = 0.02;
constexpr double kPoseSigmaM = 0.01;
/// Upper limit of a comparison's evidence: one range in fifty comes from an unmodelled cause.
constexpr double kMisfitMax = 4.0;
/// The offset that is tested.
constexpr double kOffsetM = 0.06;
/// Where the camera does not see the space before a surface, a range shorter by this comes from another
/// object,
constexpr double kSomethingElseM = 0.12;
/// and a slightly shorter one may.
constexpr double kMisfitOfHiddenMax = 1.2;
/// A range that ends within this margin of unseen space may end in that space: the image is from another
/// instant, and the camera slightly misplaced.
constexpr double kHiddenMarginM = 0.1;
/// Walls are thinner than this, plus this much noise.
constexpr double kWallM = 0.1;
constexpr double kWallNoiseM = 0.06;
/// A ray nearly parallel to a surface says little about its thickness.
constexpr double kAlongMin = 0.3;
/// A short range is shorter than the surface's by this plus 3 sigma. Evidence: log(1/3 / 1/50), otherwise
/// log(2/3).
constexpr double kShortM = 0.12;
constexpr double kShortRatio = 2.8;
constexpr double kNotShortRatio = -0.4;

/// No fault except `often_short` is reported while the newest dozen ranges fit the rig this well.
constexpr double kMisfitShare = 1.0 / 12.0;
constexpr double kMisfitOfSoundMax = 0.35;
/// Of two exchanged sensors, both fit the other: no exchange if the other contradicts it by this evidence.
constexpr double kDeniedFrom = -6.0;
/// Evidence over a shorter time may come from one view of one object; the camera's error needs as long to
/// show.
constexpr Nanoseconds kEvidenceTime{3'000'000'000};
/// A sensor is reported only if the camera misplaces the place of its contradictions by less than this.
/// Contradictions of exchanged sensors are larger than those of a misplaced camera.
constexpr double kMisplacedM = 0.1;
constexpr double kMisplacedOfExchangedM = 0.25;
/// At most this many other sensors may contradict the camera: of two exchanged sensors, both do.
constexpr std::size_t kOthersMax = 1;

/// Indices in Sensor::faults; turns follow.
constexpr std::size_t kTooLong = 0;
constexpr std::size_t kTooShort = 1;
constexpr std::size_t kOftenShort = 2;
constexpr std::size_t kTurned = 3;

RangeFault fault_at(std::size_t place) {
    switch (place) {
        case kTooLong:
            return RangeFault::ranges_too_long;
        case kTooShort:
            return RangeFault::ranges_too_short;
        case kOftenShort:
            return RangeFault::often_short;
        default:
            return RangeFault::turned;
    }
}

}  // namespace

SensorJudge::SensorJudge(std::span<const std::size_t> sensors_of_nodes, std::size_t joints)
    : pose_(std::accumulate(sensors_of_nodes.begin(), sensors_of_nodes.end(), std::size_t{0}), joints) {
    for (const std::size_t count : sensors_of_nodes) {
        const std::size_t begin = sensors_.size();
        for (std::size_t i = 0; i < count; ++i) {
            sensors_.emplace_back();
            sensors_.back().node_begin = begin;
            sensors_.back().exchanged.resize(count);
        }
    }
}

SensorJudge::Expected SensorJudge::expected(const Compared& compared,
                                            const RangePrediction& prediction) const {
    Expected expected{
        .at = prediction, .has_lower_bound = !prediction.is_from_behind, .sigma_m = prediction.sigma_m};
    if (!prediction.range_m || !prediction.is_from_behind || !prediction.surface) return expected;
    const auto known = thickness_.known_to_others(compared.sensor, prediction.surface->p_map);
    if (!known) return expected;
    // For a turned mount, the ray's direction is only approximate.
    const double along =
        std::max(kAlongMin, std::abs(prediction.surface->normal_map.dot(compared.beam.direction_map)));
    *expected.at.range_m -= known->thickness_m / along;
    expected.sigma_m = std::hypot(expected.sigma_m, known->sigma_m / along);
    expected.has_lower_bound = true;
    return expected;
}

/// Negative logarithm of a range's likelihood, except for a constant; empty: no evidence.
std::optional<double> SensorJudge::misfit(const Expected& expected, double range_m, double sigma_m) {
    const RangePrediction& at = expected.at;
    double off_m = 0.0;
    double misfit_max = kMisfitMax;
    if (!at.range_m) {
        // Only the extent of the free space is known.
        off_m = std::min(range_m - at.hidden_until_m, at.clear_m - range_m);
        if (!(off_m > kToleranceM + 3.0 * sigma_m)) return std::nullopt;
    } else if (range_m >= *at.range_m) {
        off_m = range_m - *at.range_m;
    } else {
        off_m = *at.range_m - range_m;
        if (at.is_from_behind) {
            if (!expected.has_lower_bound) return 0.0;
            if (off_m > kSomethingElseM) return std::nullopt;
            misfit_max = kMisfitOfHiddenMax;
        } else if (range_m < at.hidden_until_m + kHiddenMarginM) {
            return std::nullopt;
        }
    }
    const double sigmas = std::max(0.0, off_m - kToleranceM) / sigma_m;
    return std::min(0.5 * sigmas * sigmas, misfit_max);
}

double SensorJudge::sigma_of(const Compared& compared, const Expected& a, const Expected& b) {
    return std::hypot(std::max(a.sigma_m, b.sigma_m), compared.beam.sigma_m, kPoseSigmaM);
}

void SensorJudge::judge(std::span<const Compared> compared) {
    std::vector<Expected> mounted;
    mounted.reserve(compared.size());
    looks_.assign(sensors_.size(), Look{});
    for (const Compared& one : compared) {
        assert(one.sensor < sensors_.size() && one.beam.range_m);
        mounted.push_back(expected(one, one.predictions.mounted));
    }
    for (std::size_t i = 0; i < compared.size(); ++i) {
        weigh(compared[i], mounted[i]);
        for (std::size_t j = 0; j < compared.size(); ++j) {
            if (i != j && compared[i].beam.source.node_id == compared[j].beam.source.node_id &&
                compared[i].beam.source.zone == compared[j].beam.source.zone)
                weigh_exchange(compared[i], mounted[i], compared[j], mounted[j]);
        }
    }
    for (const Compared& one : compared) ask_pose(one);
    if (!compared.empty()) pose_.decide(compared.back().beam.captured);
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        decide(static_cast<std::uint16_t>(i));
        sensors_[i].looks = {looks_[i], sensors_[i].looks[0]};
    }
    for (const Compared& one : compared) remember(one);
}

void SensorJudge::ask_pose(const Compared& compared) {
    const RangePrediction& at = compared.predictions.mounted;
    const double range_m = *compared.beam.range_m;
    if (!at.range_m || (!at.is_from_behind && range_m < at.hidden_until_m)) return;
    const auto change = range_change({.off_m = range_m - *at.range_m,
                                      .sigma_m = std::hypot(compared.beam.sigma_m, at.sigma_m),
                                      .is_from_behind = at.is_from_behind},
                                     compared.predictions.hits);
    if (change) pose_.compare(compared.sensor, *change, compared.twists_camera);
}

bool SensorJudge::contradicts(const Sensor& sensor) const {
    return sensor.verdict.fault || sensor.is_far_off || sensor.verdict.evidence >= kContradictsFrom;
}

/// For use while one of the two is reported or likely.
SensorDoubt SensorJudge::doubt_of_pose() const {
    const bool is_camera = pose_.fault() ? !pose_.fault()->joint : pose_.camera().is_suspect();
    return is_camera ? SensorDoubt::camera_is_off : SensorDoubt::joint_is_off;
}

std::optional<SensorDoubt> SensorJudge::against_naming(std::uint16_t number, const Eigen::Vector3d& p_camera,
                                                       double misplaced_max_m) const {
    if (pose_.fault() || pose_.is_suspect()) return doubt_of_pose();
    if (pose_.camera().may_misplace_m(number, p_camera) > misplaced_max_m)
        return SensorDoubt::camera_not_known;
    // Counted again, because another test may have found one since the newest image was evaluated.
    const auto contradicting =
        std::ranges::count_if(sensors_, [this](const Sensor& sensor) { return contradicts(sensor); });
    const auto others = static_cast<std::size_t>(contradicting) - (contradicts(sensors_[number]) ? 1U : 0U);
    if (others > kOthersMax) return SensorDoubt::several_contradict;
    return std::nullopt;
}

/// A range from behind that ends before the surface may end on an object that the camera does not see: weak
/// evidence.
template <typename Misfit>
void SensorJudge::weigh_fault(FaultSum& sum, const Compared& compared, const Expected& mounted,
                              double sigma_m, const Misfit& misfit_with_fault) {
    const double range_m = *compared.beam.range_m;
    const auto sound = misfit(mounted, range_m, sigma_m);
    const auto faulty = misfit_with_fault(range_m);
    if (!sound || !faulty) return;
    const double ratio = *sound - *faulty;
    const double expected = misfit_with_fault(*mounted.at.range_m).value_or(0.0);
    if (mounted.at.is_from_behind && range_m < *mounted.at.range_m) {
        sum.add_weak(ratio, expected, compared.beam);
    } else {
        sum.add(ratio, expected, compared.beam.captured);
    }
}

void SensorJudge::weigh(const Compared& compared, const Expected& mounted) {
    Sensor& sensor = sensors_[compared.sensor];
    const double range_m = *compared.beam.range_m;
    const double sigma_m = sigma_of(compared, mounted, mounted);
    const auto sound = misfit(mounted, range_m, sigma_m);
    sensor.now = compared.beam.captured;
    weigh_short(sensor, compared, mounted, sound.value_or(kMisfitMax));
    if (!sound) return;
    if (!mounted.at.range_m) return;
    if (!compared.predictions.hits.empty()) sensor.p_camera = compared.predictions.hits.front().p;
    if (mounted.has_lower_bound || *sound > 0.0) {
        sensor.misfit_mean += kMisfitShare * (*sound - sensor.misfit_mean);
        ++sensor.verdict.compared;
        sensor.verdict.agreed += *sound <= kMisfitOfHiddenMax ? 1U : 0U;
    }
    for (const auto& [place, off_m] : {std::pair{kTooLong, kOffsetM}, std::pair{kTooShort, -kOffsetM}})
        weigh_fault(sensor.faults[place], compared, mounted, sigma_m,
                    [&, by_m = off_m](double at_m) { return misfit(mounted, at_m - by_m, sigma_m); });
    for (std::size_t i = 0; i < kTurns; ++i) {
        if (!compared.predictions.turned[i].range_m) continue;
        const Expected turned = expected(compared, compared.predictions.turned[i]);
        const double sigma_both_m = sigma_of(compared, mounted, turned);
        weigh_fault(sensor.faults[kTurned + i], compared, mounted, sigma_both_m,
                    [&](double at_m) { return misfit(turned, at_m, sigma_both_m); });
    }
}

/// In space that the camera sees as free, one short range is sufficient. Elsewhere an object may be present,
/// but not between two images in which the same zone of the sensor saw the surface behind it. Another zone
/// looks past such an object.
void SensorJudge::weigh_short(Sensor& sensor, const Compared& compared, const Expected& mounted,
                              double misfit_mounted) {
    const RangePrediction& at = mounted.at;
    const double range_m = *compared.beam.range_m;
    const double margin_m = kShortM + 3.0 * sigma_of(compared, mounted, mounted);
    const std::uint8_t zone = compared.beam.source.zone;
    Look& look = looks_[compared.sensor];
    FaultSum& sum = sensor.faults[kOftenShort];
    if (!at.is_from_behind && range_m > at.hidden_until_m + margin_m && range_m < at.clear_m - margin_m) {
        sum.add(kShortRatio, 0.0, sensor.now);
        return;
    }
    if (!at.range_m || !mounted.has_lower_bound) return;
    if (range_m < *at.range_m - margin_m) {
        look = {Saw::is_short, zone};
    } else if (misfit_mounted <= kMisfitOfHiddenMax) {
        look = {Saw::agrees, zone};
        const bool agreed_before = sensor.looks[0].saw == Saw::agrees;
        const bool was_short_between =
            sensor.looks[0] == Look{Saw::is_short, zone} && sensor.looks[1] == look;
        if (was_short_between) sum.add(kShortRatio, 0.0, sensor.now);
        if (agreed_before) sum.add(kNotShortRatio, -kNotShortRatio, sensor.now);
    }
}

void SensorJudge::weigh_exchange(const Compared& of, const Expected& own, const Compared& other,
                                 const Expected& others) {
    if (!own.at.range_m || !others.at.range_m) return;
    Sensor& sensor = sensors_[of.sensor];
    const double sigma_m = sigma_of(of, own, others);
    weigh_fault(sensor.exchanged[other.sensor - sensor.node_begin], of, own, sigma_m,
                [&](double at_m) { return misfit(others, at_m, sigma_m); });
}

/// False for evidence over a few seconds only, or with more comparisons against the fault than for it.
bool SensorJudge::is_convincing(const Sensor& sensor, const FaultSum& sum) const {
    if (sensor.now - sum.since < kEvidenceTime) return false;
    const bool is_short = &sum == &sensor.faults[kOftenShort];
    if (!is_short && sensor.misfit_mean < kMisfitOfSoundMax) return false;
    return static_cast<double>(sum.fors) >= static_cast<double>(sum.againsts);
}

/// For a sensor without enough evidence for any fault: decides whether there is enough evidence against all
/// of them. A turn or an exchange that would not have changed a range is not required to be excluded. An
/// offset and short ranges always show.
std::optional<SensorDoubt> SensorJudge::doubt_of(Sensor& sensor) const {
    sensor.verdict.not_excluded.reset();
    bool is_left = false;
    bool is_ambiguous = sensor.misfit_mean >= kMisfitOfSoundMax;
    const auto look_at = [&](const FaultSum& sum, RangeFault fault, bool always_shows) {
        if (sum.is_excluded()) return;
        sensor.verdict.not_excluded.set(static_cast<std::size_t>(fault));
        is_left |= always_shows;
        is_ambiguous |= sum.has_shown();
    };
    for (std::size_t i = 0; i < kFaults; ++i) look_at(sensor.faults[i], fault_at(i), i < kTurned);
    const auto number = static_cast<std::size_t>(&sensor - sensors_.data());
    for (std::size_t i = 0; i < sensor.exchanged.size(); ++i)
        if (sensor.node_begin + i != number) look_at(sensor.exchanged[i], RangeFault::exchanged, false);
    if (pose_.fault()) return doubt_of_pose();
    if (is_ambiguous) return SensorDoubt::ambiguous;
    return is_left ? std::optional(SensorDoubt::too_few_comparisons) : std::nullopt;
}

void SensorJudge::decide(std::uint16_t number) {
    Sensor& sensor = sensors_[number];
    const auto by_evidence = [](const FaultSum& a, const FaultSum& b) { return a.for_it < b.for_it; };
    const bool is_taken_back = sensor.named != nullptr && sensor.named->against_it >= kTakenBackFrom;
    if (is_taken_back || pose_.fault()) {
        sensor.named = nullptr;
        sensor.verdict.fault.reset();
        sensor.verdict.exchanged_with.reset();
        sensor.faults.fill({});
        std::ranges::fill(sensor.exchanged, FaultSum{});
    }
    const auto fault = std::ranges::max_element(sensor.faults, by_evidence);
    const auto exchange = std::ranges::max_element(sensor.exchanged, by_evidence);
    const bool is_exchange = exchange->for_it > fault->for_it;
    FaultSum& likeliest = is_exchange ? *exchange : *fault;
    sensor.verdict.evidence = likeliest.for_it;
    sensor.verdict.doubt = doubt_of(sensor);
    if (sensor.named != nullptr) {
        sensor.verdict.doubt.reset();
        return;
    }
    const auto other = static_cast<std::size_t>(exchange - sensor.exchanged.begin());
    const bool is_denied =
        is_exchange &&
        sensors_[sensor.node_begin + other].exchanged[number - sensor.node_begin].for_it < kDeniedFrom;
    const double enough = is_exchange ? kExchangedFrom : kNamedFrom;
    if (sensor.verdict.evidence < enough || is_denied || !is_convincing(sensor, likeliest)) return;
    if (const auto doubt =
            against_naming(number, sensor.p_camera, is_exchange ? kMisplacedOfExchangedM : kMisplacedM)) {
        sensor.verdict.doubt = doubt;
        return;
    }
    sensor.verdict.doubt.reset();
    sensor.named = &likeliest;
    likeliest.against_it = 0.0;
    if (is_exchange) {
        sensor.verdict.fault = RangeFault::exchanged;
        sensor.verdict.exchanged_with = static_cast<std::uint8_t>(other);
    } else {
        sensor.verdict.fault = fault_at(static_cast<std::size_t>(fault - sensor.faults.begin()));
    }
}

/// Readings of contradicting sensors are not stored for others.
void SensorJudge::remember(const Compared& compared) {
    const RangePrediction& at = compared.predictions.mounted;
    if (contradicts(sensors_[compared.sensor]) || !at.range_m || !at.is_from_behind || !at.surface) return;
    const double along = std::abs(at.surface->normal_map.dot(compared.beam.direction_map));
    const double thickness_m = (*at.range_m - *compared.beam.range_m) * along;
    if (thickness_m > -kWallNoiseM && thickness_m < kWallM)
        thickness_.add(compared.sensor, at.surface->p_map, thickness_m);
}

}  // namespace octoskin
