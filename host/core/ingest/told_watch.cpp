#include "host/core/ingest/told_watch.hpp"

#include <chrono>

namespace octoskin {

void ToldWatch::on_told(Fact fact, std::uint8_t sensor, std::uint32_t value, std::optional<HostTime> now) {
    Told& told = told_[{fact, sensor}];
    const auto before = std::exchange(told.value, value);
    if (!now || !before || before == value || told.changes.keeps_with_event(*now)) return;
    ++contradictions_;
    contradicted_ = now;
}

void ToldWatch::forget() noexcept {
    for (auto& [key, told] : told_) told.value.reset();
}

bool ToldWatch::hears_two(HostTime now) const noexcept {
    return contradicted_ && std::chrono::abs(now - *contradicted_) < kTold;
}

}  // namespace octoskin
