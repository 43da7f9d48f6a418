// FDCAN's transmit side: requests, their order, the frame offered to the bus, the end of each.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/fdcan.hpp"
#include "hw/sim/stm32g474/peripherals/fdcan_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace fdcan;

namespace {

std::uint32_t frame_bits(const wire::CanFrame& frame) {
    const wire::FrameBits bits = frame.is_fd ? wire::worst_case_bits_fd(frame.payload_len)
                                             : wire::worst_case_bits_classical(frame.payload_len);
    return static_cast<std::uint32_t>(bits.nominal + bits.data);
}

}  // namespace

void Fdcan::request(std::uint32_t places) {
    for (std::uint32_t place = 0; place < kPlaces; ++place) {
        if ((places >> place & 1U) == 0) continue;
        if (is_set(kCccr, kMonitoring))
            env_.log.report(Rule::wrong_state, "FDCAN1.TXBAR written while only monitoring");
        if ((bank_.get(kCccr) & kInit) != 0)
            env_.log.report(Rule::wrong_state, "FDCAN1.TXBAR written while INIT=1");
        if ((pending_ >> place & 1U) != 0) {
            env_.log.report(Rule::data_lost, fmt::format("FDCAN1: buffer {} requested while pending", place));
            continue;
        }
        const bool is_fifo = (bank_.get(kTxbc) >> 24U & 1U) == 0;
        if (is_fifo && place != put_)
            env_.log.report(Rule::wrong_state,
                            fmt::format("FDCAN1: buffer {} requested, the put index is {}", place, put_));
        const wire::CanFrame frame = ram_.tx_element(place).frame;
        if (!is_fifo) check_order(frame);
        if ((frame.is_fd && !is_set(kCccr, kFdEnable)) ||
            (frame.has_bit_rate_switch && !is_set(kCccr, kRateSwitchEnable)))
            env_.log.report(Rule::wrong_state, "FDCAN1: an FD frame without FDOE, or BRS without BRSE");
        pending_ |= 1U << place;
        order_.push_back(place);
        bank_.clear_bits(kTxbto, 1U << place);
        bank_.clear_bits(kTxbcf, 1U << place);
        put_ = (place + 1) % kPlaces;
    }
    update_offer();
}

/// Of two frames with one identifier, the one in the lower buffer goes first, independent of the order of
/// requests.
void Fdcan::check_order(const wire::CanFrame& requested) {
    const auto has_its_identifier = [&](std::uint32_t place) {
        const wire::CanFrame frame = ram_.tx_element(place).frame;
        return frame.can_id == requested.can_id && frame.is_extended == requested.is_extended;
    };
    if (std::ranges::any_of(order_, has_its_identifier))
        env_.log.report(
            Rule::wrong_state,
            fmt::format("FDCAN1: two frames of identifier 0x{:X} in the queue: which goes first is "
                        "not the program's choice",
                        requested.can_id));
}

void Fdcan::cancel(std::uint32_t places) {
    for (std::uint32_t place = 0; place < kPlaces; ++place) {
        if ((places & pending_ & 1U << place) == 0) continue;
        if (has_started_ && offered_ == place) {
            cancelling_ |= 1U << place;  // decided when the frame ends
        } else {
            finish(place, false);
        }
    }
    update_offer();
}

std::optional<std::uint32_t> Fdcan::next_place() const {
    if (order_.empty()) return std::nullopt;
    if ((bank_.get(kTxbc) >> 24U & 1U) == 0) return order_.front();
    const auto rank = [this](std::uint32_t place) {
        const wire::CanFrame frame = ram_.tx_element(place).frame;
        return std::pair(frame.is_extended ? frame.can_id : frame.can_id << 18U, place);
    };
    return *std::ranges::min_element(order_, {}, rank);
}

void Fdcan::update_offer() {
    if (has_started_ && is_on_bus()) return;
    has_started_ = false;
    const bool is_good = link_ == CanLink::good && !has_wrong_timing_;
    const bool is_mute = !is_on_bus() || is_set(kCccr, kMonitoring) || is_set(kCccr, kRestricted);
    const std::optional<std::uint32_t> next = is_mute ? std::nullopt : next_place();
    offered_ = next;
    bus_.offer(next && is_good ? std::optional(ram_.tx_element(*next).frame) : std::nullopt);
    if (!next || is_good) {
        attempt_fails_at_ = kNever;
    } else if (attempt_fails_at_ == kNever) {
        const bool is_broken = link_ == CanLink::broken || has_wrong_timing_;
        const std::uint32_t bits =
            is_broken ? kBrokenAttemptBits : frame_bits(ram_.tx_element(*next).frame) + kErrorFrameBits;
        attempt_fails_at_ = env_.now + bits_ps(bits);
    }
}

void Fdcan::set_link(CanLink link) {
    link_ = link;
    attempt_fails_at_ = kNever;
    update_offer();
}

std::optional<std::uint32_t> Fdcan::place_of(const wire::CanFrame& frame) const {
    const auto found = std::ranges::find_if(
        order_, [&](std::uint32_t place) { return ram_.tx_element(place).frame == frame; });
    return found == order_.end() ? std::nullopt : std::optional(*found);
}

void Fdcan::on_started(const wire::CanFrame& frame) {
    const auto place = place_of(frame);
    if (!place) return;
    offered_ = place;
    has_started_ = true;
}

void Fdcan::on_sent(const wire::CanFrame& frame) {
    has_started_ = false;
    if (const auto place = place_of(frame)) {
        count_errors(-1, 0);
        last_error_ = 0;
        finish(*place, true);
    }
    update_offer();
    update_lines();
}

void Fdcan::finish(std::uint32_t place, bool is_sent) {
    const std::uint32_t bit = 1U << place;
    const bool was_cancelled = !is_sent || (cancelling_ & bit) != 0;
    pending_ &= ~bit;
    cancelling_ &= ~bit;
    std::erase(order_, place);
    if (is_sent) {
        bank_.set_bits(kTxbto, bit);
        if ((bank_.get(kTxbtie) & bit) != 0) raise(kTransmitted);
        const FdcanRam::TxElement sent = ram_.tx_element(place);
        if (sent.stores_event && events_.fill == kPlaces) {
            events_.has_lost = true;
            raise(kEventLost);
        } else if (sent.stores_event) {
            ram_.store_event(events_.put, sent, timestamp());
            events_.put = (events_.put + 1) % kPlaces;
            ++events_.fill;
            raise(kNewEvent);
        }
    }
    if (was_cancelled) {
        bank_.set_bits(kTxbcf, bit);
        if ((bank_.get(kTxbcie) & bit) != 0) raise(kCancelled);
    }
    if (pending_ == 0) raise(kTxFifoEmpty);
}

std::uint32_t Fdcan::event_status() const {
    return rx_status(events_);
}

std::uint32_t Fdcan::tx_status() const {
    const bool is_queue = (bank_.get(kTxbc) >> 24U & 1U) != 0;
    std::uint32_t put = put_;
    if (is_queue) {
        for (put = 0; put + 1 < kPlaces && (pending_ >> put & 1U) != 0;) ++put;
    }
    std::uint32_t free = 0;
    while (free < kPlaces && (pending_ >> ((put + free) % kPlaces) & 1U) == 0) ++free;
    const bool is_full = is_queue ? pending_ == 7 : free == 0;
    const std::uint32_t get = order_.empty() ? put : order_.front();
    return (is_queue ? 0 : free | get << 8U) | put << 16U | (is_full ? 1U << 21 : 0U);
}

}  // namespace octoskin::sim::stm32
