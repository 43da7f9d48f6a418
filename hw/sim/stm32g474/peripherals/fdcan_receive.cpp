// FDCAN's receive side: filters, FIFOs, bus monitoring.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hw/sim/stm32g474/peripherals/fdcan.hpp"
#include "hw/sim/stm32g474/peripherals/fdcan_registers.hpp"

namespace octoskin::sim::stm32 {

using namespace fdcan;

/// Bus monitoring: no acknowledges, no error frames, and the error counters do not change.
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
    const FilterMatch verdict = judge(frame);
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

Fdcan::FilterMatch Fdcan::judge(const wire::CanFrame& frame) const {
    const std::uint32_t global = bank_.get(kRxgfc);
    const bool rejects_remote = (global >> (frame.is_extended ? 0U : 1U) & 1U) != 0;
    if (frame.is_remote && rejects_remote) return {};
    const FilterMatch listed =
        frame.is_extended ? judge_extended(frame.can_id) : judge_standard(frame.can_id);
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

Fdcan::FilterMatch Fdcan::judge_standard(std::uint32_t id) const {
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

Fdcan::FilterMatch Fdcan::judge_extended(std::uint32_t id) const {
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

}  // namespace octoskin::sim::stm32
