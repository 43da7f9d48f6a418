#include "host/core/witness/sensor_judge.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace octoskin {
namespace {

/// By so much camera, robot and rig may be off without anybody's fault.
constexpr double kToleranceM = 0.02;
constexpr double kPoseSigmaM = 0.01;
/// What one comparison may say at the most: one in fifty is of something that nobody thought of.
constexpr double kMisfitMax = 4.0;
/// The offset that is looked for.
constexpr double kOffsetM = 0.06;
/// What fits counts for a sensor until so much is together.
constexpr double kCreditMax = 14.0;
/// Each comparison that says anything takes this of the evidence.
constexpr double kDoubt = 0.15;
/// Where the camera does not see what is before a surface, a range that is shorter by this is of something
/// else,
constexpr double kSomethingElseM = 0.12;
/// and one that is a little shorter may be.
constexpr double kMisfitOfHiddenMax = 1.2;
/// What ends so little beyond where the camera does not see may be of there: the image is of another instant,
/// and the camera a little off.
constexpr double kHiddenMarginM = 0.1;
/// Thinner than this is a wall, and that much of noise.
constexpr double kWallM = 0.1;
constexpr double kWallNoiseM = 0.06;
/// A ray along a surface says little of how thick it is.
constexpr double kAlongMin = 0.3;
/// Short is shorter than what is there by this and 3 sigma. Then log(1/3 / 1/50), and log(2/3) where not.
constexpr double kShortM = 0.12;
constexpr double kShortRatio = 2.8;
constexpr double kNotShortRatio = -0.4;

/// Weak evidence of one place, 0.3 m about, adds up to this at the most: it may be of one thing. Less than
/// what names.
constexpr double kPlaceM = 0.3;
constexpr double kPlaceMax = 5.0;
/// Evidence that is together counts up to this.
constexpr double kEvidenceMax = 40.0;

/// No fault is named, but that of single ranges, while the newest dozen fit what the rig says this well.
constexpr double kMisfitShare = 1.0 / 12.0;
constexpr double kMisfitOfSoundMax = 0.35;
/// Two that are exchanged both range like the other: no exchange, if the other denies it so much.
constexpr double kDeniedFrom = -6.0;
/// A comparison that says so much is for a fault or against it, until some 64 others are.
constexpr double kSaysMuch = 0.5;
constexpr float kForgotten = 1.0F - 1.0F / 64.0F;
/// Evidence of a shorter time is of one view of one thing; and it takes the camera's so long.
constexpr Nanoseconds kEvidenceTime{3'000'000'000};
/// So far may the camera have a place from where it is, and a sensor still be named for what it contradicts
/// there. What two exchanged sensors contradict is larger than what a camera does that is off.
constexpr double kMisplacedM = 0.1;
constexpr double kMisplacedOfExchangedM = 0.25;
/// So many others may contradict the camera beside one that is named: of two that are exchanged both do.
constexpr std::size_t kOthersMax = 1;

/// Places in Sensor::faults; turns come after these.
constexpr std::size_t kTooLong = 0;
constexpr std::size_t kTooShort = 1;
constexpr std::size_t kOftenShort = 2;
constexpr std::size_t kTurned = 3;

SensorFault fault_at(std::size_t place) {
    switch (place) {
        case kTooLong:
            return SensorFault::ranges_too_long;
        case kTooShort:
            return SensorFault::ranges_too_short;
        case kOftenShort:
            return SensorFault::often_short;
        default:
            return SensorFault::turned;
    }
}

}  // namespace

void SensorJudge::Sum::add(double ratio, HostTime now) {
    if (ratio == 0.0) return;
    if (std::abs(ratio) >= kSaysMuch) {
        fors = kForgotten * fors + (ratio > 0.0 ? 1.0F : 0.0F);
        againsts = kForgotten * againsts + (ratio < 0.0 ? 1.0F : 0.0F);
    }
    if (for_it <= 0.0) since = now;
    for_it = std::clamp(for_it + ratio - kDoubt, -kCreditMax, kEvidenceMax);
    against_it = std::clamp(against_it - ratio - kDoubt, 0.0, kEvidenceMax);
}

void SensorJudge::Sum::add_weak(double ratio, const Beam& beam) {
    if (ratio > kDoubt) {
        const Eigen::Vector3f p_map = (beam.p_map_sensor + *beam.range_m * beam.direction_map).cast<float>();
        auto place = std::ranges::find_if(places, [&p_map](const Place& of) {
            return of.for_it > 0.0F && static_cast<double>((of.p_map - p_map).norm()) < kPlaceM;
        });
        if (place == places.end()) {
            place = std::ranges::min_element(places, {}, &Place::for_it);
            *place = Place{.p_map = p_map, .for_it = 0.0F};
        }
        ratio = std::min(ratio, kDoubt + kPlaceMax - static_cast<double>(place->for_it));
        place->for_it += static_cast<float>(ratio - kDoubt);
    }
    add(ratio, beam.captured);
}

SensorJudge::SensorJudge(std::span<const std::size_t> sensors_of_nodes)
    : camera_(std::accumulate(sensors_of_nodes.begin(), sensors_of_nodes.end(), std::size_t{0})) {
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
    // Of a turned mount the ray's direction is not quite that.
    const double along =
        std::max(kAlongMin, std::abs(prediction.surface->normal_map.dot(compared.beam.direction_map)));
    *expected.at.range_m -= known->thickness_m / along;
    expected.sigma_m = std::hypot(expected.sigma_m, known->sigma_m / along);
    expected.has_lower_bound = true;
    return expected;
}

/// Minus the logarithm of a range's likelihood, but for a constant; empty: nothing can be said.
std::optional<double> SensorJudge::misfit(const Expected& expected, double range_m, double sigma_m) {
    const RangePrediction& at = expected.at;
    double off_m = 0.0;
    double misfit_max = kMisfitMax;
    if (!at.range_m) {
        // Nothing is known but where there is nothing.
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
    looks_.assign(sensors_.size(), Look::nothing);
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
    for (const Compared& one : compared) ask_camera(one);
    camera_.decide();
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        decide(static_cast<std::uint16_t>(i));
        sensors_[i].looks = {looks_[i], sensors_[i].looks[0]};
    }
    for (const Compared& one : compared) remember(one);
}

void SensorJudge::ask_camera(const Compared& compared) {
    const RangePrediction& at = compared.predictions.mounted;
    const double range_m = *compared.beam.range_m;
    if (!at.range_m || (!at.is_from_behind && range_m < at.hidden_until_m)) return;
    camera_.compare(compared.sensor,
                    {.off_m = range_m - *at.range_m,
                     .sigma_m = std::hypot(compared.beam.sigma_m, at.sigma_m),
                     .is_from_behind = at.is_from_behind},
                    compared.predictions.hits);
}

bool SensorJudge::contradicts(const Sensor& sensor) const {
    return sensor.verdict.fault || sensor.is_far_off || sensor.verdict.evidence >= kContradictsFrom;
}

bool SensorJudge::may_name(std::uint16_t number, const Eigen::Vector3d& p_camera,
                           double misplaced_max_m) const {
    if (camera_.error() || camera_.is_suspect()) return false;
    if (camera_.may_misplace_m(number, p_camera) > misplaced_max_m) return false;
    // Another test may have found one since the newest image was judged: they are counted anew.
    const auto contradicting =
        std::ranges::count_if(sensors_, [this](const Sensor& sensor) { return contradicts(sensor); });
    const auto others = static_cast<std::size_t>(contradicting) - (contradicts(sensors_[number]) ? 1U : 0U);
    return others <= kOthersMax;
}

/// From behind, what ends before the surface may end at something that the camera does not see: that is weak.
void SensorJudge::add(Sum& sum, double ratio, const Compared& compared, const Expected& mounted) {
    if (mounted.at.is_from_behind && *compared.beam.range_m < *mounted.at.range_m) {
        sum.add_weak(ratio, compared.beam);
    } else {
        sum.add(ratio, compared.beam.captured);
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
    if (const auto other = misfit(mounted, range_m - kOffsetM, sigma_m))
        add(sensor.faults[kTooLong], *sound - *other, compared, mounted);
    if (const auto other = misfit(mounted, range_m + kOffsetM, sigma_m))
        add(sensor.faults[kTooShort], *sound - *other, compared, mounted);
    for (std::size_t i = 0; i < kTurns; ++i) {
        if (!compared.predictions.turned[i].range_m) continue;
        const Expected turned = expected(compared, compared.predictions.turned[i]);
        const double sigma_both_m = sigma_of(compared, mounted, turned);
        const auto as_mounted = misfit(mounted, range_m, sigma_both_m);
        const auto as_turned = misfit(turned, range_m, sigma_both_m);
        if (as_mounted && as_turned)
            add(sensor.faults[kTurned + i], *as_mounted - *as_turned, compared, mounted);
    }
}

/// Where the camera sees that nothing is, once is enough. Elsewhere something may be: but not between two
/// images in which the sensor saw the surface behind it.
void SensorJudge::weigh_short(Sensor& sensor, const Compared& compared, const Expected& mounted,
                              double misfit_mounted) {
    const RangePrediction& at = mounted.at;
    const double range_m = *compared.beam.range_m;
    const double margin_m = kShortM + 3.0 * sigma_of(compared, mounted, mounted);
    Look& look = looks_[compared.sensor];
    Sum& sum = sensor.faults[kOftenShort];
    if (!at.is_from_behind && range_m > at.hidden_until_m + margin_m && range_m < at.clear_m - margin_m) {
        sum.add(kShortRatio, sensor.now);
        return;
    }
    if (!at.range_m || !mounted.has_lower_bound) return;
    if (range_m < *at.range_m - margin_m) {
        look = Look::is_short;
    } else if (misfit_mounted <= kMisfitOfHiddenMax) {
        look = Look::agrees;
        const bool agreed_before = sensor.looks[0] == Look::agrees;
        const bool was_short_between = sensor.looks[0] == Look::is_short && sensor.looks[1] == Look::agrees;
        if (was_short_between) sum.add(kShortRatio, sensor.now);
        if (agreed_before) sum.add(kNotShortRatio, sensor.now);
    }
}

void SensorJudge::weigh_exchange(const Compared& of, const Expected& own, const Compared& other,
                                 const Expected& others) {
    if (!own.at.range_m || !others.at.range_m) return;
    Sensor& sensor = sensors_[of.sensor];
    const double sigma_m = sigma_of(of, own, others);
    const auto sound = misfit(own, *of.beam.range_m, sigma_m);
    const auto exchanged = misfit(others, *of.beam.range_m, sigma_m);
    if (sound && exchanged)
        add(sensor.exchanged[other.sensor - sensor.node_begin], *sound - *exchanged, of, own);
}

/// Not what a few seconds say, nor what as many comparisons deny.
bool SensorJudge::is_convincing(const Sensor& sensor, const Sum& sum) const {
    if (sensor.now - sum.since < kEvidenceTime) return false;
    const bool is_short = &sum == &sensor.faults[kOftenShort];
    if (!is_short && sensor.misfit_mean < kMisfitOfSoundMax) return false;
    return static_cast<double>(sum.fors) >= static_cast<double>(sum.againsts);
}

void SensorJudge::decide(std::uint16_t number) {
    Sensor& sensor = sensors_[number];
    const auto by_evidence = [](const Sum& a, const Sum& b) { return a.for_it < b.for_it; };
    const bool is_taken_back = sensor.named != nullptr && sensor.named->against_it >= kTakenBackFrom;
    if (is_taken_back || camera_.error()) {
        sensor.named = nullptr;
        sensor.verdict.fault.reset();
        sensor.verdict.exchanged_with.reset();
        sensor.faults.fill({});
        std::ranges::fill(sensor.exchanged, Sum{});
    }
    const auto fault = std::ranges::max_element(sensor.faults, by_evidence);
    const auto exchange = std::ranges::max_element(sensor.exchanged, by_evidence);
    const bool is_exchange = exchange->for_it > fault->for_it;
    Sum& likeliest = is_exchange ? *exchange : *fault;
    sensor.verdict.evidence = likeliest.for_it;
    sensor.verdict.cannot_tell = false;
    if (sensor.named != nullptr) return;
    const auto other = static_cast<std::size_t>(exchange - sensor.exchanged.begin());
    const bool is_denied =
        is_exchange &&
        sensors_[sensor.node_begin + other].exchanged[number - sensor.node_begin].for_it < kDeniedFrom;
    const double enough = is_exchange ? kExchangedFrom : kNamedFrom;
    const bool is_enough =
        sensor.verdict.evidence >= enough && !is_denied && is_convincing(sensor, likeliest);
    if (!is_enough ||
        !may_name(number, sensor.p_camera, is_exchange ? kMisplacedOfExchangedM : kMisplacedM)) {
        sensor.verdict.cannot_tell = likeliest.for_it >= kContradictsFrom;
        return;
    }
    sensor.named = &likeliest;
    likeliest.against_it = 0.0;
    if (is_exchange) {
        sensor.verdict.fault = SensorFault::exchanged;
        sensor.verdict.exchanged_with = static_cast<std::uint8_t>(other);
    } else {
        sensor.verdict.fault = fault_at(static_cast<std::size_t>(fault - sensor.faults.begin()));
    }
}

/// What contradicts is not for others.
void SensorJudge::remember(const Compared& compared) {
    const RangePrediction& at = compared.predictions.mounted;
    if (contradicts(sensors_[compared.sensor]) || !at.range_m || !at.is_from_behind || !at.surface) return;
    const double along = std::abs(at.surface->normal_map.dot(compared.beam.direction_map));
    const double thickness_m = (*at.range_m - *compared.beam.range_m) * along;
    if (thickness_m > -kWallNoiseM && thickness_m < kWallM)
        thickness_.add(compared.sensor, at.surface->p_map, thickness_m);
}

}  // namespace octoskin
