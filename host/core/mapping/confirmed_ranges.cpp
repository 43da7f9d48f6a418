#include "host/core/mapping/confirmed_ranges.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace octoskin {
namespace {

double tolerance_m(const Beam& a, const Beam& b) {
    return ConfirmedRanges::kAgreement_m + ConfirmedRanges::kAgreementSigmas * std::max(a.sigma_m, b.sigma_m);
}

/// Both beams have a range.
bool agree(const Beam& a, const Beam& b) {
    const double angle = std::acos(std::clamp(a.direction_map.dot(b.direction_map), -1.0, 1.0));
    return std::fabs(*a.range_m - *b.range_m) <= tolerance_m(a, b) + angle * *a.range_m;
}

/// True if `before` measured the surface that `beam` measures, or a nearer one.
bool is_explained_by(const Beam& before, const Beam& beam) {
    return before.range_m && ConfirmedRanges::are_of_one_place(before, beam) &&
           *before.range_m <= *beam.range_m + tolerance_m(before, beam);
}

/// True if the beam measures the surface that its zone has confirmed.
bool goes_on(const Beam& confirmed, const Beam& beam) {
    return beam.range_m && ConfirmedRanges::are_of_one_place(confirmed, beam) && agree(confirmed, beam);
}

}  // namespace

bool ConfirmedRanges::are_of_one_place(const Beam& a, const Beam& b) {
    // The trace of a rotation is 1 + 2 cos(angle).
    static const double trace_min = 1.0 + 2.0 * std::cos(kTurnedMax_rad);
    const double moved2 = (a.p_map_sensor - b.p_map_sensor).squaredNorm();
    return moved2 <= kMovedMax_m * kMovedMax_m &&
           a.R_map_sensor.cwiseProduct(b.R_map_sensor).sum() >= trace_min;
}

bool ConfirmedRanges::is_stationary(const ZoneHistory& zone) const {
    const std::span<const Reading> all(zone.newest);
    const std::size_t window = model_.window();
    return all.size() > window && std::ranges::all_of(all.last(window + 1), [&](const Reading& reading) {
               return are_of_one_place(reading.beam, all.back().beam);
           });
}

/// Clears the readings of zones that have missed about `kBefore` readings in a row, by the mean time between
/// their readings. What such a zone sees when it resumes is new.
void ConfirmedRanges::forget_silent(SensorHistory& sensor, const Beam& beam) {
    for (auto& entry : sensor.zones) {
        ZoneHistory& zone = entry.second;
        if (zone.newest.empty()) continue;
        constexpr double kMissing = static_cast<double>(kBefore) + 0.5;
        constexpr double kLoneFor_s = 10.0;  // with a single reading, the rate is unknown
        const auto intervals = static_cast<double>(zone.newest.size() - 1);
        const double lasted_s = seconds_since(zone.newest.front().beam, zone.newest.back().beam.captured);
        const double silent_max_s = intervals > 0.0 ? kMissing * lasted_s / intervals : kLoneFor_s;
        if (seconds_since(zone.newest.back().beam, beam.captured) <= silent_max_s) continue;
        end(zone, beam);
        zone.newest.clear();
    }
}

ConfirmedRanges::Answer ConfirmedRanges::take(const Beam& beam, SensorHistories& histories) {
    confirmed_.clear();
    ended_.clear();
    if (model_.readings == 0) return {};
    SensorHistory& sensor = histories[beam.source.sensor_id()];
    forget_silent(sensor, beam);
    ZoneHistory& zone = sensor.zones[beam.source.zone];
    const std::size_t window = model_.window();
    zone.newest.reserve(readings_max(model_));
    if (zone.newest.size() >= readings_max(model_)) zone.newest.erase(zone.newest.begin());
    zone.newest.push_back({beam, ++sensor.readings, false});
    const bool repeats_confirmed = follow_confirmed(zone);
    if (!beam.range_m) return {{}, ended_, false, is_stationary(zone)};

    window_ = {{&zone, zone.newest.size() - std::min(zone.newest.size(), window)}};
    confirm(beam, window_);
    if (sensor.zones.size() > 1) {
        window_.clear();
        for (auto& [index, each] : sensor.zones) {
            const auto first = std::ranges::find_if(each.newest, [&](const Reading& reading) {
                return reading.number + window > sensor.readings;
            });
            if (first != each.newest.end())
                window_.emplace_back(&each, static_cast<std::size_t>(first - each.newest.begin()));
        }
        confirm(beam, window_);
    }
    for (const Beam& confirmed : confirmed_) {
        ZoneHistory& of = sensor.zones[confirmed.source.zone];
        if (of.confirmed && !goes_on(*of.confirmed, confirmed)) end(of, beam);
        of.confirmed = confirmed;
    }
    add_persisting(beam, sensor);
    return {confirmed_, ended_, repeats_confirmed, is_stationary(zone)};
}

