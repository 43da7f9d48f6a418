#include "hw/sim/stm32g474/cpu/systick.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kCsr = 0x0;
constexpr std::uint32_t kRvr = 0x4;
constexpr std::uint32_t kCvr = 0x8;
constexpr std::uint32_t kTickInt = 2;
constexpr std::uint32_t kCountFlag = 1U << 16;

}  // namespace

void SysTick::reset() {
    control_ = reload_ = value_ = 0;
    has_counted_to_zero_ = false;
    counted_to_ = now_;
}

void SysTick::advance() {
    if (!is_enabled()) {
        counted_to_ = now_;
        return;
    }
    std::uint64_t ticks = periods_in(now_.ps - counted_to_.ps, hz());
    counted_to_ = counted_to_ + span_of(ticks, hz());
    while (ticks > 0) {
        if (value_ == 0) {
            if (reload_ == 0) return;
            value_ = reload_;
            --ticks;
            continue;
        }
        const auto step = static_cast<std::uint32_t>(std::min<std::uint64_t>(ticks, value_));
        value_ -= step;
        ticks -= step;
        if (value_ == 0) {
            has_counted_to_zero_ = true;
            if ((control_ & kTickInt) != 0) on_zero_();
        }
    }
}

BoardTime SysTick::next_event() const {
    if (!is_enabled() || (value_ == 0 && reload_ == 0)) return kNever;
    const std::uint64_t ticks = value_ != 0 ? value_ : std::uint64_t{reload_} + 1;
    return counted_to_ + span_of(ticks, hz());
}

std::uint32_t SysTick::read(std::uint32_t offset) {
    switch (offset) {
        case kCsr: {
            const std::uint32_t value = control_ | (has_counted_to_zero_ ? kCountFlag : 0);
            has_counted_to_zero_ = false;
            return value;
        }
        case kRvr:
            return reload_;
        case kCvr:
            return value_;
        default:
            return 0x4000'0000 | 2000;  // CALIB: 1 ms at the reset clock's eighth
    }
}

void SysTick::write(std::uint32_t offset, std::uint32_t value) {
    if (offset == kCsr) {
        if ((value & ~(7U | kCountFlag)) != 0)
            log_.report(Rule::reserved_bits, fmt::format("SysTick.CSR: 0x{:X}", value));
        control_ = value & 7U;
    } else if (offset == kRvr) {
        if (value > 0xFFFFFF) log_.report(Rule::reserved_bits, fmt::format("SysTick.RVR: 0x{:X}", value));
        reload_ = value & 0xFFFFFFU;
    } else if (offset == kCvr) {
        value_ = 0;
        has_counted_to_zero_ = false;
    } else {
        log_.report(Rule::read_only, "SysTick.CALIB");
    }
}

}  // namespace octoskin::sim::stm32
