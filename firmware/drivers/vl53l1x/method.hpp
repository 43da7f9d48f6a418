// The operations of the driver as tables of stages, in the order of ST's driver (ULD 3.5.2; UM2510). Private
// to the driver: read device.hpp first, then the tables at the end of this file.
#pragma once

#include <algorithm>

#include "firmware/drivers/vl53l1x/device.hpp"
#include "firmware/drivers/vl53l1x/roi.hpp"
#include "firmware/drivers/vl53l1x/timing.hpp"

namespace octoskin::vl53l1x {

struct Device::Method {
    // --- bring-up

    static void ask_boot_state(Device& d) { d.read(reg::FIRMWARE_SYSTEM_STATUS, 1, judge_boot_state); }
    static NextStep judge_boot_state(Device& d, NodeTime) {
        return (d.answer_[0] & 1U) != 0 ? NextStep::proceed : NextStep::repeat_stage;
    }

    static void ask_identity(Device& d) { d.read(reg::IDENTIFICATION_MODEL_ID, 2, judge_identity); }
    static NextStep judge_identity(Device& d, NodeTime) {
        constexpr std::uint16_t kModelAndModuleType = 0xEACC;  // DS12385 table 11; ST's header says 0xEEAC
        return d.answer16() == kModelAndModuleType ? NextStep::proceed : d.fail(Error::wrong_id);
    }

    // Until reset is released, the sensor may answer at its own address or at 0x29: no public document says
    // when the address is lost.
    static void enter_soft_reset(Device& d) {
        d.read_back_.forget();
        d.written_roi_.reset();
        d.not_ready_seen_.reset();
        d.write8(reg::SOFT_RESET, 0x00, [](Device& device, NodeTime now) {
            constexpr Microseconds kHeld{100};  // full API
            device.resume_at_ = now + kHeld;
            return NextStep::proceed;
        });
    }
    static void leave_soft_reset(Device& d) {
        d.line_up({.kind = Step::Kind::write,
                   .index = reg::SOFT_RESET,
                   .count = 1,
                   .bytes = {0x01},
                   .judge =
                       [](Device& device, NodeTime) {
                           device.live_address_ = kDefaultAddress;
                           return NextStep::proceed;
                       },
                   .on_refused =
                       [](Device& device, NodeTime) {
                           if (!device.was_retried_) {
                               device.was_retried_ = true;
                               return NextStep::proceed;
                           }
                           if (device.live_address_ == kDefaultAddress) return device.fail(Error::no_answer);
                           device.live_address_ = kDefaultAddress;
                           device.was_retried_ = false;
                           return NextStep::proceed;
                       }});
    }
    /// A booting sensor does not acknowledge.
    static void ask_boot_state_patiently(Device& d) {
        d.line_up({.index = reg::FIRMWARE_SYSTEM_STATUS,
                   .count = 1,
                   .judge = judge_boot_state,
                   .on_refused = [](Device&, NodeTime) { return NextStep::repeat_stage; }});
    }

    /// Ends at once if no device answers.
    static void ask_boot_state_of_any(Device& d) {
        d.line_up({.index = reg::FIRMWARE_SYSTEM_STATUS,
                   .count = 1,
                   .judge = judge_boot_state,
                   .on_refused = [](Device&, NodeTime) { return NextStep::end; }});
    }

    // The sensor uses its new address from the next START on.
    static void write_address(Device& d) {
        d.write8(reg::I2C_SLAVE_DEVICE_ADDRESS, d.new_address_, [](Device& device, NodeTime) {
            device.live_address_ = device.new_address_;
            return NextStep::proceed;
        });
    }
    static void verify_address(Device& d) {
        if (d.options_.verifies_address) ask_identity(d);
    }

    static void forget_registers(Device& d) { d.read_back_.forget(); }
    /// The factory offset is used unless the rig has one. It is read before the first write that a bus error
    /// could misdirect to its registers: a later read could return such a wrong value.
    static void learn_factory_offset(Device& d) {
        if (!d.options_.reads_factory_offset) return;
        d.read(kFactoryRun.first, kFactoryRun.count, [](Device& device, NodeTime) {
            device.read_back_.learn(kFactoryRun, device.answer_);
            device.read(kFactoryRun.first, kFactoryRun.count, compare_factory_offset);
            return NextStep::proceed;
        });
    }
    static NextStep compare_factory_offset(Device& d, NodeTime) {
        return d.read_back_.agrees(kFactoryRun, d.answer_) ? NextStep::proceed
                                                           : d.fail(Error::reads_disagree);
    }

