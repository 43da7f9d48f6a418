#include "host/core/pipeline/mark_gate.hpp"

#include <chrono>
#include <utility>

namespace octoskin {
namespace {

/// The host time is unknown for two exchanges at most; after five seconds without one, nothing is mapped
/// anyway.
constexpr Nanoseconds kWaitMax{5'000'000'000};
constexpr std::size_t kWaitingMax = 16;

}  // namespace

MarkGate::Fate MarkGate::take(const wire::Mark& mark, std::optional<HostTime> now) {
    if (now) {
        const Nanoseconds apart = MarkWindow::time_of(mark) - *now;
        return std::chrono::abs(apart) <= kApartMax && window_.take(mark) ? Fate::taken : Fate::ignored;
    }
    if (waiting_.size() == kWaitingMax) {
        return Fate::ignored;
    }
    waiting_.push_back(mark);
    return Fate::waits;
}

std::vector<MarkGate::Settled> MarkGate::settle(HostTime now) {
    std::vector<Settled> settled;
    for (const wire::Mark& mark : std::exchange(waiting_, {})) {
        const Nanoseconds ahead = MarkWindow::time_of(mark) - now;
        const bool is_plausible = ahead <= kApartMax && ahead >= -(kApartMax + kWaitMax);
        settled.push_back({mark, is_plausible && window_.take(mark)});
    }
    return settled;
}

std::size_t MarkGate::give_up() {
    return std::exchange(waiting_, {}).size();
}

}  // namespace octoskin
