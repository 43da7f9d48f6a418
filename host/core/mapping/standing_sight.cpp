#include "host/core/mapping/standing_sight.hpp"

#include <algorithm>

#include "host/core/mapping/standing_ranges.hpp"

namespace octoskin {

bool StandingSight::lasts(const std::vector<Reading>& readings, std::size_t from) const {
    if (readings.size() < from + kReadingsMin) return false;
    constexpr double kNanoseconds = 1e9;
    const std::int64_t since_ns = readings.back().beam.captured.ns - readings[from].beam.captured.ns;
    return static_cast<double>(since_ns) >= model_.clears_after_s * kNanoseconds;
}

void StandingSight::keep_newest(std::vector<Reading>& readings) const {
    std::size_t first = 0;
    while (lasts(readings, first + 1)) ++first;
    readings.erase(readings.begin(), readings.begin() + static_cast<std::ptrdiff_t>(first));
}

std::optional<Beam> StandingSight::take(const Beam& beam, double frees_m) {
    if (!(model_.clears_after_s > 0.0)) return std::nullopt;
    Zone& zone = zones_[beam.source];
    if (!zone.newest.empty() && !StandingRanges::are_of_one_place(zone.newest.front().beam, beam)) zone = {};
    zone.newest.push_back({beam, frees_m});
    keep_newest(zone.newest);
    // Nearer than noise: something came, which may go again.
    if (zone.told_m && frees_m < *zone.told_m - StandingRanges::tolerance_m(beam.sigma_m))
        zone.told_m.reset();
    if (!lasts(zone.newest, 0)) return std::nullopt;
    const auto shortest = std::ranges::min_element(zone.newest, {}, &Reading::frees_m);
    if (zone.told_m && shortest->frees_m <= *zone.told_m) return std::nullopt;
    zone.told_m = shortest->frees_m;
    return shortest->beam;
}

}  // namespace octoskin
