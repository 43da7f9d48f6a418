#include "firmware/core/bring_up.hpp"

#include <cassert>
#include <utility>

#include "firmware/core/sensor_fault.hpp"

namespace octoskin::node {

namespace {

// One at 0x29 and one at the sensor's own address. A device that reappears after that cannot be parked.
constexpr std::uint8_t kParkingsMax = 2;

}  // namespace

BringUp::BringUp(vl53l1x::Device& device, DefaultAddress& default_address, XshutLines& xshut,
                 const SensorConfig& config, const Policy& policy) noexcept
    : device_(device), default_address_(default_address), xshut_(xshut), config_(config), policy_(policy) {}

void BringUp::begin(NodeTime now) {
    hold_in_reset();
    outcome_ = Outcome::under_way;
    fault_ = wire::SensorFault::none;
    has_answered_ = false;
    parkings_ = 0;
    step_ = Step::held_low;
    step_due_ = now + policy_.xshut_low;
}

void BringUp::hold_in_reset() {
    assert(!device_.is_busy());
    xshut_.set(config_.xshut_line, false);
    default_address_.release(this);
    step_ = Step::idle;
}

std::optional<NodeTime> BringUp::due() const noexcept {
    switch (step_) {
        case Step::idle:
            return std::nullopt;
        case Step::held_low:
            return default_address_.is_free() ? std::optional(step_due_) : std::nullopt;
        case Step::checking_silence:
        case Step::checking_own_address:
        case Step::parking:
        case Step::checking_parked:
        case Step::booting:
        case Step::awaiting_boot:
        case Step::identifying:
        case Step::addressing:
        case Step::confirming_silence:
        case Step::initialising:
        case Step::collecting:
        case Step::configuring:
        case Step::verifying:
            return step_due_;
    }
    return std::nullopt;
}

bool BringUp::is_watching() const noexcept {
    return step_ == Step::checking_silence || step_ == Step::checking_own_address ||
           step_ == Step::checking_parked || step_ == Step::confirming_silence;
}

vl53l1x::Device& BringUp::active_device() noexcept {
    return is_watching() || step_ == Step::parking ? default_address_.watcher() : device_;
}

BusUse BringUp::advance(NodeTime now) {
    if (step_ == Step::held_low) {
        default_address_.hold(this);
        start_step(Step::checking_silence, now);
    } else if (step_ == Step::booting) {
        start_step(Step::awaiting_boot, now);
    }

    vl53l1x::Device& device = active_device();
    switch (device.poll(now)) {
        case vl53l1x::Progress::busy:
            if (const auto wake = device.wake_time(); wake && !is_reached(*wake, now)) {
                step_due_ = *wake;
                return BusUse::releases;
            }
            return BusUse::keeps;
        case vl53l1x::Progress::done:
            on_step_done(now);
            break;
        case vl53l1x::Progress::failed:
            on_step_failed(device.error(), now);
            break;
        case vl53l1x::Progress::idle:
            assert(false && "an operation is begun before it is polled");
            break;
    }
    // Between two steps the other sensors of the bus can take their turn.
    return BusUse::releases;
}

void BringUp::start_step(Step step, NodeTime now) {
    step_ = step;
    step_due_ = now;
    switch (step) {
        case Step::checking_silence:
        case Step::confirming_silence:
            default_address_.watcher().begin_probe(vl53l1x::kDefaultAddress);
            break;
        case Step::checking_own_address:
            default_address_.watcher().begin_probe(config_.address);
            break;
        case Step::parking:
            default_address_.watcher().begin_set_address(default_address_.parking());
            break;
        case Step::checking_parked:
            default_address_.watcher().begin_probe(default_address_.parking());
            break;
        case Step::booting:
            xshut_.set(config_.xshut_line, true);
            step_due_ = now + policy_.xshut_boot;
            break;
        case Step::awaiting_boot:
            device_.begin_await_boot_at_default(was_boot_late_);
            break;
        case Step::identifying:
            device_.begin_probe(vl53l1x::kDefaultAddress);
            break;
        case Step::addressing:
            device_.begin_set_address(config_.address);
            break;
        case Step::initialising:
            default_address_.release(this);
            device_.begin_initialise();
            break;
        case Step::collecting:
            device_.begin_finish_initialise();
            break;
        case Step::configuring:
            device_.begin_configure(config_);
            break;
        case Step::verifying:
            device_.begin_verify(run_);
            break;
        case Step::idle:
        case Step::held_low:
            break;
    }
}

void BringUp::on_step_done(NodeTime now) {
    switch (step_) {
        case Step::checking_silence:
        case Step::checking_own_address:
        case Step::checking_parked:
        case Step::confirming_silence:
            on_any_answer(now);
            break;
        case Step::parking:
            start_step(parked_from_, now);
            break;
        case Step::awaiting_boot:
            start_step(Step::identifying, now);
            break;
        case Step::identifying:
            has_answered_ = true;
            is_known_stuck_ = false;
            cleared_ = default_address_.parkings();
            start_step(Step::addressing, now);
            break;
        case Step::addressing:
            start_step(Step::confirming_silence, now);
            break;
        case Step::initialising:
            start_step(Step::collecting, now);
            step_due_ = now + policy_.first_range;
            break;
        case Step::collecting:
            start_step(Step::configuring, now);
            break;
        case Step::configuring:
            run_ = 0;
            is_mismatched_ = false;
            is_verified_anew_ = false;
            start_step(Step::verifying, now);
            break;
        case Step::verifying:
            on_run_verified(now);
            break;
        case Step::idle:
        case Step::held_low:
        case Step::booting:
            break;
    }
}

void BringUp::on_step_failed(vl53l1x::Error error, NodeTime now) {
    if (step_ == Step::verifying && error == vl53l1x::Error::config_mismatch) {
        is_mismatched_ = true;
        on_run_verified(now);
    } else if (step_ == Step::awaiting_boot && error == vl53l1x::Error::boot_timeout) {
        was_boot_late_ = true;
        start_step(Step::identifying, now);
    } else if (step_ == Step::identifying && error == vl53l1x::Error::no_answer) {
        on_no_answer();
    } else if (error == vl53l1x::Error::bus_error || !(is_watching() || step_ == Step::parking)) {
        fail(sensor_fault(error));
    } else if (error == vl53l1x::Error::no_answer && step_ != Step::parking) {
        on_silence(now);
    } else if (step_ == Step::checking_parked) {
        start_step(Step::booting, now);
    } else {
        // The device that answered is not a VL53L1X, does not answer like one, or does not let itself be
        // moved.
        fail(wire::SensorFault::address_conflict);
    }
}

/// Reads back one run of registers at a time, so that the other sensors of the bus need not wait for all of
/// them. All runs are read whatever the first one shows, so that each attempt sees every register that
/// differs.
void BringUp::on_run_verified(NodeTime now) {
    if (std::exchange(is_verified_anew_, false)) {
        run_ = 0;
        is_mismatched_ = false;
        start_step(Step::verifying, now);
    } else if (++run_ < vl53l1x::kRegisterRuns.size()) {
        start_step(Step::verifying, now);
    } else if (is_mismatched_) {
        fail(wire::SensorFault::config_mismatch);
    } else {
        outcome_ = Outcome::done;
        step_ = Step::idle;
    }
}

void BringUp::on_any_answer(NodeTime now) {
    if (step_ == Step::checking_parked) {
        start_step(Step::booting, now);
        return;
    }
    const bool is_own = step_ == Step::checking_own_address;
    if (step_ == Step::confirming_silence || parkings_ == kParkingsMax) {
        fail(is_own ? wire::SensorFault::xshut_stuck : wire::SensorFault::address_conflict);
        return;
    }
    ++parkings_;
    if (is_own) is_known_stuck_ = true;
    if (!is_own) default_address_.note_parked();
    parked_from_ = step_;
    start_step(Step::parking, now);
}

void BringUp::on_silence(NodeTime now) {
    const bool is_to_be_sought = is_known_stuck_ || default_address_.is_any_parked();
    switch (step_) {
        case Step::checking_silence:
            start_step(Step::checking_own_address, now);
            break;
        case Step::checking_own_address:
            start_step(is_to_be_sought ? Step::checking_parked : Step::booting, now);
            break;
        case Step::checking_parked:
            // The reset of this sensor, or of another, has returned the parked device to 0x29 and silenced
            // it.
            is_known_stuck_ = false;
            default_address_.forget_parked();
            start_step(Step::booting, now);
            break;
        case Step::confirming_silence:
            start_step(Step::initialising, now);
            break;
        case Step::idle:
        case Step::held_low:
        case Step::parking:
        case Step::booting:
        case Step::awaiting_boot:
        case Step::identifying:
        case Step::addressing:
        case Step::initialising:
        case Step::collecting:
        case Step::configuring:
        case Step::verifying:
            break;
    }
}

/// If the parked device is none of the sensors that came up since, it is this sensor: XSHUT has no effect on
/// it.
void BringUp::on_no_answer() {
    const bool is_suspect = default_address_.is_any_parked() && cleared_ != default_address_.parkings();
    fail(is_known_stuck_ || is_suspect ? wire::SensorFault::xshut_stuck : wire::SensorFault::no_answer);
}

void BringUp::fail(wire::SensorFault fault) {
    fault_ = fault;
    outcome_ = Outcome::failed;
    // Out of reset it could answer at 0x29 and be taken for its neighbour.
    hold_in_reset();
}

}  // namespace octoskin::node
