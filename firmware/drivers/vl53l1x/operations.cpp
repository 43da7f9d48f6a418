// Begins each operation: checks and stores the arguments, then hands the table to the runner.
#include <cassert>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "firmware/drivers/vl53l1x/method.hpp"
#include "firmware/drivers/vl53l1x/roi.hpp"

namespace octoskin::vl53l1x {

void Device::begin_probe(i2c::Address address) {
    begin(Method::kProbe);
    live_address_ = address;
}

void Device::begin_set_address(i2c::Address address) {
    begin(Method::kSetAddress);
    new_address_ = address;
}

void Device::begin_soft_reset() {
    begin(Method::kSoftReset);
}

void Device::begin_await_boot_at_default(bool is_patient) {
    begin(is_patient ? Method::kAwaitBootAtDefaultPatiently : Method::kAwaitBootAtDefault);
    live_address_ = kDefaultAddress;
}

void Device::begin_await_boot() {
    begin(Method::kAwaitBootOnly);
}

void Device::begin_load_configuration() {
    begin(Method::kLoadConfiguration);
}

void Device::begin_initialise() {
    begin(Method::kInitialise);
}

void Device::begin_finish_initialise() {
    begin(Method::kFinishInitialise);
}

void Device::begin_configure(const Settings& settings) {
    if (!is_supported(settings)) return begin_refused();
    begin(Method::kConfigure);
    settings_ = settings;
    roi_ = settings.zones[0];
    period_ = Microseconds{std::int64_t{settings.inter_measurement_ms} * 1'000};
}

void Device::begin_set_distance_mode(DistanceMode mode) {
    begin(Method::kSetDistanceMode);
    settings_.distance_mode = mode;
}

void Device::begin_set_timing_budget(std::uint16_t budget_ms) {
    // Not checked here: with `rereads_settings` the mode is only known after it has been read.
    begin(Method::kSetTimingBudget);
    settings_.timing_budget_ms = budget_ms;
}

void Device::begin_set_inter_measurement(Microseconds nominal) {
    if (nominal.count() <= 0) return begin_refused();
    begin(Method::kSetInterMeasurement);
    period_ = nominal;
}

void Device::begin_set_sigma_limit(std::uint16_t quarter_mm) {
    begin(Method::kSetSigmaLimit);
    settings_.sigma_limit_quarter_mm = quarter_mm;
}

void Device::begin_set_signal_limit(std::uint16_t mcps_9_7) {
    begin(Method::kSetSignalLimit);
    settings_.signal_limit_raw = mcps_9_7;
}

void Device::begin_set_offset(std::int16_t quarter_mm) {
    if (!is_offset_supported(quarter_mm)) return begin_refused();
    begin(Method::kSetOffset);
    settings_.has_offset = true;
    settings_.offset_quarter_mm = quarter_mm;
}

void Device::begin_set_crosstalk(std::uint16_t kcps_per_spad_7_9) {
    begin(Method::kSetCrosstalk);
    settings_.crosstalk_raw = kcps_per_spad_7_9;
}

void Device::begin_set_interrupt_polarity(bool is_active_low) {
    begin(Method::kSetPolarity);
    is_polarity_low_ = is_active_low;
}

void Device::begin_set_range_threshold(const RangeThreshold& threshold) {
    if (threshold.low_mm > threshold.high_mm) return begin_refused();
    begin(Method::kSetRangeThreshold);
    threshold_ = threshold;
}

void Device::begin_set_interrupt_on_every_sample() {
    begin(Method::kSetEverySample);
}

void Device::begin_set_roi_size(std::uint8_t width, std::uint8_t height) {
    const Roi centred{.width = width, .height = height};
    if (!is_supported(centred)) return begin_refused();
    begin(Method::kSetRoiSize);
    roi_ = centred;
}

void Device::begin_set_roi_centre(std::uint8_t spad) {
    if (!written_roi_) return begin_refused();
    begin_set_zone({.centre_spad = spad, .width = written_roi_->width, .height = written_roi_->height});
}

void Device::begin_set_zone(const Roi& roi) {
    if (!is_supported(roi)) return begin_refused();
    begin(Method::kSetZone);
    roi_ = roi;
}

void Device::begin_start() {
    begin(Method::kStart);
    mode_start_ = Method::kStartTimed;
}

void Device::begin_start_single() {
    begin(Method::kStart);
    mode_start_ = Method::kStartSingle;
}

void Device::begin_stop() {
    begin(Method::kStop);
}

void Device::begin_abort() {
    begin(Method::kAbort);
}

void Device::begin_read(bool confirms_ready) {
    begin(Method::kRead);
    is_confirming_ready_ = confirms_ready;
    have_polls_disagreed_ = false;
    has_measurement_ = false;
    has_read_again_ = false;
}

void Device::begin_update_temperature() {
    begin(Method::kUpdateTemperature);
}

void Device::begin_verify(std::size_t run) {
    assert(run < kRegisterRuns.size());
    begin(Method::kVerify);
    run_ = kRegisterRuns[run];
    is_run_steering_ = run < kSteeringGroups;
    is_run_of_write_ = false;
}

void Device::begin_verify_zone() {
    begin(Method::kVerify);
    run_ = kZoneRun;
    is_run_steering_ = false;
    is_run_of_write_ = true;
}

void Device::begin_read_register(reg::Index index, std::uint8_t count) {
    assert(count >= 1 && count <= register_bytes_.size());
    begin(Method::kReadRegister);
    register_index_ = index;
    register_bytes_wanted_ = count;
}

}  // namespace octoskin::vl53l1x
