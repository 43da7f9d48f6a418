// FDCAN's fault confinement: failed attempts, error counters, bus-off.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/fdcan.hpp"
#include "hw/sim/stm32g474/peripherals/fdcan_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace fdcan;

void Fdcan::on_disturbed() {
    has_started_ = false;
    if (!is_on_bus()) return;
    last_error_ = kLastErrorBit0;
    raise(kArbitrationPhaseError);
    count_errors(8, 0);
    if (offered_ && (cancelling_ >> *offered_ & 1U) != 0) finish(*offered_, false);
    update_offer();
    update_lines();
}

void Fdcan::fail_attempt() {
    attempt_fails_at_ = kNever;
    const bool is_broken = link_ == CanLink::broken || has_wrong_timing_;
    last_error_ = is_broken ? kLastErrorBit0 : kLastErrorAcknowledge;
    raise(kArbitrationPhaseError);
    // An error-passive transmitter does not count a missing acknowledge.
    if (is_broken || transmit_errors_ < kPassiveLimit) count_errors(8, 0);
    update_offer();
}

void Fdcan::count_errors(int transmit, int receive) {
    const auto is_passive = [this] {
        return transmit_errors_ >= kPassiveLimit || receive_errors_ >= kPassiveLimit;
    };
    const auto is_warning = [this] {
        return transmit_errors_ >= kWarningLimit || receive_errors_ >= kWarningLimit;
    };
    const bool was_passive = is_passive();
    const bool was_warning = is_warning();
    transmit_errors_ = std::max(0, transmit_errors_ + transmit);
    // One good frame ends the error-passive state of the receive counter: ISO 11898-1 sets it to 119..127.
    const bool ends_passive = receive < 0 && receive_errors_ >= kPassiveLimit;
    receive_errors_ = ends_passive ? kPassiveLimit - 1 : std::max(0, receive_errors_ + receive);
    if (is_passive() != was_passive) raise(kErrorPassive);
    if (is_warning() != was_warning) raise(kErrorWarning);
    if (transmit_errors_ >= kBusOffLimit) enter_bus_off();
}

// The hardware sets INIT and does not return to the bus by itself.
void Fdcan::enter_bus_off() {
    is_bus_off_ = true;
    is_joined_ = false;
    has_started_ = false;
    bank_.set_bits(kCccr, kInit);
    init_follows_at_ = joins_at_ = attempt_fails_at_ = kNever;
    raise(kBusOff);
}

// RM0440 44.3.5: it still receives and acknowledges, but sends no more frames.
void Fdcan::lose_ram() {
    raise(kRamFailed);
    bank_.set_bits(kCccr, 1U << kRestricted);
    has_started_ = false;
    update_offer();
    update_lines();
}

std::uint32_t Fdcan::error_counters() const {
    const auto transmit = static_cast<std::uint32_t>(std::min(transmit_errors_, 255));
    const auto receive = static_cast<std::uint32_t>(std::min(receive_errors_, 127));
    return transmit | receive << 8U | (receive_errors_ >= kPassiveLimit ? 1U << 15 : 0U);
}

std::uint32_t Fdcan::read_protocol_status() {
    const bool is_passive = transmit_errors_ >= kPassiveLimit || receive_errors_ >= kPassiveLimit;
    const bool is_warning = transmit_errors_ >= kWarningLimit || receive_errors_ >= kWarningLimit;
    const std::uint32_t activity = !is_on_bus() ? 0U : has_started_ ? 3U : 1U;
    return std::exchange(last_error_, 7U) | activity << 3U | (is_passive ? 1U << 5 : 0U) |
           (is_warning ? 1U << 6 : 0U) | (is_bus_off_ ? 1U << 7 : 0U) | 7U << 8U;
}

}  // namespace octoskin::sim::stm32