    static void write_default_configuration(Device& d) {
        constexpr auto kCount = static_cast<std::uint8_t>(kDefaultConfiguration.size());
        const bool in_burst = d.options_.writes_config_in_burst;
        d.line_up({.kind = Step::Kind::write_defaults,
                   .index = kDefaultConfigurationFirst,
                   .count = in_burst ? kCount : std::uint8_t{1},
                   .transfers = in_burst ? std::uint8_t{1} : kCount,
                   .judge = [](Device& device, NodeTime) {
                       device.mode_ = DistanceMode::long_range;
                       device.budget_ms_ = 100;
                       device.written_roi_ = Roi{};
                       device.is_active_low_ = device.options_.is_interrupt_active_low;
                       return NextStep::proceed;
                   }});
    }

    // VHV: the bias voltage of the SPADs. The search for it is either limited to two loops from the last
    // value found, or complete.
    static void bound_vhv_search(Device& d) {
        d.write8(reg::VHV_CONFIG_TIMEOUT_MACROP_LOOP_BOUND, 0x09);
        d.write8(reg::VHV_CONFIG_INIT, 0x00);
    }
    static void allow_full_vhv_search(Device& d) {
        d.write8(reg::VHV_CONFIG_TIMEOUT_MACROP_LOOP_BOUND, 0x81);
        d.write8(reg::VHV_CONFIG_INIT, 0x92);
    }

    // --- mode, budget, period

    static void reread_budget(Device& d) {
        if (!d.options_.rereads_settings) return;
        d.read(reg::RANGE_CONFIG_TIMEOUT_MACROP_A, 2, [](Device& device, NodeTime) {
            const auto budget_ms = budget_of_timeout_a(device.answer16());
            if (!budget_ms) return device.fail(Error::config_mismatch);
            device.budget_ms_ = *budget_ms;
            return NextStep::proceed;
        });
    }
    static void reread_mode(Device& d) {
        if (!d.options_.rereads_settings) return;
        d.read(reg::PHASECAL_CONFIG_TIMEOUT_MACROP, 1, [](Device& device, NodeTime) {
            const auto mode = marked_mode(device.answer_[0]);
            if (!mode) return device.fail(Error::config_mismatch);
            device.mode_ = *mode;
            return NextStep::proceed;
        });
    }

    static void write_mode(Device& d) {
        const ModeRegisters& mode = mode_registers(d.settings_.distance_mode);
        d.write8(reg::PHASECAL_CONFIG_TIMEOUT_MACROP, mode.phasecal_timeout);
        d.write8(reg::RANGE_CONFIG_VCSEL_PERIOD_A, mode.vcsel_period_a);
        d.write8(reg::RANGE_CONFIG_VCSEL_PERIOD_B, mode.vcsel_period_b);
        d.write8(reg::RANGE_CONFIG_VALID_PHASE_HIGH, mode.valid_phase_high);
        d.write16(reg::SD_CONFIG_WOI_SD0, mode.woi);
        d.write16(reg::SD_CONFIG_INITIAL_PHASE_SD0, mode.initial_phase, [](Device& device, NodeTime) {
            device.mode_ = device.settings_.distance_mode;
            return NextStep::proceed;
        });
    }
    /// Fails if the new mode does not support the current budget.
    static void check_budget(Device& d) {
        if (!range_timeouts(d.settings_.distance_mode, d.budget_ms_)) d.fail(Error::unsupported_config);
    }
    static void write_timeouts(Device& d, std::uint16_t budget_ms, Judge judge) {
        const auto timeouts = range_timeouts(d.mode_, budget_ms);
        if (!timeouts) {
            d.fail(Error::unsupported_config);
            return;
        }
        d.write16(reg::RANGE_CONFIG_TIMEOUT_MACROP_A, timeouts->a);
        d.write16(reg::RANGE_CONFIG_TIMEOUT_MACROP_B, timeouts->b, judge);
    }
    static void write_same_budget(Device& d) { write_timeouts(d, d.budget_ms_, nullptr); }
    static void write_new_budget(Device& d) {
        write_timeouts(d, d.settings_.timing_budget_ms, [](Device& device, NodeTime) {
            device.budget_ms_ = device.settings_.timing_budget_ms;
            return NextStep::proceed;
        });
    }
    /// ST's mode setter applies the old budget to the new mode. Only needed to match ST's transfers, since
    /// the new budget follows.
    static void write_same_budget_as_st(Device& d) {
        if (d.options_.rereads_settings) write_same_budget(d);
    }

