// The node on a NUCLEO-G474RE: constructs the parts, connects them, and runs the loop.
#include <algorithm>
#include <array>
#include <optional>

#include "common/config/image_identity.hpp"
#include "common/config/node_config.hpp"
#include "firmware/app/stm32g4_node/report.hpp"
#include "firmware/core/node.hpp"
#include "firmware/core/time_bracket.hpp"
#include "firmware/port/stm32g4/can_bit_timing.hpp"
#include "firmware/port/stm32g4/can_controller.hpp"
#include "firmware/port/stm32g4/can_entry.hpp"
#include "firmware/port/stm32g4/clock_plan.hpp"
#include "firmware/port/stm32g4/clocks.hpp"
#include "firmware/port/stm32g4/configuration_page.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/data_ready_lines.hpp"
#include "firmware/port/stm32g4/fault_handlers.hpp"
#include "firmware/port/stm32g4/i2c_controller.hpp"
#include "firmware/port/stm32g4/i2c_timing.hpp"
#include "firmware/port/stm32g4/interrupt_handlers.hpp"
#include "firmware/port/stm32g4/microsecond_timer.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/reset_cause.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"
#include "firmware/port/stm32g4/unique_id.hpp"
#include "firmware/port/stm32g4/watchdog.hpp"
#include "firmware/port/stm32g4/xshut_lines.hpp"

