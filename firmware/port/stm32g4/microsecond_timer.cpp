#include "firmware/port/stm32g4/microsecond_timer.hpp"

#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/timer.hpp"

namespace octoskin::stm32g4 {

void MicrosecondTimer::start(std::uint32_t clock_hz) {
    using F = Field<TimerMap>;
    rcc.set("APB1ENR1.TIM2EN", 1);
    (void)rcc.read("APB1ENR1");
    tim2.write("CR1", 0);
    tim2.write("DIER", 0);
    tim2.write("PSC", clock_hz / 1'000'000 - 1);
    tim2.write("ARR", 0xFFFF'FFFF);
    tim2.write("EGR", F("EGR.UG")(1));  // loads the new prescaler and clears the counter
    tim2.write("SR", 0);
    tim2.write("CR1", F("CR1.CEN")(1));
}

NodeTime MicrosecondTimer::now() const {
    return {tim2.read("CNT")};
}

void MicrosecondTimer::wait(Microseconds duration) const {
    // One count more: the current count may be about to end.
    const NodeTime end = now() + duration + Microseconds{1};
    while (!is_reached(end, now())) {
    }
}

void MicrosecondTimer::wake_at(NodeTime when) {
    using F = Field<TimerMap>;
    tim2.write("DIER", 0);
    tim2.write("CCR1", when.us);
    tim2.write("SR", ~F("SR.CC1IF").mask());
    tim2.write("DIER", F("DIER.CC1IE")(1));
    // The counter may have passed `when` before the compare register was written.
    if (is_reached(when, now())) tim2.write("EGR", F("EGR.CC1G")(1));
}

void MicrosecondTimer::on_interrupt() {
    tim2.write("DIER", 0);
    tim2.write("SR", ~Field<TimerMap>("SR.CC1IF").mask());
}

}  // namespace octoskin::stm32g4