    /// Read twice: a wrong value would set a wrong period that the read-back cannot detect.
    static void ask_oscillator(Device& d) {
        d.read(reg::RESULT_OSC_CALIBRATE_VAL, 2, [](Device& device, NodeTime) {
            device.oscillator_ = device.answer16();
            if (!device.options_.reads_twice) return write_period(device);
            device.read(reg::RESULT_OSC_CALIBRATE_VAL, 2, compare_oscillator);
            return NextStep::proceed;
        });
    }
    static NextStep compare_oscillator(Device& d, NodeTime) {
        return d.answer16() == d.oscillator_ ? write_period(d) : d.fail(Error::reads_disagree);
    }
    static NextStep write_period(Device& d) {
        const auto value = period_register(d.oscillator_, d.period_);
        if (!value) return d.fail(Error::oscillator_zero);
        d.write32(reg::SYSTEM_INTERMEASUREMENT_PERIOD, *value);
        return NextStep::proceed;
    }

    // --- region of interest

    static void write_roi(Device& d) {
        const bool is_size_new = !d.written_roi_ || d.written_roi_->width != d.roi_.width ||
                                 d.written_roi_->height != d.roi_.height;
        d.written_roi_.reset();  // unknown until the write is acknowledged
        const std::uint8_t size = size_register(d.roi_);
        if (!is_size_new) {
            d.write8(reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, d.roi_.centre_spad, note_roi);
        } else if (d.options_.writes_config_in_burst) {
            const auto centre_and_size = static_cast<std::uint16_t>((d.roi_.centre_spad << 8U) | size);
            d.write16(reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, centre_and_size, note_roi);
        } else {
            d.write8(reg::ROI_CONFIG_USER_ROI_REQUESTED_GLOBAL_XY_SIZE, size);
            d.write8(reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, d.roi_.centre_spad, note_roi);
        }
    }
    static NextStep note_roi(Device& d, NodeTime) {
        d.written_roi_ = d.roi_;
        return NextStep::proceed;
    }

    /// ST's SetROI, which also moves the centre.
    static void write_roi_size(Device& d) {
        d.written_roi_.reset();
        d.read(reg::ROI_CONFIG_MODE_ROI_CENTRE_SPAD, 1, [](Device& device, NodeTime) {
            constexpr std::uint8_t kArrayCentre = 199;
            const bool is_large = device.roi_.width > 10 || device.roi_.height > 10;
            device.write8(reg::ROI_CONFIG_USER_ROI_CENTRE_SPAD, is_large ? kArrayCentre : device.answer_[0]);
            device.write8(reg::ROI_CONFIG_USER_ROI_REQUESTED_GLOBAL_XY_SIZE, size_register(device.roi_),
                          note_roi);
            return NextStep::proceed;
        });
    }
    static void write_roi_size_as_st(Device& d) {
        if (d.options_.rereads_settings) write_roi_size(d);
    }

    // --- limits, offset, crosstalk, interrupt

