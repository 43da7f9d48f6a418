#include "hw/sim/stm32g474/peripherals/fdcan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/fdcan_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace fdcan;

namespace {

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

constexpr bool is_protected(std::uint32_t offset) {
    return offset == kDbtp || offset == kTest || offset == 0x14 || offset == kNbtp || offset == kTscc ||
           offset == 0x28 || offset == kTdcr || offset == kRxgfc || offset == kXidam || offset == kTxbc ||
           offset == kCkdiv;
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
    if ((stored & ~before & kNotModelled) != 0)
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
    const bool is_listening = is_set(kCccr, kMonitoring);  // allowed while only listening
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

// --- time and interrupts

std::uint16_t Fdcan::timestamp() const {
    if ((bank_.get(kTscc) & 3U) != 1) return 0;
    const std::uint64_t prescaler = (bank_.get(kTscc) >> 16U & 0xFU) + 1;
    return static_cast<std::uint16_t>(periods_in(env_.now.ps - timestamp_zero_.ps, rates_.nominal) /
                                      prescaler);
}

void Fdcan::advance() {
    if (env_.now >= init_follows_at_ && is_deaf_) init_follows_at_ = kNever;
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
