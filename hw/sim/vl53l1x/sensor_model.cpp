#include "hw/sim/vl53l1x/sensor_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin::sim {
namespace {

constexpr std::size_t kHistoryMax = 64;
constexpr Microseconds kSoftResetMin{100};  // full API: a shorter one does not count

bool is_read_only(std::uint16_t index) {
    const bool is_identification = index >= reg::kModelId && index <= reg::kModelId + 2U;
    const bool is_result = index >= reg::kResultInterruptStatus && index <= reg::kResultLast;
    return is_identification || is_result || index == reg::kSystemStatus;
}

/// -1 to 1; changes every eighth range.
double wander(std::uint32_t ranging_index) {
    const std::uint32_t mixed = (ranging_index / 8 + 1) * 2'654'435'769U;  // Knuth's multiplicative hash
    return static_cast<double>(mixed >> 16U) / 32'768.0 - 1.0;
}

/// 0 to 1; changes every range, without a pattern that a driver could follow.
double length_of(std::uint32_t ranging_index) {
    std::uint32_t mixed = (ranging_index + 1) * 2'654'435'769U;
    mixed = (mixed ^ (mixed >> 15U)) * 2'246'822'519U;  // xxHash's second prime
    return static_cast<double>((mixed ^ (mixed >> 13U)) >> 8U) / 16'777'216.0;
}

}  // namespace

SensorModel::SensorModel(const SensorPart& part, RangingScene scene)
    : part_(part), scene_(std::move(scene)) {}

void SensorModel::set_xshut(bool is_high, SimTime time) {
    advance(time);
    if (!is_high && !faults_.ignores_xshut) {
        power_ = Power::shut_down;
        ranging_.reset();
        faults_.holds_sda_clocks = 0;
    } else if (power_ == Power::shut_down) {
        boot(time);
    }
}

void SensorModel::brown_out(SimTime time) {
    advance(time);
    if (power_ != Power::shut_down) boot(time);
}

void SensorModel::boot(SimTime time) {
    load_registers();
    power_ = Power::booting;
    booted_at_ = {time.us + part_.boot_time.count()};
    is_loaded_ = false;
    index_bytes_ = 0;
}

void SensorModel::load_registers() {
    registers_ = reset_registers();
    write16(registers_, reg::kOscCalibrate, part_.osc_calibrate);
    registers_.at(reg::kRoiModeCentre) = part_.optical_centre_spad;
    if (faults_.has_wrong_id) registers_.at(reg::kModelId) = 0xEB;
    mode_ = Mode::idle;
    ranging_.reset();
    ranging_index_ = 0;
    stream_count_ = 0;
    is_interrupt_asserted_ = false;
    is_held_ = false;
}

void SensorModel::advance(SimTime time) {
    if (power_ == Power::booting && time >= booted_at_ && !faults_.never_boots) power_ = Power::running;
    if (power_ != Power::running) return;
    if (!is_loaded_ && time >= loaded_at()) {
        if (part_.traits.boot_load.count() > 0) load_registers();
        is_loaded_ = true;
    }
    const bool shows_two = !is_loaded_ || time.us < booted_at_.us + faults_.status_two_for.count();
    registers_.at(reg::kSystemStatus) = shows_two ? 0x02 : 0x03;
    while (ranging_ && time >= ranging_->start) {
        if (!ranging_->is_latched) latch_ranging();
        if (time < ranging_->window_end()) break;
        if (!ranging_->seen) look();
        if (time < ranging_->end()) break;
        finish_ranging();
    }
}

std::optional<SimTime> SensorModel::next_event(SimTime now) const {
    std::optional<SimTime> event;
    if (power_ == Power::booting) event = booted_at_;
    if (power_ == Power::running && !is_loaded_) return loaded_at();
    if (power_ == Power::running && ranging_)
        event = ranging_->is_latched ? ranging_->end() : ranging_->start;
    return event && *event > now ? event : std::nullopt;
}

// While shut down or booting the part does not acknowledge. A written address applies from the next START on.
bool SensorModel::on_start(std::uint8_t address, bool is_read, SimTime time) {
    advance(time);
    if (faults_.is_absent || (power_ != Power::running && power_ != Power::soft_reset)) return false;
    if (power_ == Power::soft_reset && is_read) return false;
    if (address != (registers_.at(reg::kI2cAddress) & 0x7FU)) return false;
    index_bytes_ = 0;  // of a write; a read continues at the present index
    return true;
}

