#include "host/core/mapping/seen_through.hpp"

#include "host/core/mapping/confirmed_ranges.hpp"

namespace octoskin {

bool SeenThrough::lasts(const Readings& readings, std::size_t from) const {
    return readings.size() >= from + kReadingsMin &&
           seconds_since(readings[from].beam, readings.back().beam.captured) >= model_.clears_after_s;
}

const Beam* SeenThrough::take(const Beam& beam, double frees_m) {
    if (!(model_.clears_after_s > 0.0 && frees_m > 0.0)) return nullptr;
    Readings& newest = zones_[beam.source];
    std::erase_if(newest, [&](const Reading& before) {
        return !counts(before.beam, beam.captured) || !ConfirmedRanges::are_of_one_place(before.beam, beam);
    });
    newest.push_back({beam, frees_m});
    while (lasts(newest, 1)) newest.pop_front();
    if (!lasts(newest, 0)) return nullptr;
    return &std::ranges::min_element(newest, {}, &Reading::frees_m)->beam;
}

}  // namespace octoskin
