#include "hw/sim/stm32g474/violation.hpp"

#include <algorithm>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::size_t kKept = 1000;

}  // namespace

const char* name_of(Rule rule) noexcept {
    switch (rule) {
        case Rule::unclocked:
            return "unclocked";
        case Rule::not_modelled:
            return "not-modelled";
        case Rule::reserved_bits:
            return "reserved-bits";
        case Rule::access_width:
            return "access-width";
        case Rule::read_only:
            return "read-only";
        case Rule::wrong_state:
            return "wrong-state";
        case Rule::clock_tree:
            return "clock-tree";
        case Rule::flash_latency:
            return "flash-latency";
        case Rule::debug_access:
            return "debug-access";
        case Rule::fpu_disabled:
            return "fpu-disabled";
        case Rule::pin_function:
            return "pin-function";
        case Rule::bus_timing:
            return "bus-timing";
        case Rule::start_while_busy:
            return "start-while-busy";
        case Rule::data_lost:
            return "data-lost";
        case Rule::exception_model:
            return "exception-model";
        case Rule::memory:
            return "memory";
    }
    return "unknown";
}

void ViolationLog::report(Rule rule, std::string what) {
    ++count_;
    const std::uint32_t pc = where_ ? where_() : 0;
    const auto same = std::ranges::find_if(violations_, [&](const Violation& known) {
        return known.rule == rule && known.pc == pc && known.what == what;
    });
    if (same != violations_.end()) {
        ++same->count;
    } else if (violations_.size() < kKept) {
        violations_.push_back({rule, pc, now_, 1, std::move(what)});
    }
}

bool ViolationLog::has(Rule rule) const {
    return std::ranges::any_of(violations_, [rule](const Violation& known) { return known.rule == rule; });
}

}  // namespace octoskin::sim::stm32