    static void write_sigma_limit(Device& d) {
        d.write16(reg::RANGE_CONFIG_SIGMA_THRESH, d.settings_.sigma_limit_quarter_mm);
    }
    static void write_signal_limit(Device& d) {
        d.write16(reg::RANGE_CONFIG_MIN_COUNT_RATE_RTN_LIMIT_MCPS, d.settings_.signal_limit_raw);
    }
    static void write_offset(Device& d) {
        if (!d.settings_.has_offset) return;
        d.write16(reg::ALGO_PART_TO_PART_RANGE_OFFSET_MM,
                  static_cast<std::uint16_t>(d.settings_.offset_quarter_mm));
        d.write16(reg::MM_CONFIG_INNER_OFFSET_MM, 0);
        d.write16(reg::MM_CONFIG_OUTER_OFFSET_MM, 0);
    }
    static void write_crosstalk(Device& d) {
        d.write16(reg::ALGO_CROSSTALK_COMPENSATION_X_PLANE_GRADIENT_KCPS, 0);
        d.write16(reg::ALGO_CROSSTALK_COMPENSATION_Y_PLANE_GRADIENT_KCPS, 0);
        d.write16(reg::ALGO_CROSSTALK_COMPENSATION_PLANE_OFFSET_KCPS, d.settings_.crosstalk_raw);
    }

    static void write_polarity(Device& d) {
        if (!d.options_.caches_polarity) d.read(reg::GPIO_HV_MUX_CTRL, 1, nullptr);
        d.write8(reg::GPIO_HV_MUX_CTRL, interrupt_pin_control(d.is_polarity_low_),
                 [](Device& device, NodeTime) {
                     device.is_active_low_ = device.is_polarity_low_;
                     return NextStep::proceed;
                 });
    }

    static constexpr std::uint8_t kOnEverySample = 0x20;
    static constexpr std::uint8_t kWithoutTargetToo = 0x40;
    static void write_every_sample(Device& d) { d.write8(reg::SYSTEM_INTERRUPT_CONFIG_GPIO, kOnEverySample); }

    // ST's driver keeps the bits of the old window, so two windows merge into a third. Here the new window
    // replaces the old one.
    static void write_range_threshold(Device& d) {
        if (d.options_.rereads_settings) d.read(reg::SYSTEM_INTERRUPT_CONFIG_GPIO, 1, nullptr);
        const unsigned without_target = d.threshold_.fires_without_target ? kWithoutTargetToo : 0U;
        d.write8(reg::SYSTEM_INTERRUPT_CONFIG_GPIO,
                 static_cast<std::uint8_t>(static_cast<unsigned>(d.threshold_.window) | without_target));
        d.write16(reg::SYSTEM_THRESH_HIGH, d.threshold_.high_mm);
        d.write16(reg::SYSTEM_THRESH_LOW, d.threshold_.low_mm);
    }

    // --- start, ready, result, stop

    static constexpr std::uint8_t kStartTimed = 0x40;
    static constexpr std::uint8_t kStartSingle = 0x10;

    static void clear_before_start(Device& d) {
        d.not_ready_seen_.reset();
        if (d.options_.clears_before_start) clear(d);
    }
    static void start(Device& d) { d.write8(reg::SYSTEM_MODE_START, d.mode_start_); }
    static void choose_timed(Device& d) { d.mode_start_ = kStartTimed; }
    static void stop(Device& d) { d.write8(reg::SYSTEM_MODE_START, 0x00); }
    static void abort(Device& d) { d.write8(reg::SYSTEM_MODE_START, 0x80); }

    static void ask_polarity(Device& d) {
        if (d.options_.caches_polarity) return;
        d.read(reg::GPIO_HV_MUX_CTRL, 1, [](Device& device, NodeTime) {
            device.is_active_low_ = (device.answer_[0] & 0x10U) != 0;
            return NextStep::proceed;
        });
    }
    static bool is_ready(const Device& d) {
        const bool is_pin_high = (d.answer_[0] & 1U) != 0;
        return is_pin_high != d.is_active_low_;
    }
    static void await_ready(Device& d) {
        ask_polarity(d);
        d.read(reg::GPIO_TIO_HV_STATUS, 1, [](Device& device, NodeTime) {
            return is_ready(device) ? NextStep::proceed : NextStep::repeat_stage;
        });
    }
    static void ask_ready(Device& d) {
        ask_polarity(d);
        d.read(reg::GPIO_TIO_HV_STATUS, 1, [](Device& device, NodeTime now) {
            if (!is_ready(device)) return end_without_data(device);
            device.ready_seen_ = now;
            if (device.is_confirming_ready_) device.read(reg::GPIO_TIO_HV_STATUS, 1, confirm_ready);
            return NextStep::proceed;
        });
    }
    /// If the first answer was altered on the bus, the data may have become ready after it. So if the second
    /// poll is much later, its time is used.
    static NextStep confirm_ready(Device& d, NodeTime now) {
        constexpr Microseconds kAtOnce{300};
        d.is_confirming_ready_ = false;
        if (elapsed(d.ready_seen_, now) > kAtOnce) d.ready_seen_ = now;
        if (is_ready(d)) return NextStep::proceed;
        d.have_polls_disagreed_ = true;
        d.count_i2c_error();
        return end_without_data(d);
    }
    static NextStep end_without_data(Device& d) {
        d.not_ready_seen_ = d.submitted_;
        return NextStep::end;
    }

