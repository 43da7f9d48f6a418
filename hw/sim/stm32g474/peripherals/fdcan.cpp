#include "hw/sim/stm32g474/peripherals/fdcan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kDbtp = 0x0C;
constexpr std::uint32_t kTest = 0x10;
constexpr std::uint32_t kCccr = 0x18;
constexpr std::uint32_t kNbtp = 0x1C;
constexpr std::uint32_t kTscc = 0x20;
constexpr std::uint32_t kTscv = 0x24;
constexpr std::uint32_t kEcr = 0x40;
constexpr std::uint32_t kPsr = 0x44;
constexpr std::uint32_t kTdcr = 0x48;
constexpr std::uint32_t kIr = 0x50;
constexpr std::uint32_t kIe = 0x54;
constexpr std::uint32_t kIls = 0x58;
constexpr std::uint32_t kIle = 0x5C;
constexpr std::uint32_t kRxgfc = 0x80;
constexpr std::uint32_t kXidam = 0x84;
constexpr std::uint32_t kRxf0s = 0x90;
constexpr std::uint32_t kRxf0a = 0x94;
constexpr std::uint32_t kRxf1s = 0x98;
constexpr std::uint32_t kRxf1a = 0x9C;
constexpr std::uint32_t kTxbc = 0xC0;
constexpr std::uint32_t kTxfqs = 0xC4;
constexpr std::uint32_t kTxbrp = 0xC8;
constexpr std::uint32_t kTxbar = 0xCC;
constexpr std::uint32_t kTxbcr = 0xD0;
constexpr std::uint32_t kTxbto = 0xD4;
constexpr std::uint32_t kTxbcf = 0xD8;
constexpr std::uint32_t kTxbtie = 0xDC;
constexpr std::uint32_t kTxbcie = 0xE0;
constexpr std::uint32_t kTxefs = 0xE4;
constexpr std::uint32_t kTxefa = 0xE8;
constexpr std::uint32_t kCkdiv = 0x100;