bool SensorModel::on_write(std::uint8_t byte, SimTime time) {
    advance(time);
    if (index_bytes_ == 0) {
        index_ = static_cast<std::uint16_t>(byte << 8U);
        index_bytes_ = 1;
        return true;
    }
    if (index_bytes_ == 1) {
        index_ = static_cast<std::uint16_t>(index_ | byte);
        index_bytes_ = 2;
        return power_ == Power::running || index_ == reg::kSoftReset;
    }
    // In soft reset only the register that ends it is acknowledged.
    if (power_ == Power::soft_reset && index_ != reg::kSoftReset) return false;
    write_register(index_, byte, time);
    ++index_;
    return true;
}

std::uint8_t SensorModel::on_read(SimTime) {
    // A read is a snapshot at the time of its START.
    registers_.at(reg::kGpioStatus) =
        static_cast<std::uint8_t>((registers_.at(reg::kGpioStatus) & 0xFEU) | (pin_level() ? 1U : 0U));
    if (index_ == reg::kGpioStatus) ++poll_count_;
    std::uint8_t byte = index_ < registers_.size() ? registers_.at(index_) : std::uint8_t{0};
    for (const MisreadRegister& misread : part_.traits.misread) {
        if (misread.index == index_) byte = misread.read(byte);
    }
    ++index_;
    return byte;
}

void SensorModel::on_stop(SimTime) {}

bool SensorModel::holds_sda(SimTime time) {
    advance(time);
    return power_ != Power::shut_down && faults_.holds_sda_clocks > 0;
}

void SensorModel::on_clocks(std::uint32_t count, SimTime) {
    faults_.holds_sda_clocks -= std::min(faults_.holds_sda_clocks, count);
}

void SensorModel::write_register(std::uint16_t index, std::uint8_t value, SimTime time) {
    if (index >= registers_.size() || is_read_only(index)) return;
    if (faults_.stuck_register && faults_.stuck_register->index == index)
        value = faults_.stuck_register->value;
    switch (index) {
        case reg::kSoftReset:
            write_soft_reset(value, time);
            return;
        case reg::kGpioStatus: {
            const unsigned live = registers_.at(index) & 1U;
            registers_.at(index) = static_cast<std::uint8_t>((value & 0xFEU) | live);
            return;
        }
        case reg::kGroupedHold0:
        case reg::kGroupedHold1:
        case reg::kGroupedHold:
            registers_.at(index) = value;
            // Pololu's library: the first two set the hold, and only 0 in the last ends it.
            if (value != 0) is_held_ = true;
            if (value == 0 && index == reg::kGroupedHold) is_held_ = false;
            return;
        case reg::kInterruptClear:
            write_interrupt_clear(value, time);
            return;
        case reg::kModeStart:
            registers_.at(index) = value;
            start_mode(value, time);
            return;
        case reg::kInterMeasurement:
        case reg::kInterMeasurement + 1:
        case reg::kInterMeasurement + 2:
        case reg::kInterMeasurement + 3:
            if (ranging_ && value != registers_.at(index)) ++disturbance_count_;
            registers_.at(index) = value;
            return;
        default:
            registers_.at(index) = value;
            return;
    }
}

void SensorModel::write_soft_reset(std::uint8_t value, SimTime time) {
    if (value == 0) {
        power_ = Power::soft_reset;
        soft_reset_since_ = time;
        ranging_.reset();
        if (part_.forgets_address_as_soft_reset_begins) registers_.at(reg::kI2cAddress) = 0x29;
    } else if (power_ == Power::soft_reset && time.us - soft_reset_since_.us >= kSoftResetMin.count()) {
        boot(time);
    }
}

// The register itself reads as 0.
void SensorModel::write_interrupt_clear(std::uint8_t value, SimTime time) {
    if ((value & 1U) == 0) return;
    is_interrupt_asserted_ = faults_.is_always_ready;
    if (mode_ == Mode::waiting_for_clear) {
        mode_ = Mode::back_to_back;
        ranging_ = Ranging{.start = time};
    }
}