    // I2C has no checksum: a result is accepted if two reads of it agree.
    static void read_result(Device& d) {
        d.read(reg::RESULT_RANGE_STATUS, ResultBlock{}.size(), [](Device& device, NodeTime) {
            device.block_ = device.answered_block();
            return device.options_.reads_twice ? NextStep::proceed : judge_result(device);
        });
        if (d.options_.reads_twice) d.read(reg::RESULT_RANGE_STATUS, ResultBlock{}.size(), compare_result);
    }
    static NextStep compare_result(Device& d, NodeTime) {
        if (d.answered_block() == d.block_) return judge_result(d);
        // A new result between the two reads is no error, but it can happen once per period only.
        const bool has_moved = d.answer_[kStreamCountOffset] != d.block_[kStreamCountOffset];
        if (!has_moved || d.has_read_again_) return d.fail(Error::reads_disagree);
        d.has_read_again_ = true;
        return NextStep::repeat_stage;
    }
    static NextStep judge_result(Device& d) {
        return is_plausible(d.block_) ? NextStep::proceed : d.fail(Error::implausible_block);
    }

    static void clear(Device& d) {
        d.write8(reg::SYSTEM_INTERRUPT_CLEAR, 0x01, [](Device& device, NodeTime) {
            device.not_ready_seen_ = device.submitted_;
            return NextStep::proceed;
        });
    }
    /// The last step of a read: the measurement is published only after the clear succeeded.
    static void clear_and_publish(Device& d) {
        d.write8(reg::SYSTEM_INTERRUPT_CLEAR, 0x01, [](Device& device, NodeTime) {
            device.reading_ = {.measurement = unpack(device.block_, device.settings_.applies_gain_factor),
                               .ready_seen = device.ready_seen_,
                               .not_ready_seen = device.not_ready_seen_};
            device.has_measurement_ = true;
            device.not_ready_seen_ = device.submitted_;
            return NextStep::proceed;
        });
    }

    static void read_bytes(Device& d) {
        d.read(d.register_index_, d.register_bytes_wanted_, [](Device& device, NodeTime) {
            device.register_count_ = device.register_bytes_wanted_;
            std::copy_n(device.answer_.begin(), device.register_count_, device.register_bytes_.begin());
            return NextStep::proceed;
        });
    }

    // --- supervision

    static void verify_run(Device& d) {
        if (!d.options_.verification->is_on()) return;
        const RegisterRun& run = d.run_;
        d.read(run.first, run.count, judge_run);
    }
    static NextStep judge_run(Device& d, NodeTime) {
        const RegisterRun& run = d.run_;
        if (d.read_back_.agrees(run, d.answer_)) {
            d.read_back_.learn(run, d.answer_);
            if (d.is_run_steering_) d.read_back_.on_clean_check();
        } else {
            d.read(run.first, run.count, judge_run_again);
        }
        return NextStep::proceed;
    }
    /// The second read distinguishes a bit flipped on the bus from a wrong register.
    static NextStep judge_run_again(Device& d, NodeTime) {
        const RegisterRun& run = d.run_;
        if (d.read_back_.agrees(run, d.answer_)) {
            d.count_i2c_error();
        } else if (d.is_run_of_write_ ? d.read_back_.record_of_write(run, d.answer_)
                                      : d.read_back_.record(run, d.answer_)) {
            return d.fail(Error::config_mismatch);
        }
        return NextStep::proceed;
    }

    // --- the stages that wait

