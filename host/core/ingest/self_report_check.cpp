#include "host/core/ingest/self_report_check.hpp"

#include <chrono>

namespace octoskin {

void SelfReportCheck::on_report(Fact fact, std::uint8_t sensor, std::uint32_t value,
                                std::optional<HostTime> now) {
    Newest& newest = newest_[{fact, sensor}];
    const auto before = std::exchange(newest.value, value);
    if (!now || !before || before == value || newest.changes.keeps_with_event(*now)) return;
    ++contradictions_;
    contradicted_ = now;
}

void SelfReportCheck::forget() noexcept {
    for (auto& [key, newest] : newest_) newest.value.reset();
}

bool SelfReportCheck::hears_two(HostTime now) const noexcept {
    return contradicted_ && std::chrono::abs(now - *contradicted_) < kNamedFor;
}

}  // namespace octoskin
