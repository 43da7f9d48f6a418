#include "hw/sim/stm32g474/cpu/nvic.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint8_t kPriorityMask = 0xF0;  // __NVIC_PRIO_BITS = 4
constexpr std::uint32_t kIser = 0x100;
constexpr std::uint32_t kIcer = 0x180;
constexpr std::uint32_t kIspr = 0x200;
constexpr std::uint32_t kIcpr = 0x280;
constexpr std::uint32_t kIabr = 0x300;
constexpr std::uint32_t kIpr = 0x400;

}  // namespace

void Nvic::reset() {
    pending_.reset();
    active_.reset();
    lines_.reset();
    enabled_.reset();
    priority_.fill(0);
    prigroup_ = 0;
    for (const std::uint32_t always : {exception::kNmi, exception::kHardFault, exception::kSvCall,
                                       exception::kPendSv, exception::kSysTick}) {
        enabled_[always] = true;
    }
    update();
}

void Nvic::pend(std::uint32_t number) {
    if (pending_[number]) return;
    pending_[number] = true;
    update();
}

void Nvic::unpend(std::uint32_t number) {
    if (!pending_[number]) return;
    pending_[number] = false;
    update();
}

void Nvic::set_line(std::uint32_t irq, bool is_high) {
    const std::uint32_t number = 16 + irq;
    if (lines_[number] == is_high) return;
    lines_[number] = is_high;
    if (is_high && !active_[number]) pend(number);
}

void Nvic::activate(std::uint32_t number) {
    pending_[number] = false;
    active_[number] = true;
    update();
}

void Nvic::deactivate(std::uint32_t number) {
    active_[number] = false;
    if (lines_[number]) pending_[number] = true;
    update();
}

void Nvic::enable_fault(std::uint32_t number, bool is_enabled) {
    enabled_[number] = is_enabled;
    update();
}

void Nvic::set_priority(std::uint32_t number, std::uint8_t priority) {
    priority_[number] = priority & kPriorityMask;
    update();
}

void Nvic::set_priority_group(std::uint32_t prigroup) {
    prigroup_ = prigroup;
    update();
}

int Nvic::group_priority(std::uint32_t number) const {
    if (number == exception::kNmi) return -2;
    if (number == exception::kHardFault) return -1;
    return priority_[number] & (0xFF << (prigroup_ + 1)) & 0xFF;
}

void Nvic::update() {
    active_priority_ = kThreadPriority;
    for (auto n = active_._Find_first(); n < active_.size(); n = active_._Find_next(n)) {
        active_priority_ = std::min(active_priority_, group_priority(static_cast<std::uint32_t>(n)));
    }
    const std::uint32_t first = first_pending();
    candidate_.reset();
    if (first != 0 && group_priority(first) < active_priority_) candidate_ = first;
}

std::uint32_t Nvic::first_pending() const {
    const Exceptions ready = pending_ & enabled_;
    std::uint32_t first = 0;
    int lowest = kThreadPriority;
    for (auto n = ready._Find_first(); n < ready.size(); n = ready._Find_next(n)) {
        const auto number = static_cast<std::uint32_t>(n);
        const int fixed = group_priority(number);
        const int full = fixed < 0 ? fixed : priority_[number];  // sub-priority decides the order
        if (full < lowest) {
            lowest = full;
            first = number;
        }
    }
    return first;
}

int Nvic::execution_priority(const ExceptionMasks& masks) const {
    int priority = active_priority_;
    if (masks.basepri != 0) {
        priority = std::min(priority, masks.basepri & (0xFF << (prigroup_ + 1)) & 0xFF);
    }
    if (masks.is_primask) priority = std::min(priority, 0);
    if (masks.is_faultmask) priority = std::min(priority, -1);
    return priority;
}

std::optional<std::uint32_t> Nvic::deliverable(const ExceptionMasks& masks) const {
    if (!candidate_ || group_priority(*candidate_) >= execution_priority(masks)) return std::nullopt;
    return candidate_;
}

std::uint32_t Nvic::word(const Exceptions& bits, std::uint32_t index) const {
    std::uint32_t value = 0;
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        const std::uint32_t number = 16 + 32 * index + bit;
        if (number < kExceptionCount && bits[number]) value |= 1U << bit;
    }
    return value;
}

std::uint32_t Nvic::read_register(std::uint32_t offset) const {
    const std::uint32_t index = (offset & 0x7FU) / 4;
    if (offset >= kIpr) {
        std::uint32_t value = 0;
        for (std::uint32_t byte = 0; byte < 4; ++byte) {
            const std::uint32_t number = 16 + (offset & ~3U) - kIpr + byte;
            if (number < kExceptionCount) value |= std::uint32_t{priority_[number]} << (8 * byte);
        }
        return value;
    }
    if (offset >= kIabr) return word(active_, index);
    if (offset >= kIspr) return word(pending_, index);  // ICPR reads the same
    return word(enabled_, index);
}

void Nvic::write_register(std::uint32_t offset, std::uint32_t value, std::uint32_t size) {
    if (offset >= kIpr) {
        for (std::uint32_t byte = 0; byte < size; ++byte) {
            const std::uint32_t number = 16 + offset - kIpr + byte;
            const auto priority = static_cast<std::uint8_t>(value >> (8 * byte));
            if (number < kExceptionCount) set_priority(number, priority);
            if ((priority & ~kPriorityMask) != 0) {
                log_.report(
                    Rule::reserved_bits,
                    fmt::format("NVIC.IPR: priority 0x{:02X} of interrupt {} uses bits that do not exist",
                                priority, number - 16));
            }
        }
        return;
    }
    if (size != 4)
        log_.report(Rule::access_width, fmt::format("NVIC: {}-byte write at 0x{:X}", size, offset));
    const std::uint32_t index = (offset & 0x7FU) / 4;
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        if ((value >> bit & 1U) == 0) continue;
        const std::uint32_t number = 16 + 32 * index + bit;
        if (number >= kExceptionCount) {
            log_.report(Rule::reserved_bits, fmt::format("NVIC: there is no interrupt {}", number - 16));
            continue;
        }
        if (offset >= kIabr) {
            log_.report(Rule::read_only, "NVIC.IABR");
        } else if (offset >= kIcpr) {
            pending_[number] = lines_[number] && !active_[number];
        } else if (offset >= kIspr) {
            pending_[number] = true;
        } else if (offset >= kIcer) {
            enabled_[number] = false;
        } else if (offset >= kIser) {
            enabled_[number] = true;
        }
    }
    update();
}

}  // namespace octoskin::sim::stm32