    static constexpr Stage kAwaitBoot{ask_boot_state, 1'000, 500'000, Error::boot_timeout};
    // Ranges take tens of milliseconds: polling every 5 ms leaves the bus free.
    static constexpr Stage kAwaitReady{await_ready, 5'000, 1'000'000, Error::not_ready};
    // Polled every 1 ms, so that the stop falls into the pause after the first range (5 ms at the defaults).
    // The sensor then does not range while it is configured.
    static constexpr Stage kAwaitFirst{await_ready, 1'000, 1'000'000, Error::not_ready};
    static constexpr Stage kReadResult{read_result, 0, 50'000, Error::reads_disagree};

    // --- the operations

    static constexpr Stage kProbe[]{{ask_identity}};
    static constexpr Stage kSetAddress[]{{write_address}, {verify_address}};
    static constexpr Stage kSoftReset[]{{enter_soft_reset},
                                        {leave_soft_reset},
                                        {ask_boot_state_patiently, 1'000, 500'000, Error::boot_timeout},
                                        {ask_identity}};
    // Real sensors may answer before bit 0 is set; it is set a few milliseconds later (ST community, posts on
    // register 0xE5). The boot may overwrite what was written to such a sensor.
    static constexpr Stage kAwaitBootAtDefault[]{{ask_boot_state_of_any, 500, 5'000, Error::boot_timeout}};
    static constexpr Stage kAwaitBootAtDefaultPatiently[]{
        {ask_boot_state_of_any, 500, 100'000, Error::boot_timeout}};  // the limit of Linux's driver
    static constexpr Stage kAwaitBootOnly[]{kAwaitBoot};
    static constexpr Stage kLoadConfiguration[]{
        {forget_registers}, {write_default_configuration}, {choose_timed}, {clear_before_start}, {start}};
    static constexpr Stage kInitialise[]{kAwaitBoot,
                                         {forget_registers},
                                         {learn_factory_offset},
                                         {write_default_configuration},
                                         {choose_timed},
                                         {clear_before_start},
                                         {start}};
    static constexpr Stage kFinishInitialise[]{kAwaitFirst, {clear}, {stop}, {bound_vhv_search}};
    // Stops again. If the first stop was lost, the sensor would still range with the defaults, and it is not
    // documented whether a start then restarts it.
    static constexpr Stage kConfigure[]{
        // clang-format off
        {stop},
        {reread_budget}, {write_mode}, {reread_mode}, {write_same_budget_as_st},
        {reread_mode}, {write_new_budget},
        {ask_oscillator},
        {write_roi_size_as_st}, {write_roi},
        {write_sigma_limit}, {write_signal_limit},
        {write_offset},
        {write_crosstalk},
        // clang-format on
    };
    static constexpr Stage kSetDistanceMode[]{
        {reread_budget}, {check_budget}, {write_mode}, {reread_mode}, {write_same_budget}};
    static constexpr Stage kSetTimingBudget[]{{reread_mode}, {write_new_budget}};
    static constexpr Stage kSetInterMeasurement[]{{ask_oscillator}};
    static constexpr Stage kSetSigmaLimit[]{{write_sigma_limit}};
    static constexpr Stage kSetSignalLimit[]{{write_signal_limit}};
    static constexpr Stage kSetOffset[]{{write_offset}};
    static constexpr Stage kSetCrosstalk[]{{write_crosstalk}};
    static constexpr Stage kSetPolarity[]{{write_polarity}};
    static constexpr Stage kSetRangeThreshold[]{{write_range_threshold}};
    static constexpr Stage kSetEverySample[]{{write_every_sample}};
    static constexpr Stage kSetRoiSize[]{{write_roi_size}};
    static constexpr Stage kSetZone[]{{write_roi}};
    static constexpr Stage kStart[]{{clear_before_start}, {start}};
    static constexpr Stage kStop[]{{stop}};
    static constexpr Stage kAbort[]{{abort}};
    static constexpr Stage kRead[]{{ask_ready}, kReadResult, {clear_and_publish}};
    static constexpr Stage kUpdateTemperature[]{
        {allow_full_vhv_search}, {choose_timed}, {clear_before_start}, {start}, kAwaitReady, {clear}, {stop},
        {bound_vhv_search}};
    static constexpr Stage kVerify[]{{verify_run}};
    static constexpr Stage kReadRegister[]{{read_bytes}};
};

}  // namespace octoskin::vl53l1x
