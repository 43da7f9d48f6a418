#include "firmware/core/period_trim.hpp"

#include <algorithm>

namespace octoskin::node {

namespace {

constexpr std::int64_t kMillion = 1'000'000;
// Oscillators are 6-7 % off. A larger correction means that something else is wrong.
constexpr std::int64_t kScaleMinPpm = 850'000;
constexpr std::int64_t kScaleMaxPpm = 1'150'000;
// As long as a window of the ready-time tracker: the average is then known to a third of a register's step.
constexpr std::uint32_t kRangesMax = 32;
// One step of the register is 0.05-0.17 % at 50-15 ms; the rest allows for drift since the last measurement.
constexpr std::int32_t kTrimmedUncertaintyPermille = 10;

}  // namespace

PeriodTrim::PeriodTrim(Microseconds configured, const Policy& policy) noexcept
    : policy_(policy), configured_(configured), trims_left_(policy.trims_at_start) {}

void PeriodTrim::set_configured(Microseconds configured) noexcept {
    configured_ = configured;
    trims_left_ = policy_.trims_at_start;
}

Microseconds PeriodTrim::commanded() const noexcept {
    return Microseconds{configured_.count() * scale_ppm_ / kMillion};
}

std::int32_t PeriodTrim::uncertainty_permille() const noexcept {
    return is_oscillator_known_ ? kTrimmedUncertaintyPermille : policy_.period_expected_permille;
}

bool PeriodTrim::is_judged_after(std::uint32_t ranges) const noexcept {
    const auto wanted = static_cast<std::uint32_t>(policy_.trim_after / configured_);
    return ranges % std::clamp(wanted, policy_.trim_edges_min + 1, kRangesMax) == 0;
}

std::int32_t PeriodTrim::error_permille(Microseconds measured) const noexcept {
    return static_cast<std::int32_t>((measured - configured_).count() * 1000 / configured_.count());
}

bool PeriodTrim::wants_trim(const MeasuredPeriod& measured, NodeTime now) noexcept {
    // Dropped once it no longer matters. A sensor at rest may not evaluate it for longer than half the
    // clock's range: then it looks like a future time. After a full wrap it looks recent, for one interval.
    if (last_trim_) {
        const Microseconds since = elapsed(*last_trim_, now);
        if (since.count() < 0 || since >= policy_.trim_interval) last_trim_.reset();
    }

    Microseconds real = measured.value;
    // A period that became too short for the budget is observed doubled; half of it is what the register
    // makes.
    if (real > configured_ * 17 / 10) real /= 2;
    const std::int64_t tolerance_us = configured_.count() * policy_.trim_tolerance_permille / 1000;
    const std::int64_t off_us = std::abs((real - configured_).count());
    const bool is_certain = measured.uncertainty.count() * 2 <= tolerance_us;
    if (!is_certain || off_us <= tolerance_us) return false;

    if (trims_left_ > 0) {
        --trims_left_;
    } else if (last_trim_) {
        return false;
    }
    const std::int64_t scale = scale_ppm_ * configured_.count() / real.count();
    scale_ppm_ = std::clamp(scale, kScaleMinPpm, kScaleMaxPpm);
    is_oscillator_known_ = scale == scale_ppm_;
    last_trim_ = now;
    return true;
}

Nanoseconds PeriodTrim::refine(Nanoseconds walk, Nanoseconds step) noexcept {
    // Rounded to the nearest whole step.
    const std::int64_t half = walk.count() < 0 ? -step.count() / 2 : step.count() / 2;
    const std::int64_t steps = (walk.count() + half) / step.count();
    refinements_ = static_cast<std::uint8_t>(std::min(refinements_ + 1, 2));
    if (steps == 0) {
        is_oscillator_known_ = true;
        return walk;
    }
    // The register rounds down. A value in the middle of a step neither misses a step nor takes one twice.
    const std::int64_t before = Nanoseconds{commanded()} / step;
    const std::int64_t scale = ((before - steps) * step + step / 2).count() * 1'000 / configured_.count();
    scale_ppm_ = std::clamp(scale, kScaleMinPpm, kScaleMaxPpm);
    is_oscillator_known_ = scale == scale_ppm_;
    return walk - (before - Nanoseconds{commanded()} / step) * step;
}

}  // namespace octoskin::node