/// A confirmed range may move slowly. It has gone if none of the last `kBefore` readings agrees with it.
/// Returns true if the newest reading agrees.
bool ConfirmedRanges::follow_confirmed(ZoneHistory& zone) {
    if (!zone.confirmed) return false;
    const Beam& newest = zone.newest.back().beam;
    if (goes_on(*zone.confirmed, newest)) {
        constexpr double kShare = 0.25;
        *zone.confirmed->range_m += kShare * (*newest.range_m - *zone.confirmed->range_m);
        return true;
    }
    const auto last = std::span(zone.newest).last(std::min(zone.newest.size(), kBefore));
    const auto is_of_it = [&](const Reading& reading) { return goes_on(*zone.confirmed, reading.beam); };
    if (std::ranges::none_of(last, is_of_it)) end(zone, newest);
    return false;
}

/// `now`: the sensor's newest beam. A sensor that has moved did not count hits from one place, so nothing is
/// withdrawn.
void ConfirmedRanges::end(ZoneHistory& zone, const Beam& now) {
    if (!zone.confirmed) return;
    if (are_of_one_place(*zone.confirmed, now)) ended_.push_back(*zone.confirmed);
    zone.confirmed.reset();
}

void ConfirmedRanges::add_persisting(const Beam& newest, const SensorHistory& sensor) {
    for (const auto& entry : sensor.zones) {
        const ZoneHistory& zone = entry.second;
        if (!zone.confirmed) continue;  // without memory, a zone may have no reading
        const Beam& own_newest = zone.newest.back().beam;
        if (!goes_on(*zone.confirmed, own_newest)) continue;
        const bool is_asked =
            own_newest.source == newest.source || *zone.confirmed->range_m < *newest.range_m;
        const bool is_added = std::ranges::any_of(
            confirmed_, [&](const Beam& added) { return added.source == own_newest.source; });
        if (is_asked && !is_added && are_of_one_place(*zone.confirmed, newest))
            confirmed_.push_back(*zone.confirmed);
    }
}

void ConfirmedRanges::confirm(const Beam& newest, const Window& window) {
    agreeing_.clear();
    for (const auto& [zone, first] : window) {
        const std::span<Reading> all(zone->newest);
        const auto newest_before = all.first(first).last(std::min(first, kBefore));
        for (Reading& reading : all.subspan(first)) {
            const Beam& beam = reading.beam;
            const bool is_new = std::ranges::none_of(
                newest_before, [&](const Reading& before) { return is_explained_by(before.beam, beam); });
            if (beam.range_m && is_new && are_of_one_place(beam, newest) && agree(beam, newest))
                agreeing_.push_back(&reading);
        }
    }
    if (agreeing_.size() < model_.readings) return;
    for (auto reading = agreeing_.begin(); reading != agreeing_.end();) {
        // Readings of one zone are adjacent, the newest last.
        double sum_m = 0.0;
        bool is_confirmed = true;
        auto next = reading;
        for (; next != agreeing_.end() && (*next)->beam.source == (*reading)->beam.source; ++next) {
            sum_m += *(*next)->beam.range_m;
            is_confirmed = is_confirmed && (*next)->is_confirmed;
            (*next)->is_confirmed = true;
        }
        if (!is_confirmed) {
            confirmed_.push_back((*(next - 1))->beam);
            confirmed_.back().range_m = sum_m / static_cast<double>(next - reading);
        }
        reading = next;
    }
}

}  // namespace octoskin