constexpr RegisterSpec kRegisters[] = {
    {0x00, "CREL", 0x3214'1218, 0},
    {0x04, "ENDN", 0x8765'4321, 0},
    {0x0C, "DBTP", 0x0000'0A33, 0x009F'1FFF},
    {0x10, "TEST", 0, 0x0000'0070},
    {0x14, "RWD", 0, 0x0000'00FF},
    {0x18, "CCCR", 1, 0x0000'F3F7},
    {0x1C, "NBTP", 0x0600'0A03, 0xFFFF'FF7F},
    {0x20, "TSCC", 0, 0x000F'0003},
    {0x24, "TSCV", 0, 0x0000'FFFF},
    {0x28, "TOCC", 0xFFFF'0000, 0xFFFF'0007},
    {0x2C, "TOCV", 0xFFFF, 0x0000'FFFF},
    {0x40, "ECR", 0, 0},
    {0x44, "PSR", 0x707, 0},
    {0x48, "TDCR", 0, 0x0000'7F7F},
    {0x50, "IR", 0, 0x00FF'FFFF},
    {0x54, "IE", 0, 0x00FF'FFFF},
    {0x58, "ILS", 0, 0x0000'007F},
    {0x5C, "ILE", 0, 0x0000'0003},
    {0x80, "RXGFC", 0, 0x0F1F'033F},
    {0x84, "XIDAM", 0x1FFF'FFFF, 0x1FFF'FFFF},
    {0x88, "HPMS", 0, 0},
    {0x90, "RXF0S", 0, 0},
    {0x94, "RXF0A", 0, 0x7},
    {0x98, "RXF1S", 0, 0},
    {0x9C, "RXF1A", 0, 0x7},
    {0xC0, "TXBC", 0, 0x0100'0000},
    {0xC4, "TXFQS", 3, 0},
    {0xC8, "TXBRP", 0, 0},
    {0xCC, "TXBAR", 0, 0x7},
    {0xD0, "TXBCR", 0, 0x7},
    {0xD4, "TXBTO", 0, 0},
    {0xD8, "TXBCF", 0, 0},
    {0xDC, "TXBTIE", 0, 0x7},
    {0xE0, "TXBCIE", 0, 0x7},
    {0xE4, "TXEFS", 0, 0},
    {0xE8, "TXEFA", 0, 0x3},
    {0x100, "CKDIV", 0, 0xF},
};

// CCCR
constexpr std::uint32_t kInit = 1U << 0;
constexpr std::uint32_t kCce = 1U << 1;
constexpr std::uint32_t kClockStopAcknowledge = 1U << 3;
constexpr std::uint32_t kClockStopRequest = 1U << 4;
constexpr std::uint32_t kFdEnable = 8;
constexpr std::uint32_t kRateSwitchEnable = 9;
constexpr std::uint32_t kFree = kInit | kCce | kClockStopRequest;  // the others need CCE
constexpr std::uint32_t kMonitoring = 5;
constexpr std::uint32_t kNotModelled = 1U << 2 | 1U << 6 | 1U << 7;  // ASM, DAR, TEST

// IR
constexpr std::uint32_t kNewInFifo0 = 1U << 0;
constexpr std::uint32_t kTransmitted = 1U << 7;
constexpr std::uint32_t kCancelled = 1U << 8;
constexpr std::uint32_t kTxFifoEmpty = 1U << 9;
constexpr std::uint32_t kNewEvent = 1U << 10;
constexpr std::uint32_t kEventLost = 1U << 12;
constexpr std::uint32_t kErrorPassive = 1U << 17;
constexpr std::uint32_t kErrorInArbitration = 1U << 21;
constexpr std::uint32_t kErrorInData = 1U << 22;
constexpr std::uint32_t kErrorWarning = 1U << 18;
constexpr std::uint32_t kBusOff = 1U << 19;
constexpr std::uint32_t kArbitrationPhaseError = 1U << 21;
// Interrupts of each group of ILS (RM0440 44.4.16).
constexpr std::uint32_t kGroups[] = {0x7, 0x38, 0x1C0, 0x1E00, 0xE000, 0x3'0000, 0xFC'0000};

constexpr std::uint32_t kIrq0 = 21;
constexpr std::uint32_t kLastErrorAcknowledge = 3;
constexpr std::uint32_t kLastErrorBit0 = 5;
constexpr int kWarningLimit = 96;
constexpr int kPassiveLimit = 128;
constexpr int kBusOffLimit = 256;
constexpr std::uint32_t kJoinBits = 11;
constexpr std::uint32_t kRecoverBits = 129 * 11;
constexpr std::int64_t kInitDelay = 100'000;  // some clocks of the other domain
constexpr std::uint32_t kErrorFrameBits = 20;
constexpr std::uint32_t kBrokenAttemptBits = 30;

constexpr bool is_protected(std::uint32_t offset) {
    return offset == kDbtp || offset == kTest || offset == 0x14 || offset == kNbtp || offset == kTscc ||
           offset == 0x28 || offset == kTdcr || offset == kRxgfc || offset == kXidam || offset == kTxbc ||
           offset == kCkdiv;
}

std::uint32_t frame_bits(const wire::CanFrame& frame) {
    const wire::FrameBits bits = frame.is_fd ? wire::worst_case_bits_fd(frame.payload_len)
                                             : wire::worst_case_bits_classical(frame.payload_len);
    return static_cast<std::uint32_t>(bits.nominal + bits.data);
}

}  // namespace

Fdcan::Fdcan(const Surroundings& surroundings, FdcanRam& ram, CanBusSide& bus, const wire::BitRates& rates,
             Hooks hooks)
    : env_(surroundings),
      ram_(ram),
      bus_(bus),
      rates_(rates),
      hooks_(std::move(hooks)),
      bank_("FDCAN1", kRegisters, env_.log) {}

void Fdcan::reset() {
    bank_.reset();
    clear_for_configuration();
    joins_at_ = init_follows_at_ = attempt_fails_at_ = kNever;
    is_joined_ = is_bus_off_ = has_wrong_timing_ = false;
    transmit_errors_ = receive_errors_ = 0;
    last_error_ = 7;
    update_offer();
    update_lines();
}

void Fdcan::clear_for_configuration() {
    pending_ = cancelling_ = 0;
    order_.clear();
    put_ = 0;
    rx_ = {};
    events_ = {};
    for (const std::uint32_t offset : {kTxbto, kTxbcf}) bank_.set(offset, 0);
}

bool Fdcan::is_configurable() const {
    return (bank_.get(kCccr) & (kInit | kCce)) == (kInit | kCce);
}

bool Fdcan::is_on_bus() const {
    return is_joined_ && (bank_.get(kCccr) & kInit) == 0 && !is_bus_off_;
}

std::uint32_t Fdcan::nominal_bitrate() const {
    const std::uint32_t timing = bank_.get(kNbtp);
    const std::uint32_t quanta = (timing >> 8U & 0xFFU) + 1 + (timing & 0x7FU) + 1 + 1;
    return hooks_.kernel_hz() / ((timing >> 16U & 0x1FFU) + 1) / quanta;
}

std::uint32_t Fdcan::data_bitrate() const {
    const std::uint32_t timing = bank_.get(kDbtp);
    const std::uint32_t quanta = (timing >> 8U & 0x1FU) + 1 + (timing >> 4U & 0xFU) + 1 + 1;
    return hooks_.kernel_hz() / ((timing >> 16U & 0x1FU) + 1) / quanta;
}

std::int64_t Fdcan::bits_ps(std::uint32_t bits) const {
    return static_cast<std::int64_t>(bits) * period_ps(rates_.nominal);
}

// --- registers

std::uint32_t Fdcan::read(std::uint32_t offset) {
    switch (offset) {
        case kEcr:
            return error_counters();
        case kPsr:
            return read_protocol_status();
        case kRxf0s:
            return rx_status(rx_[0]);
        case kRxf1s:
            return rx_status(rx_[1]);
        case kTxfqs:
            return tx_status();
        case kTxbrp:
            return pending_;
        case kTxefs:
            return event_status();
        case kTscv:
            return timestamp();
        default:
            return bank_.read(offset);
    }
}

void Fdcan::write(std::uint32_t offset, std::uint32_t value) {
    if (is_protected(offset) && !is_configurable()) {
        env_.log.report(
            Rule::wrong_state,
            fmt::format("FDCAN1: protected register 0x{:X} written without INIT and CCE", offset));
        return;
    }
    switch (offset) {
        case kCccr:
            write_mode(value);
            break;
        case kIr:
            (void)bank_.checked(kIr, value);
            bank_.clear_bits(kIr, value);
            break;
        case kTxbar:
            request(bank_.checked(kTxbar, value) & 7U);
            break;
        case kTxbcr:
            cancel(bank_.checked(kTxbcr, value) & 7U);
            break;
        case kRxf0a:
            acknowledge_rx(rx_[0], value, "RXF0A");
            break;
        case kRxf1a:
            acknowledge_rx(rx_[1], value, "RXF1A");
            break;
        case kTxefa:
            acknowledge_rx(events_, value, "TXEFA");
            break;
        case kTscv:
            timestamp_zero_ = env_.now;
            break;
        case kTest:
            env_.log.report(Rule::not_modelled, "FDCAN1.TEST");
            break;
        default:
            bank_.write(offset, value);
    }
    update_lines();
}

void Fdcan::write_mode(std::uint32_t value) {
    const std::uint32_t before = bank_.get(kCccr);
    const std::uint32_t stored = bank_.checked(kCccr, value);
    if ((stored & kCce) != 0 && (before & kInit) == 0) {
        env_.log.report(Rule::wrong_state, "FDCAN1.CCCR.CCE set before INIT reads 1");
    }
    if (((stored ^ before) & ~kFree & ~kClockStopAcknowledge) != 0 && !is_configurable()) {
        env_.log.report(Rule::wrong_state,
                        fmt::format("FDCAN1.CCCR=0x{:X}: mode bits changed without INIT and CCE", value));
    }
    if ((stored & kNotModelled) != 0)
        env_.log.report(Rule::not_modelled, fmt::format("FDCAN1.CCCR=0x{:X}", value));
    std::uint32_t now = (stored & ~kInit) | (before & kInit);  // INIT follows later
    if ((before & kInit) == 0 || (stored & kInit) == 0) now &= ~kCce;
    now = (now & kClockStopRequest) != 0 ? now | kClockStopAcknowledge : now & ~kClockStopAcknowledge;
    bank_.set(kCccr, now);
    if ((now & kCce) != 0 && (before & kCce) == 0) {
        clear_for_configuration();
        update_offer();
    }
    const bool is_changing = (stored & kInit) != (before & kInit);
    init_follows_at_ = is_changing ? std::min(init_follows_at_, env_.now + kInitDelay) : kNever;
}

void Fdcan::begin_operation() {
    check_bit_timing();
    is_joined_ = false;
    joins_at_ = env_.now + bits_ps(is_bus_off_ ? kRecoverBits : kJoinBits);
}

void Fdcan::check_bit_timing() {
    const auto complain = [this](std::string what) { env_.log.report(Rule::bus_timing, std::move(what)); };
    if (hooks_.kernel_hz() == 0) {
        env_.log.report(Rule::clock_tree, "FDCAN1 started without a kernel clock");
        has_wrong_timing_ = true;
        return;
    }
    if (!hooks_.is_clock_from_crystal())
        env_.log.report(Rule::clock_tree, "FDCAN1 started on the internal oscillator");
    if (!hooks_.has_pins()) env_.log.report(Rule::pin_function, "FDCAN1 started without its pins");
    has_wrong_timing_ = nominal_bitrate() != rates_.nominal;
    has_wrong_data_timing_ = false;
    const bool is_listening = is_set(kCccr, kMonitoring);  // who only listens may try
    if (has_wrong_timing_ && !is_listening)
        complain(fmt::format("FDCAN1 at {} bit/s on a bus of {}", nominal_bitrate(), rates_.nominal));
    if (!is_set(kCccr, kFdEnable) || !is_set(kCccr, kRateSwitchEnable)) return;
    if (data_bitrate() != rates_.data) {
        has_wrong_data_timing_ = true;
        if (is_listening) return;
        has_wrong_timing_ = true;
        complain(fmt::format("FDCAN1 at {} bit/s for data on a bus of {}", data_bitrate(), rates_.data));
    }
    check_delay_compensation();
}

// At 2 Mbit/s and above the loop delay of the transceiver is longer than a bit.
void Fdcan::check_delay_compensation() {
    const std::uint32_t timing = bank_.get(kDbtp);
    const bool is_on = (timing >> 23U & 1U) != 0;
    if (is_on && (timing >> 16U & 0x1FU) > 1)
        env_.log.report(Rule::bus_timing, "FDCAN1: delay compensation needs a data prescaler of 1 or 2");
    if (!is_on && data_bitrate() >= 2'000'000)
        env_.log.report(Rule::bus_timing, "FDCAN1: 2 Mbit/s and above without delay compensation");
    const std::uint32_t sample_point = ((timing >> 16U & 0x1FU) + 1) * ((timing >> 8U & 0x1FU) + 2);
    if (is_on && (bank_.get(kTdcr) >> 8U & 0x7FU) != sample_point)
        env_.log.report(Rule::bus_timing, fmt::format("FDCAN1.TDCR.TDCO={}: the sample point is at {}",
                                                      bank_.get(kTdcr) >> 8U & 0x7FU, sample_point));
}

// --- transmission

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
        return frame.is_extended ? frame.can_id : frame.can_id << 18U;
    };
    return *std::ranges::min_element(order_, {}, rank);
}

void Fdcan::update_offer() {
    if (has_started_ && is_on_bus()) return;
    has_started_ = false;
    const bool is_good = link_ == CanLink::good && !has_wrong_timing_;
    const bool is_mute = !is_on_bus() || is_set(kCccr, kMonitoring);
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

void Fdcan::on_started() {
    if (offered_) has_started_ = true;
}

void Fdcan::on_sent() {
    has_started_ = false;
    if (offered_ && (pending_ >> *offered_ & 1U) != 0) {
        count_errors(-1, 0);
        last_error_ = 0;
        finish(*offered_, true);
    }
    update_offer();
    update_lines();
}

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

void Fdcan::fail_attempt() {
    attempt_fails_at_ = kNever;
    const bool is_broken = link_ == CanLink::broken || has_wrong_timing_;
    last_error_ = is_broken ? kLastErrorBit0 : kLastErrorAcknowledge;
    raise(kArbitrationPhaseError);
    // An error-passive transmitter that only misses its acknowledge counts no further.
    if (is_broken || transmit_errors_ < kPassiveLimit) count_errors(8, 0);
    update_offer();
}

// --- errors

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
    // One good frame ends being passive for what was received: ISO 11898-1 sets the counter to 119..127.
    const bool ends_passive = receive < 0 && receive_errors_ >= kPassiveLimit;
    receive_errors_ = ends_passive ? kPassiveLimit - 1 : std::max(0, receive_errors_ + receive);
    if (is_passive() != was_passive) raise(kErrorPassive);
    if (is_warning() != was_warning) raise(kErrorWarning);
    if (transmit_errors_ >= kBusOffLimit) enter_bus_off();
}

// The hardware sets INIT and does not come back by itself.
void Fdcan::enter_bus_off() {
    is_bus_off_ = true;
    is_joined_ = false;
    has_started_ = false;
    bank_.set_bits(kCccr, kInit);
    init_follows_at_ = joins_at_ = attempt_fails_at_ = kNever;
    raise(kBusOff);
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

// --- reception

/// Bus monitoring: neither acknowledges nor error frames, and the error counters stand still.
void Fdcan::on_overheard(const wire::CanFrame& frame) {
    const bool is_unreadable = frame.is_fd && !is_set(kCccr, kFdEnable);
    if (link_ != CanLink::good || has_wrong_timing_ || is_unreadable) {
        raise(kErrorInArbitration);
    } else if (frame.has_bit_rate_switch && has_wrong_data_timing_) {
        raise(kErrorInData);
    } else {
        last_error_ = 0;
        store(frame);
    }
    update_lines();
}

void Fdcan::on_received(const wire::CanFrame& frame) {
    if (!is_on_bus()) return;
    if (is_set(kCccr, kMonitoring)) return on_overheard(frame);
    if (link_ != CanLink::good || has_wrong_timing_ || (frame.is_fd && !is_set(kCccr, kFdEnable))) {
        count_errors(0, 1);
    } else {
        count_errors(0, -1);
        last_error_ = 0;
        store(frame);
    }
    update_lines();
}

void Fdcan::store(const wire::CanFrame& frame) {
    const Verdict verdict = judge(frame);
    if (verdict.fifo < 0) return;
    const auto number = static_cast<std::uint32_t>(verdict.fifo);
    RxFifo& fifo = rx_.at(number);
    const std::uint32_t first_flag = kNewInFifo0 << (3 * number);
    const bool overwrites = is_set(kRxgfc, number == 0 ? 9 : 8);
    if (fifo.fill == kPlaces) {
        if (!overwrites) {
            fifo.has_lost = true;
            raise(first_flag << 2U);
            return;
        }
        fifo.get = (fifo.get + 1) % kPlaces;
        --fifo.fill;
    }
    ram_.store_rx(number, fifo.put, frame, timestamp(), verdict.filter);
    fifo.put = (fifo.put + 1) % kPlaces;
    ++fifo.fill;
    raise(first_flag | (fifo.fill == kPlaces ? first_flag << 1U : 0U));
}

Fdcan::Verdict Fdcan::judge(const wire::CanFrame& frame) const {
    const std::uint32_t global = bank_.get(kRxgfc);
    const bool rejects_remote = (global >> (frame.is_extended ? 0U : 1U) & 1U) != 0;
    if (frame.is_remote && rejects_remote) return {};
    const Verdict listed = frame.is_extended ? judge_extended(frame.can_id) : judge_standard(frame.can_id);
    if (listed.filter >= 0) return listed;
    const std::uint32_t others = global >> (frame.is_extended ? 2U : 4U) & 3U;
    return {others < 2 ? static_cast<int>(others) : -1, -1};
}

namespace {

/// Filter action SFEC or EFEC: 1 and 2 store, 3 rejects; 5 and 6 store with priority.
int fifo_of(std::uint32_t action) {
    if (action == 1 || action == 5) return 0;
    return action == 2 || action == 6 ? 1 : -1;
}

bool matches(std::uint32_t type, std::uint32_t id, std::uint32_t first, std::uint32_t second) {
    if (type == 1) return id == first || id == second;
    if (type == 2) return (id & second) == (first & second);
    return id >= first && id <= second;
}

}  // namespace

Fdcan::Verdict Fdcan::judge_standard(std::uint32_t id) const {
    const std::uint32_t count = std::min(bank_.get(kRxgfc) >> 16U & 0x1FU, 28U);
    for (std::uint32_t index = 0; index < count; ++index) {
        const std::uint32_t filter = ram_.standard_filter(index);
        const std::uint32_t action = filter >> 27U & 7U;
        if (action == 0 || filter >> 30U == 3) continue;  // disabled
        if (matches(filter >> 30U, id, filter >> 16U & 0x7FFU, filter & 0x7FFU))
            return {fifo_of(action), static_cast<int>(index)};
    }
    return {};
}

Fdcan::Verdict Fdcan::judge_extended(std::uint32_t id) const {
    const std::uint32_t count = std::min(bank_.get(kRxgfc) >> 24U & 0xFU, 8U);
    const std::uint32_t masked = id & bank_.get(kXidam);
    for (std::uint32_t index = 0; index < count; ++index) {
        const std::uint64_t filter = ram_.extended_filter(index);
        const auto f0 = static_cast<std::uint32_t>(filter);
        const auto f1 = static_cast<std::uint32_t>(filter >> 32U);
        if (f0 >> 29U == 0) continue;
        const std::uint32_t type = f1 >> 30U;
        if (matches(type == 3 ? 0 : type, type == 3 ? id : masked, f0 & 0x1FFF'FFFFU, f1 & 0x1FFF'FFFFU))
            return {fifo_of(f0 >> 29U), static_cast<int>(index)};
    }
    return {};
}

void Fdcan::acknowledge_rx(RxFifo& fifo, std::uint32_t index, const char* what) {
    if (fifo.fill == 0 || index != fifo.get) {
        env_.log.report(Rule::wrong_state, fmt::format("FDCAN1.{}={}: {} waiting, the oldest is {}", what,
                                                       index, fifo.fill, fifo.get));
        if (fifo.fill == 0) return;
    }
    fifo.get = (index + 1) % kPlaces;
    fifo.fill = (fifo.put + kPlaces - fifo.get) % kPlaces;
    fifo.has_lost = false;
}

std::uint32_t Fdcan::rx_status(const RxFifo& fifo) const {
    return fifo.fill | fifo.get << 8U | fifo.put << 16U | (fifo.fill == kPlaces ? 1U << 24 : 0U) |
           (fifo.has_lost ? 1U << 25 : 0U);
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

std::uint16_t Fdcan::timestamp() const {
    if ((bank_.get(kTscc) & 3U) != 1) return 0;
    const std::uint64_t prescaler = (bank_.get(kTscc) >> 16U & 0xFU) + 1;
    return static_cast<std::uint16_t>(periods_in(env_.now.ps - timestamp_zero_.ps, rates_.nominal) /
                                      prescaler);
}

// --- time and interrupts

void Fdcan::advance() {
    if (env_.now >= init_follows_at_) {
        init_follows_at_ = kNever;
        bank_.set(kCccr, bank_.get(kCccr) ^ kInit);
        if ((bank_.get(kCccr) & kInit) == 0) {
            begin_operation();
        } else {
            is_joined_ = false;
            has_started_ = false;
            joins_at_ = kNever;
        }
        update_offer();
    }
    if (env_.now >= joins_at_) {
        joins_at_ = kNever;
        is_joined_ = true;
        if (is_bus_off_) {
            is_bus_off_ = false;
            transmit_errors_ = receive_errors_ = 0;
            raise(kBusOff);  // on leaving as on entering
        }
        update_offer();
    }
    if (env_.now >= attempt_fails_at_) fail_attempt();
    update_lines();
}

BoardTime Fdcan::next_event() const {
    return std::min({init_follows_at_, joins_at_, attempt_fails_at_});
}

void Fdcan::raise(std::uint32_t flags) {
    bank_.set_bits(kIr, flags);
}

void Fdcan::update_lines() {
    const std::uint32_t active = bank_.get(kIr) & bank_.get(kIe);
    std::uint32_t second = 0;
    for (std::uint32_t group = 0; group < 7; ++group) {
        if (is_set(kIls, group)) second |= kGroups[group];
    }
    env_.lines.set_line(kIrq0, (active & ~second) != 0 && is_set(kIle, 0));
    env_.lines.set_line(kIrq0 + 1, (active & second) != 0 && is_set(kIle, 1));
}

}  // namespace octoskin::sim::stm32
