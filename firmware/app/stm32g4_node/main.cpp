// The node on a NUCLEO-G474RE: builds the parts, wires them, loops.
#include <algorithm>
#include <array>
#include <optional>

#include "common/config/node_config.hpp"
#include "firmware/app/stm32g4_node/report.hpp"
#include "firmware/core/node.hpp"
#include "firmware/core/time_bracket.hpp"
#include "firmware/port/stm32g4/can_bit_timing.hpp"
#include "firmware/port/stm32g4/can_controller.hpp"
#include "firmware/port/stm32g4/clock_plan.hpp"
#include "firmware/port/stm32g4/clocks.hpp"
#include "firmware/port/stm32g4/configuration_page.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/fault_handlers.hpp"
#include "firmware/port/stm32g4/i2c_controller.hpp"
#include "firmware/port/stm32g4/i2c_timing.hpp"
#include "firmware/port/stm32g4/interrupt_handlers.hpp"
#include "firmware/port/stm32g4/microsecond_timer.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/rate_search.hpp"
#include "firmware/port/stm32g4/reset_cause.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"
#include "firmware/port/stm32g4/unique_id.hpp"
#include "firmware/port/stm32g4/watchdog.hpp"
#include "firmware/port/stm32g4/xshut_chain.hpp"

namespace octoskin::stm32g4 {
namespace {

constexpr std::uint8_t kBoardType = 1;     // hw/boards/nucleo_g474re.yaml
constexpr Microseconds kSleepMax{50'000};  // in case a wake-up was missed

constexpr Microseconds kSayMax{40'000};  // two lines and a half

constinit IndependentWatchdog watchdog;
constinit MicrosecondTimer timer;
constinit SerialPort serial;
constinit StatusLight light;
constinit Report report{serial, light};
constinit XshutChain xshut;
constinit CanController can{timer};
constinit std::optional<RateSearch> rate_search;  // while nobody told the rates
constinit std::array<I2cController, kI2cWirings.size()> i2c_controllers{
    I2cController{kI2cWirings[0], timer}, I2cController{kI2cWirings[1], timer},
    I2cController{kI2cWirings[2], timer}, I2cController{kI2cWirings[3], timer}};
constinit std::array<i2c::Bus*, kI2cWirings.size()> buses{&i2c_controllers[0], &i2c_controllers[1],
                                                          &i2c_controllers[2], &i2c_controllers[3]};
constinit NodeConfig config = without_configuration();
constinit std::optional<node::Node> the_node;

/// Without the crystal it was said already.
void note_silence(const Clocks& clocks) {
    if (clocks.can_hz != 0) report.can_dead();
}

void start_buses(const Clocks& clocks) {
    const auto timing = i2c_timing(clocks.core_hz, config.i2c_hz);
    if (timing) {
        for (I2cController& controller : i2c_controllers) controller.start(*timing);
    }
    const bool has_rates = is_possible(rates_of(config), kCanHz);
    if (has_rates && !can.start(rates_of(config), config.node_id, clocks.can_hz)) note_silence(clocks);
    if (timing && has_rates && config.board_type == kBoardType) return report.config_accepted(config);
    report.config_unsuitable(config);
    // Not valid: the node does not range, and says so. (A wrong board type it finds by itself.)
    if (!timing || !has_rates) config.i2c_hz = 0;
}

void load_configuration(const Clocks& clocks) {
    const auto decoded = decode_node_config(configuration_page());
    if (decoded) {
        config = *decoded;
        start_buses(clocks);
    } else {
        report.config_refused(decoded.error());
        rate_search.emplace();
        rate_search->begin(timer.now());
        if (!can.listen(rate_search->rates(), config.node_id, clocks.can_hz)) {
            rate_search.reset();
            note_silence(clocks);
        }
    }
}

/// Before anything else is tried: what failed may fail again at once.
void tell_fault(const Fault& fault) {
    report.fault(fault);
    const NodeTime begun = timer.now();
    while (!serial.is_quiet() && elapsed(begun, timer.now()) < kSayMax) {
    }
}

void start() {
    watchdog.start();
    const std::optional<Fault> last = fault_record().read();
    const wire::ResetCause cause = reset_cause(take_reset_flags(), last.has_value());
    if (!last || cause == wire::ResetCause::power_on) fault_record().write({});
    const Clocks clocks = start_clocks(timer);
    cpu::enable(Interrupt::tim2, cpu::Priority::text);
    enable_pins();
    light.start();
    xshut.start();
    serial.start(clocks.core_hz);
    const bool is_fault_new = node::load(kept_memory()).is_fault_new;
    report.started(OCTOSKIN_BUILD_ID, is_fault_new ? wire::ResetCause::fault : cause, clocks);
    if (last && last->kind != wire::FaultKind::none) tell_fault(*last);
    load_configuration(clocks);
    const node::Identity identity{
        .uid = unique_id(), .build_id = OCTOSKIN_BUILD_ID, .board_type = kBoardType, .reset_cause = cause};
    const node::Ports ports{.buses = buses,
                            .xshut = xshut,
                            .can = can,
                            .indicator = &light,
                            .watchdog = &watchdog,
                            .kept = &kept_memory()};
    the_node.emplace(config, identity, ports, timer.now());
}

void search_rates(NodeTime now) {
    if (!rate_search) return;
    const RateSearch::Verdict verdict = rate_search->judge(can.heard(), now);
    if (verdict == RateSearch::Verdict::try_next)
        (void)can.listen(rate_search->rates(), config.node_id, kCanHz);
    if (verdict == RateSearch::Verdict::found && can.join()) rate_search.reset();
}

/// When something must be done even if no event comes.
NodeTime wake_time(NodeTime light_due) {
    const NodeTime now = timer.now();
    NodeTime wake = node::earlier_of(now + kSleepMax, light_due);
    wake = node::earlier_of(wake, the_node->wake_time(now));
    if (const auto due = can.wake_time()) wake = node::earlier_of(wake, *due);
    for (const I2cController& controller : i2c_controllers) {
        if (const auto due = controller.deadline()) wake = node::earlier_of(wake, *due);
    }
    return wake;
}

bool has_event() {
    return can.has_event() ||
           std::any_of(i2c_controllers.begin(), i2c_controllers.end(),
                       [](const I2cController& controller) { return controller.has_ended(); });
}

/// Interrupts that move a byte wake the core, but not the loop. Masked while it looks: what comes between the
/// look and the sleep ends the sleep at once.
void sleep_until(NodeTime wake) {
    timer.wake_at(wake);
    while (true) {
        const cpu::MaskedSection masked;
        if (is_reached(wake, timer.now()) || has_event()) return;
        cpu::wait_for_interrupt();
    }
}

void turn() {
    can.acknowledge_event();
    while (const auto received = can.receive()) the_node->on_frame(received->frame, received->received);
    const NodeTime now = timer.now();
    can.poll(now);
    search_rates(now);
    the_node->poll(now);
    report.update(*the_node, can, now);
    if (the_node->is_reset_requested()) cpu::reset();
    sleep_until(wake_time(light.poll(timer.now())));
}

}  // namespace
}  // namespace octoskin::stm32g4

extern "C" {
void application() {
    octoskin::stm32g4::start();
    while (true) octoskin::stm32g4::turn();
}
void can_interrupt() {
    octoskin::stm32g4::can.on_interrupt();
}
void timer_interrupt() {
    octoskin::stm32g4::timer.on_interrupt();
}
void serial_interrupt() {
    octoskin::stm32g4::serial.on_interrupt();
}
void i2c1_interrupt() {
    octoskin::stm32g4::i2c_controllers[0].on_interrupt();
}
void i2c2_interrupt() {
    octoskin::stm32g4::i2c_controllers[1].on_interrupt();
}
void i2c3_interrupt() {
    octoskin::stm32g4::i2c_controllers[2].on_interrupt();
}
void i2c4_interrupt() {
    octoskin::stm32g4::i2c_controllers[3].on_interrupt();
}
}
