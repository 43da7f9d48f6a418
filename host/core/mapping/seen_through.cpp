#include "host/core/mapping/seen_through.hpp"

#include "host/core/mapping/confirmed_ranges.hpp"

namespace octoskin {

bool SeenThrough::lasts(const Passages& passages, std::size_t from) const {
    return passages.size() >= from + kReadingsMin &&
           seconds_since(passages[from].beam, passages.back().beam.captured) >= model_.clears_after_s;
}

const Beam* SeenThrough::take(const Beam& beam, double frees_m, SensorHistories& histories) const {
    if (!(model_.clears_after_s > 0.0 && frees_m > 0.0)) return nullptr;
    Passages& newest = histories[beam.source.sensor_id()].zones[beam.source.zone].passages;
    std::erase_if(newest, [&](const Passage& before) {
        return !counts(before.beam, beam.captured) || !ConfirmedRanges::are_of_one_place(before.beam, beam);
    });
    newest.push_back({beam, frees_m});
    while (lasts(newest, 1)) newest.pop_front();
    if (!lasts(newest, 0)) return nullptr;
    return &std::ranges::min_element(newest, {}, &Passage::frees_m)->beam;
}

}  // namespace octoskin