namespace octoskin::stm32g4 {
namespace {

// Read by the flashing program from the image, not by this program; the linker must keep it.
[[gnu::used, gnu::section(".identity")]] constexpr auto kIdentity = image_identity(kNodeConfigLayout);

constexpr std::uint8_t kBoardType = 1;  // hw/boards/nucleo_g474re.yaml

constexpr Microseconds kSayMax{40'000};  // time for two and a half lines of text
constexpr Microseconds kSecond{1'000'000};
constexpr std::uint32_t kRestTurnsPerSecond = 50;

constinit IndependentWatchdog watchdog;
constinit MicrosecondTimer timer;
constinit SerialPort serial;
constinit StatusLight light;
constinit Report report{serial, light};
constinit XshutLines xshut;
constinit CanController can{timer};
constinit CanEntry can_entry{can};
constinit std::array<I2cController, kI2cWirings.size()> i2c_controllers{
    I2cController{kI2cWirings[0], timer}, I2cController{kI2cWirings[1], timer},
    I2cController{kI2cWirings[2], timer}, I2cController{kI2cWirings[3], timer}};
constinit std::array<i2c::Bus*, kI2cWirings.size()> buses{&i2c_controllers[0], &i2c_controllers[1],
                                                          &i2c_controllers[2], &i2c_controllers[3]};
constinit DataReadyLines data_ready;
constinit NodeConfig config = without_configuration();
constinit std::optional<node::Node> the_node;
constinit bool is_crystal_missed = false;
constinit NodeTime look_for_crystal_at;

/// A missing crystal was already reported, so `can_dead` is not reported then.
void enter_can(const std::optional<CanRates>& rates, const Clocks& clocks) {
    can_entry.begin(rates, config.node_id, clocks.can_hz, timer.now());
    if (clocks.can_hz != 0 && !can.is_started() && !can.is_listening()) report.can_dead();
}

void start_buses(const Clocks& clocks) {
    const auto timing = i2c_timing(clocks.core_hz, config.i2c_hz);
    if (timing) {
        for (I2cController& controller : i2c_controllers) controller.start(*timing);
        data_ready.start(config.data_ready_buses);
    }
    const bool has_rates = is_possible(rates_of(config), kCanHz);
    enter_can(has_rates ? std::optional(rates_of(config)) : std::nullopt, clocks);
    if (timing && has_rates && config.board_type == kBoardType) return report.config_accepted(config);
    report.config_unsuitable(config);
    // An `i2c_hz` of 0 makes the configuration invalid: the node does not range and reports it. The node
    // itself detects a wrong board type.
    if (!timing || !has_rates) config.i2c_hz = 0;
}

void load_configuration(const Clocks& clocks) {
    const auto decoded = decode_node_config(configuration_page());
    const bool is_damaged = is_configuration_damaged();
    if (decoded && !is_damaged) {
        config = *decoded;
        start_buses(clocks);
    } else {
        report.config_refused(is_damaged ? NodeConfigError::wrong_crc : decoded.error());
        enter_can(std::nullopt, clocks);
    }
}

/// Waits, at most `kSayMax`, until all text has been sent: the next step may fail as the last one did.
void finish_saying() {
    const NodeTime begun = timer.now();
    while (!serial.is_quiet() && elapsed(begun, timer.now()) < kSayMax) {
    }
}

void start_reporting(std::uint32_t core_hz) {
    cpu::enable(Interrupt::tim2, cpu::Priority::text);
    enable_pins();
    light.start();
    serial.start(core_hz);
}

bool has_event() {
    return can.has_event() || data_ready.has_event() ||
           std::any_of(i2c_controllers.begin(), i2c_controllers.end(),
                       [](const I2cController& controller) { return controller.has_ended(); });
}

/// Sleeps until `wake` or an event. Interrupts that only move a byte wake the core, but do not end the wait.
/// Interrupts are masked between the check and the sleep; one that becomes pending in between ends the sleep
/// at once.
void sleep_until(NodeTime wake) {
    timer.wake_at(wake);
    while (true) {
        const cpu::MaskedSection masked;
        if (is_reached(wake, timer.now()) || has_event()) return;
        cpu::wait_for_interrupt();
    }
}

/// Start-up failed repeatedly: waits with only the light and the serial port active. CAN, buses and sensors
/// stay as the reset left them.
void rest(const std::optional<Fault>& last, std::uint32_t seconds) {
    timer.start(kInternalHz);
    start_reporting(kInternalHz);
    light.set(true);
    report.start_up_failing(seconds);
    if (last) report.fault(*last);
    for (std::uint32_t turn = 0; turn < seconds * kRestTurnsPerSecond; ++turn) {
        sleep_until(timer.now() + kSecond / kRestTurnsPerSecond);
        watchdog.feed();
    }
}

void start() {
    watchdog.start();
    const std::optional<Fault> last = fault_record().read();
    const wire::ResetCause cause = reset_cause(take_reset_flags(), last.has_value());
    node::RunStart run = node::begin_start_up(kept_memory(), cause, {});
    if (!last || cause == wire::ResetCause::power_on) fault_record().write({});
    if (run.is_start_up_failing) {
        rest(last, node::safe_mode_s(run.record.retries));
        node::retry_start_up(kept_memory(), run);
    }
    const Clocks clocks = start_clocks(timer);
    start_reporting(clocks.core_hz);
    xshut.start();
    report.started(OCTOSKIN_BUILD_ID, run.cause, clocks);
    if (last && last->kind != wire::FaultKind::none) {
        report.fault(*last);
        finish_saying();
    }
    load_configuration(clocks);
    is_crystal_missed = clocks.can_hz == 0;
    look_for_crystal_at = timer.now() + kSecond;
    const node::Identity identity{.uid = unique_id(),
                                  .build_id = OCTOSKIN_BUILD_ID,
                                  .board_type = kBoardType,
                                  .reset_cause = cause,
                                  .run = run};
    const node::Ports ports{.buses = buses,
                            .xshut = xshut,
                            .can = can,
                            .data_ready = &data_ready,
                            .indicator = &light,
                            .watchdog = &watchdog,
                            .kept = &kept_memory()};
    the_node.emplace(config, identity, ports, timer.now());
}

/// A node without its crystal is silent on CAN, so a reset loses nothing once the crystal runs. The reset
/// counts as one by a fault: an unstable crystal ends in safe mode, in which the crystal is not checked.
void look_for_crystal(NodeTime now) {
    if (!is_crystal_missed || !is_reached(look_for_crystal_at, now)) return;
    look_for_crystal_at = now + kSecond;
    const bool is_safe = node::load(kept_memory()).mode == node::RunMode::safe;
    if (is_safe || !is_crystal_running()) return;
    report.crystal_runs();
    finish_saying();
    record_and_reset({.kind = wire::FaultKind::clock_fault});
}

/// Next time at which the loop must run without an event, at most 20 ms ahead because of the watchdog. If
/// this wake-up is missed, the watchdog resets the chip: it has its own clock.
NodeTime wake_time(NodeTime light_due) {
    const NodeTime now = timer.now();
    NodeTime wake = node::earlier_of(light_due, the_node->wake_time(now));
    if (const auto due = can.wake_time()) wake = node::earlier_of(wake, *due);
    for (const I2cController& controller : i2c_controllers) {
        if (const auto due = controller.deadline()) wake = node::earlier_of(wake, *due);
    }
    return wake;
}

void turn() {
    can.acknowledge_event();
    data_ready.acknowledge_event();
    while (const auto received = can.receive()) the_node->on_frame(received->frame, received->received);
    const NodeTime now = timer.now();
    can.poll(now);
    can_entry.poll(now);
    look_for_crystal(now);
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
void data_ready_interrupt() {
    octoskin::stm32g4::data_ready.on_interrupt();
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
