#include "firmware/drivers/vl53l1x/calibration.hpp"

#include <algorithm>
#include <cassert>

#include "common/range_status.hpp"
#include "firmware/drivers/vl53l1x/read_back.hpp"

namespace octoskin::vl53l1x {
namespace {

constexpr Microseconds kPollEvery{1'000};
constexpr Microseconds kReadAgainAfter{10'000};  // ten of these last longer than one implausible range
constexpr Microseconds kRangeWithinMin{2'000'000};
constexpr std::int64_t kRangeWithinPeriods = 3;

// Indices into kRegisterRuns.
constexpr std::size_t kOffsetRun = 0;
constexpr std::size_t kCrosstalkRun = 4;
static_assert(kRegisterRuns[kOffsetRun].first == 0x1E && kRegisterRuns[kCrosstalkRun].first == 0x16);

/// 127 kcps in units of 1/512 kcps: the maximum of a rig file.
constexpr std::int64_t kCrosstalkRawMax = std::int64_t{127} * 512;

/// Rounds to the nearest integer, halves away from zero.
std::int64_t divided(std::int64_t dividend, std::int64_t divisor) noexcept {
    const std::int64_t half = dividend < 0 ? -divisor / 2 : divisor / 2;
    return (dividend + half) / divisor;
}

}  // namespace

CalibrationRun::CalibrationRun(Device& device, Microseconds period) noexcept
    : device_(device), range_within_(std::max(kRangeWithinMin, kRangeWithinPeriods * period)) {}

void CalibrationRun::begin_offset(std::uint16_t target_mm) {
    begin(Quantity::offset, target_mm);
}

void CalibrationRun::begin_crosstalk(std::uint16_t target_mm) {
    begin(Quantity::crosstalk, target_mm);
}

void CalibrationRun::begin(Quantity quantity, std::uint16_t target_mm) {
    assert(progress_ == Progress::idle && !device_.is_busy());
    quantity_ = quantity;
    target_mm_ = target_mm;
    has_failed_ = false;
    has_waited_ = false;
    resume_at_.reset();
    ranges_ = 0;
    ranges_invalid_ = 0;
    reads_dropped_ = 0;
    range_sum_mm_ = 0;
    signal_sum_ = 0;
    spads_sum_ = 0;
    stream_last_ = 0;
    offset_quarter_mm_ = 0;
    crosstalk_raw_ = 0;
    progress_ = Progress::busy;
    if (!is_target_supported(target_mm)) {
        error_ = CalibrationError::unsupported_target;
        progress_ = Progress::failed;
        return;
    }
    start_step(Step::zeroing);
}

void CalibrationRun::abandon() noexcept {
    progress_ = Progress::idle;
    resume_at_.reset();
}

Progress CalibrationRun::poll(NodeTime now) {
    if (progress_ != Progress::busy) return end(progress_);
    if (!has_waited_) {
        last_result_ = now;
        has_waited_ = true;
    }
    if (resume_at_) {
        if (!is_reached(*resume_at_, now)) return Progress::busy;
        resume_at_.reset();
        start_step(Step::ranging);
    }
    switch (device_.poll(now)) {
        case Progress::done:
            return on_step_done(now);
        case Progress::failed:
            if (drops_read()) {
                resume_at_ = now + kReadAgainAfter;
                return Progress::busy;
            }
            // A run that is already stopping keeps its first error.
            if (!has_failed_) error_ = CalibrationError::device;
            return end(Progress::failed);
        case Progress::idle:
        case Progress::busy:
            break;
    }
    return Progress::busy;
}

void CalibrationRun::start_step(Step step) {
    step_ = step;
    switch (step) {
        case Step::zeroing:
            write(0, 0);
            break;
        case Step::checking:
        case Step::checking_again:
            // A nonzero offset or crosstalk left in the sensor would shift the result by its own value.
            device_.begin_verify(quantity_ == Quantity::offset ? kOffsetRun : kCrosstalkRun);
            break;
        case Step::starting:
            device_.begin_start();
            break;
        case Step::ranging:
            device_.begin_read();
            break;
        case Step::stopping:
            device_.begin_abort();
            break;
        case Step::applying:
            write(offset_quarter_mm_, crosstalk_raw_);
            break;
    }
}

void CalibrationRun::write(std::int16_t offset_quarter_mm, std::uint16_t crosstalk_raw) {
    if (quantity_ == Quantity::offset) {
        device_.begin_set_offset(offset_quarter_mm);
    } else {
        device_.begin_set_crosstalk(crosstalk_raw);
    }
}

Progress CalibrationRun::on_step_done(NodeTime now) {
    switch (step_) {
        case Step::zeroing:
            start_step(Step::checking);
            break;
        case Step::checking:
            start_step(Step::starting);
            break;
        case Step::starting:
            return pause(now);
        case Step::checking_again:
            if (!compute()) return stop_and_fail(CalibrationError::out_of_range);
            start_step(Step::stopping);
            break;
        case Step::ranging:
            return on_range(now);
        case Step::stopping:
            if (has_failed_) return end(Progress::failed);
            start_step(Step::applying);
            break;
        case Step::applying:
            return end(Progress::done);
    }
    return Progress::busy;
}

Progress CalibrationRun::on_range(NodeTime now) {
    if (device_.has_measurement() && add(device_.measurement())) last_result_ = now;
    if (ranges_invalid_ > kRangesInvalidMax) return stop_and_fail(CalibrationError::no_target);
    if (elapsed(last_result_, now) > range_within_) return stop_and_fail(CalibrationError::no_result);
    if (ranges_ == kRanges) {
        start_step(Step::checking_again);
        return Progress::busy;
    }
    return pause(now);
}

/// The two reads of a result differ, or the block is implausible. The sensor still holds the result, so it
/// can be read again.
bool CalibrationRun::drops_read() noexcept {
    const Error error = device_.error();
    if (step_ != Step::ranging) return false;
    if (error != Error::reads_disagree && error != Error::implausible_block) return false;
    return reads_dropped_++ < kReadsDroppedMax;
}

Progress CalibrationRun::pause(NodeTime now) {
    resume_at_ = now + kPollEvery;
    return Progress::busy;
}

/// False if the measurement is a repetition.
bool CalibrationRun::add(const Measurement& measurement) noexcept {
    if (measurement.stream_count == 0) return true;              // no wrap check
    if (measurement.stream_count == stream_last_) return false;  // repeated: the sensor has stopped
    stream_last_ = measurement.stream_count;
    if (measurement.device_status != kDeviceStatusComplete) {
        ++ranges_invalid_;
        return true;
    }
    ++ranges_;
    range_sum_mm_ += measurement.range_mm;
    signal_sum_ += measurement.corrected_signal;
    spads_sum_ += measurement.effective_spads;
    return true;
}

bool CalibrationRun::compute() noexcept {
    const std::int64_t target_sum_mm = std::int64_t{kRanges} * target_mm_;
    const std::int64_t shortfall_mm = target_sum_mm - range_sum_mm_;
    if (quantity_ == Quantity::offset) {
        // The sensor adds the offset before the driver applies the gain factor, so divide by the gain.
        const std::int64_t dividend = device_.applies_gain_factor() ? 2048 : 1;
        const std::int64_t divisor = device_.applies_gain_factor() ? 2011 : 1;
        const std::int64_t quarters = divided(4 * shortfall_mm * dividend, kRanges * divisor);
        if (quarters < kOffsetQuarterMmMin || quarters > kOffsetQuarterMmMax) return false;
        offset_quarter_mm_ = static_cast<std::int16_t>(quarters);
        return true;
    }
    // 512 * signal in kcps * (1 - range / target) / SPADs. The signal is in 1/128 Mcps, the SPAD count in
    // 1/256. The SPAD sum is not 0: the driver refuses a complete range without SPADs.
    const std::int64_t signal_per_spad = 1'024'000 * signal_sum_ / spads_sum_;
    const std::int64_t raw =
        divided(signal_per_spad * std::max<std::int64_t>(shortfall_mm, 0), target_sum_mm);
    if (raw > kCrosstalkRawMax) return false;
    crosstalk_raw_ = static_cast<std::uint16_t>(raw);
    return true;
}

Progress CalibrationRun::stop_and_fail(CalibrationError error) {
    error_ = error;
    has_failed_ = true;
    start_step(Step::stopping);
    return Progress::busy;
}

Progress CalibrationRun::end(Progress progress) noexcept {
    progress_ = Progress::idle;
    return progress;
}

}  // namespace octoskin::vl53l1x
