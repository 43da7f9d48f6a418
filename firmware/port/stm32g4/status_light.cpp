#include "firmware/port/stm32g4/status_light.hpp"

namespace octoskin::stm32g4 {

namespace {
constexpr Pin kLight{gpio_a, 5};  // LD2 of the NUCLEO, on when high
constexpr std::uint32_t kSlotUs =
    1U << 17;  // 131 ms: a power of two, so that the pattern continues when the clock wraps
constexpr std::uint32_t kSlots = 16;
constexpr Microseconds kIdentifyPause{1'000'000};
}  // namespace

void StatusLight::start() {
    kLight.set(false);
    kLight.make_output(Drive::push_pull);
}

void StatusLight::set(bool is_on) {
    kLight.set(is_on);
    ordered_ = is_on;
}

NodeTime StatusLight::poll(NodeTime now) {
    if (ordered_) identify_until_ = now + kIdentifyPause;
    ordered_.reset();
    if (identify_until_ && !is_reached(*identify_until_, now)) return *identify_until_;
    identify_until_.reset();
    // Of 16 slots, the slots 0, 2, 4, ... are flashes, up to the number to show; the rest is the pause.
    const std::uint32_t slot = now.us / kSlotUs % kSlots;
    kLight.set(slot % 2 == 0 && slot / 2 < static_cast<std::uint32_t>(flashes_));
    return {(now.us / kSlotUs + 1) * kSlotUs};
}

}  // namespace octoskin::stm32g4