void SensorModel::start_mode(std::uint8_t value, SimTime time) {
    constexpr unsigned kSingle = 0x10;
    constexpr unsigned kBackToBack = 0x20;
    constexpr unsigned kTimed = 0x40;
    constexpr unsigned kAbort = 0x80;
    const unsigned bits = value;
    const bool is_stop = (bits & (kSingle | kBackToBack | kTimed | kAbort)) == 0;
    const bool is_under_way = ranging_ && ranging_->is_latched;
    if ((bits & kAbort) != 0) {
        if (is_under_way) ++disturbance_count_;
        mode_ = Mode::idle;
        ranging_.reset();
        return;
    }
    if (is_stop) {
        stops_after_this_ = true;  // UM2510 3.5.7: the running range is finished
        if (!ranging_ || ranging_->start > time) {
            ranging_.reset();
            mode_ = Mode::idle;
        }
        return;
    }
    if ((registers_.at(reg::kFirmwareEnable) & 1U) == 0) return;
    const Mode mode = (bits & kTimed) != 0    ? Mode::timed
                      : (bits & kSingle) != 0 ? Mode::single
                                              : Mode::back_to_back;
    // ST's full API (STSW-IMG007 2.3.3) writes the mode again with every clear and treats a stream count of 0
    // as the first range of a run. So the stream continues.
    const bool goes_on = mode == mode_ && !stops_after_this_;
    if (goes_on && !part_.is_restarted_by_start) return;
    if (is_under_way) ++disturbance_count_;
    if (!goes_on) is_first_of_run_ = true;
    stops_after_this_ = false;
    mode_ = mode;
    const RangingTiming timing = ranging_timing(registers_, part_);
    // The first timed result was observed one period after the start: about 103 ms at the defaults, where
    // period and budget are nearly equal, so that no slot is missed yet.
    const Microseconds wait =
        mode_ == Mode::timed ? timing.slot - timing.budget - timing.overhead : Microseconds{0};
    ranging_ = Ranging{.start = {time.us + std::max<std::int64_t>(wait.count(), 0)}};
}

// What is written during a range applies from the next one (UM2555 5).
void SensorModel::latch_ranging() {
    ranging_->is_latched = true;
    ranging_->timing = ranging_timing(registers_, part_);
    ranging_->config = ranging_config(registers_, part_.crosstalk_kcps);
}

/// The window is over: the return determines how much longer the ranging takes.
void SensorModel::look() {
    if (is_held_) return;
    Ranging& ranging = *ranging_;
    ranging.seen = scene_(ranging_index_, ranging.window_middle(), ranging.config.roi);
    const auto spread_us = static_cast<double>(part_.traits.range_spread.count());
    ranging.extra = Microseconds{std::llround(spread_us * length_of(ranging_index_))};
    if (ranging.seen->range_m) ranging.extra += part_.traits.range_step;
}

void SensorModel::finish_ranging() {
    const Ranging ranging = *ranging_;
    if (!ranging.seen) {
        schedule_next(ranging);
        return;
    }
    const SimTime middle = ranging.window_middle();
    const SimTime ready = ranging.end();
    const RangingReturn& seen = *ranging.seen;
    step_stream_count();
    const RangingResult result{
        .range_status = faults_.device_status.value_or(device_status(ranging.config, seen)),
        .stream_count = stream_count_,
        .range_mm = reported_range_mm(ranging.config, seen, ranging_index_)};
    write_result(registers_, ranging.config, seen, result);
    const bool fires = fires_interrupt(ranging.config, result) || faults_.is_always_ready;
    if (fires && !faults_.never_ready) is_interrupt_asserted_ = true;
    history_.push_back({ranging_index_, middle, ready, ranging.config.roi, result});
    if (history_.size() > kHistoryMax) history_.pop_front();
    ++ranging_index_;
    schedule_next(ranging);
}

void SensorModel::schedule_next(const Ranging& finished) {
    ranging_.reset();
    if (stops_after_this_ || mode_ == Mode::single) {
        mode_ = Mode::idle;
    } else if (mode_ == Mode::timed) {
        const double rate = 1.0 + part_.slow_clock_wander * wander(ranging_index_);
        const auto period = static_cast<double>(finished.timing.period.count()) / rate;
        SimTime start{finished.start.us + std::llround(period)};
        // A slot that is too early is missed.
        while (start < finished.end()) start.us += finished.timing.slot.count();
        ranging_ = Ranging{.start = start};
    } else {
        mode_ = Mode::waiting_for_clear;
    }
}

// 0 for the first range of a run, 1..255, then 128..255 again (UM2356).
void SensorModel::step_stream_count() {
    if (std::exchange(is_first_of_run_, false)) {
        stream_count_ = 0;
    } else if (!faults_.freezes_stream) {
        stream_count_ =
            stream_count_ == 255 ? std::uint8_t{128} : static_cast<std::uint8_t>(stream_count_ + 1U);
    }
}

bool SensorModel::pin_level() const {
    constexpr unsigned kInterruptFunction = 1;
    const unsigned control = registers_.at(reg::kGpioMux);
    const bool is_active_low = (control & 0x10U) != 0;
    const bool is_active = is_interrupt_asserted_ && (control & 0x0FU) == kInterruptFunction;
    return is_active != is_active_low;
}

bool SensorModel::gpio1_level(SimTime time) {
    advance(time);
    return power_ != Power::running || pin_level();  // open drain, pulled up
}

}  // namespace octoskin::sim
