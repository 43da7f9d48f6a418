#include "hw/sim/stm32g474/nucleo_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>
#include <utility>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kFlashBase = 0x0800'0000;
constexpr std::uint32_t kFlashBytes = 512 * 1024;
constexpr std::uint32_t kRamBase = 0x2000'0000;
constexpr std::uint32_t kRamBytes = 128 * 1024;
constexpr std::uint32_t kCcmOffset = 0x1'8000;  // CCM SRAM is mapped at two addresses
constexpr std::uint32_t kCcmBase = 0x1000'0000;
constexpr std::uint32_t kSystemMemoryBase = 0x1FFF'7000;
constexpr std::uint32_t kUniqueIdOffset = 0x590;
constexpr std::uint32_t kFlashSizeOffset = 0x5E0;

// Enables: RCC's register and bit.
constexpr std::uint32_t kAhb1 = 0x48;
constexpr std::uint32_t kAhb2 = 0x4C;
constexpr std::uint32_t kApb1 = 0x58;
constexpr std::uint32_t kApb1Second = 0x5C;
constexpr std::uint32_t kApb2 = 0x60;

constexpr RegisterSpec kDebugRegisters[] = {
    {0x00, "IDCODE", 0x2003'6469, 0},   {0x04, "CR", 0, 0xE7},
    {0x08, "APB1FZR1", 0, 0xC060'1C3F}, {0x0C, "APB1FZR2", 0, 0x2},
    {0x10, "APB2FZR", 0, 0x3C17'2800},
};

constexpr std::uint32_t kCanFunction = 9;
constexpr std::uint32_t kSerialFunction = 12;
constexpr std::uint32_t kPortA = 0;
constexpr std::uint32_t kPortB = 1;
constexpr std::uint32_t kPortC = 2;
constexpr std::uint32_t kFirstDataReadyPin = 12;  // PB12 to PB15

}  // namespace

// Datasheet DS12288, alternate functions.
const std::array<NucleoBoard::I2cPins, NucleoBoard::kI2cBuses> NucleoBoard::kI2cPins = {{
    {{0, 15}, {1, 7}, 4},  // PA15, PB7
    {{0, 9}, {0, 8}, 4},   // PA9, PA8
    {{2, 8}, {2, 9}, 8},   // PC8, PC9
    {{2, 6}, {2, 7}, 8},   // PC6, PC7
}};
// PA0, PA1, PA4, PB0, PA6, PA7, PB10, PB5
const std::array<NucleoBoard::Pin, 8> NucleoBoard::kXshutPins = {
    {{0, 0}, {0, 1}, {0, 4}, {1, 0}, {0, 6}, {0, 7}, {1, 10}, {1, 5}}};

NucleoBoard::NucleoBoard(const NucleoOptions& options, const ElfImage& image,
                         std::span<const std::uint8_t> configuration)
    : rate_(1.0 + options.drift_ppm * 1e-6),
      image_(image),
      flash_(kFlashBytes, 0xFF),
      ram_(kRamBytes),
      system_memory_(0x1000, 0xFF) {
    load(image, configuration);
    fill_ram(options.seed);
    std::copy(options.unique_id.begin(), options.unique_id.end(), system_memory_.begin() + kUniqueIdOffset);
    const std::uint16_t flash_kib = kFlashBytes / 1024;
    std::memcpy(system_memory_.data() + kFlashSizeOffset, &flash_kib, sizeof flash_kib);
    make_peripherals(options);
    place_peripherals();
    const std::array memory = {MemoryRegion{kFlashBase, flash_, false}, MemoryRegion{kRamBase, ram_, true},
                               MemoryRegion{kCcmBase, std::span(ram_).subspan(kCcmOffset), true},
                               MemoryRegion{kSystemMemoryBase, system_memory_, false}};
    core_ = std::make_unique<CortexM4>(now_, log_, memory, *bus_, options.cycles_per_instruction);
    core_->attach(*control_);
    if (options.damaged_flash) {
        core_->watch_reads(*options.damaged_flash, 8, [this, offset = *options.damaged_flash - kFlashBase] {
            flash_interface_->on_double_error(offset);
        });
    }
    bus_->attach(*core_);
    connect_pins();
    reset(ResetFlag::brown_out);
    reset_count_ = 0;
}

NucleoBoard::~NucleoBoard() = default;

void NucleoBoard::load(const ElfImage& image, std::span<const std::uint8_t> configuration) {
    for (const image::ElfSegment& segment : image.segments()) {
        const std::uint32_t offset = segment.physical_address - kFlashBase;
        if (offset > kFlashBytes || segment.bytes.size() > kFlashBytes - offset) {
            throw std::runtime_error(
                fmt::format("the program has bytes at 0x{:08X}, outside flash", segment.physical_address));
        }
        std::ranges::copy(segment.bytes, flash_.begin() + offset);
    }
    const std::uint32_t page = kConfigurationPage - kFlashBase;
    if (configuration.size() > kFlashBytes - page)
        throw std::runtime_error("the configuration is larger than a page of flash");
    std::ranges::copy(configuration, flash_.begin() + page);
}

void NucleoBoard::fill_ram(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::uint8_t& byte : ram_) byte = static_cast<std::uint8_t>(random() & 0xFFU);
}

void NucleoBoard::make_peripherals(const NucleoOptions& options) {
    const Surroundings env{now_, log_, *this};
    control_ = std::make_unique<SystemControl>(
        now_, log_,
        SystemControlHooks{[this] { return rcc_->hclk_hz(); }, [this] { return core_->cycles(); },
                           [this] {
                               wanted_reset_ = ResetFlag::software;
                               core_->interrupt_slice();
                           }});
    rcc_ = std::make_unique<Rcc>(env, options.crystal,
                                 Rcc::Hooks{[this] { bus_->advance_all(); }, [this] { after_clock_change(); },
                                            [this](ClockEnable clock) { bus_->reset_clocked_by(clock); }});
    pwr_ = std::make_unique<Pwr>(env, [this] { after_clock_change(); });
    flash_interface_ = std::make_unique<FlashInterface>(env, *pwr_);
    for (std::size_t i = 0; i < ports_.size(); ++i)
        ports_.at(i) = std::make_unique<GpioPort>(env, static_cast<char>('A' + i));
    timer2_ = std::make_unique<Timer2>(env, [this] { return rcc_->timer1_hz(); });
    iwdg_ = std::make_unique<Iwdg>(env, options.lsi_hz, [this] {
        wanted_reset_ = ResetFlag::watchdog;
        core_->interrupt_slice();
    });
    lpuart_ =
        std::make_unique<Lpuart>(env, Lpuart::Hooks{[this] { return rcc_->lpuart_hz(); },
                                                    [this] {
                                                        return has_function({kPortA, 2}, kSerialFunction);
                                                    },
                                                    [this](char byte) { serial_text_.push_back(byte); }});
    for (std::size_t i = 0; i < kI2cBuses; ++i) {
        const auto number = static_cast<std::uint32_t>(i + 1);
        const I2cPins& pins = kI2cPins.at(i);
        const auto is_open = [this, pins](const Pin& pin) {
            return has_function(pin, pins.function) && ports_.at(pin.port)->is_open_drain(pin.number);
        };
        i2c_.at(i) = std::make_unique<I2c>(
            env, number, wires_.at(i), options.edges,
            I2c::Hooks{[this, number] { return rcc_->i2c_hz(number); },
                       [is_open, pins] { return is_open(pins.scl) && is_open(pins.sda); },
                       [this] { return now(); }});
    }
    fdcan_ram_ = std::make_unique<FdcanRam>(env);
    CanBusSide& bus_side = *this;
    fdcan_ = std::make_unique<Fdcan>(
        env, *fdcan_ram_, bus_side, options.bit_rates,
        Fdcan::Hooks{
            [this] { return rcc_->fdcan_hz(); }, [this] { return rcc_->is_fdcan_from_crystal(); },
            [this] {
                return has_function({kPortA, 11}, kCanFunction) && has_function({kPortA, 12}, kCanFunction);
            }});
    make_external_interrupts(env);
    debug_ = std::make_unique<PlainRegisters>(env, "DBGMCU", kDebugRegisters);
    chain_ = std::make_unique<ShiftRegisterChain>([this](std::uint32_t output, bool is_high) {
        if (on_xshut_) on_xshut_(output, is_high);
        exti_->sample();
    });
}

void NucleoBoard::make_external_interrupts(const Surroundings& env) {
    syscfg_ = std::make_unique<Syscfg>(env, [this] { exti_->sample(); });
    const auto source = [this](std::uint32_t line) -> const GpioPort& {
        return *ports_.at(std::min<std::size_t>(syscfg_->port_of(line), ports_.size() - 1));
    };
    exti_ = std::make_unique<Exti>(
        env, Exti::Hooks{[source](std::uint32_t line) { return source(line).level(line); },
                         [source](std::uint32_t line) { return source(line).mode(line) == PinMode::analog; },
                         [this](std::uint32_t lines) { return next_pin_change(lines); }});
}

/// Only the pins of the data-ready lines change by themselves.
BoardTime NucleoBoard::next_pin_change(std::uint32_t lines) const {
    BoardTime next = kNever;
    for (std::uint32_t bus = 0; bus < kI2cBuses; ++bus) {
        const std::uint32_t line = kFirstDataReadyPin + bus;
        if ((lines >> line & 1U) == 0 || syscfg_->port_of(line) != kPortB) continue;
        const auto change = data_ready_.at(bus).next_change(now());
        // Rounding must not give a time in the past, which would never be reached.
        if (change) next = std::min(next, std::max(to_board_time(*change), now_ + kPsPerUs));
    }
    return next;
}

void NucleoBoard::place_peripherals() {
    bus_ = std::make_unique<SystemBus>(log_, *rcc_, *control_);
    bus_->add(*timer2_, 0x4000'0000, 0x400, ClockEnable{kApb1, 0});
    bus_->add(*iwdg_, 0x4000'3000, 0x400, std::nullopt);
    bus_->add(*i2c_[0], 0x4000'5400, 0x400, ClockEnable{kApb1, 21});
    bus_->add(*i2c_[1], 0x4000'5800, 0x400, ClockEnable{kApb1, 22});
    bus_->add(*fdcan_, 0x4000'6400, 0x400, ClockEnable{kApb1, 25});
    bus_->add(*pwr_, 0x4000'7000, 0x400, ClockEnable{kApb1, 28});
    bus_->add(*i2c_[2], 0x4000'7800, 0x400, ClockEnable{kApb1, 30});
    bus_->add(*lpuart_, 0x4000'8000, 0x400, ClockEnable{kApb1Second, 0});
    bus_->add(*i2c_[3], 0x4000'8400, 0x400, ClockEnable{kApb1Second, 1});
    bus_->add(*fdcan_ram_, 0x4000'A400, 3 * 0x350, ClockEnable{kApb1, 25});
    bus_->add(*syscfg_, 0x4001'0000, 0x30, ClockEnable{kApb2, 0});
    bus_->add(*exti_, 0x4001'0400, 0x400, std::nullopt);
    bus_->add(*rcc_, 0x4002'1000, 0x400, std::nullopt);
    bus_->add(*flash_interface_, 0x4002'2000, 0x400, ClockEnable{kAhb1, 8});
    for (std::uint32_t i = 0; i < ports_.size(); ++i)
        bus_->add(*ports_.at(i), 0x4800'0000 + 0x400 * i, 0x400, ClockEnable{kAhb2, i});
    bus_->add(*debug_, 0xE004'2000, 0x400, std::nullopt);
}

void NucleoBoard::connect_pins() {
    ports_[kPortC]->on_change([this] { drive_chain(); });
    for (const std::uint32_t port : {kPortA, kPortB}) ports_[port]->on_change([this] { drive_xshut_pins(); });
    for (std::size_t bus = 0; bus < kI2cBuses; ++bus) {
        const I2cPins& pins = kI2cPins.at(bus);
        ports_.at(pins.scl.port)->on_change([this, bus] { drive_i2c(bus); });
        if (pins.sda.port != pins.scl.port)
            ports_.at(pins.sda.port)->on_change([this, bus] { drive_i2c(bus); });
        ports_.at(pins.scl.port)->connect(pins.scl.number, [this, bus] {
            return !wires_.at(bus).is_scl_low();
        });
        ports_.at(pins.sda.port)->connect(pins.sda.number, [this, bus] {
            return !wires_.at(bus).is_sda_low(now());
        });
        wires_.at(bus).on_stop([this] { exti_->sample(); });
        ports_[kPortB]->connect(kFirstDataReadyPin + static_cast<std::uint32_t>(bus),
                                [this, bus] { return data_ready_.at(bus).is_high(now()); });
    }
    for (const auto& port : ports_) port->on_change([this] { exti_->sample(); });
}

bool NucleoBoard::has_function(const Pin& pin, std::uint32_t function) const {
    const GpioPort& port = *ports_.at(pin.port);
    return port.mode(pin.number) == PinMode::alternate && port.alternate_function(pin.number) == function;
}

// PC0 SER, PC1 SRCLK, PC2 RCLK, PC3 OE with a pull-up.
void NucleoBoard::drive_chain() {
    const GpioPort& port = *ports_[kPortC];
    chain_->drive({port.drives_high(0), port.drives_high(1), port.drives_high(2), !port.drives_low(3)});
}

void NucleoBoard::drive_xshut_pins() {
    for (std::uint32_t i = 0; i < kXshutPins.size(); ++i) {
        const GpioPort& port = *ports_.at(kXshutPins.at(i).port);
        const std::uint32_t line = ShiftRegisterChain::kOutputs + i;
        if (port.drives_high(kXshutPins.at(i).number))
            log_.report(Rule::pin_function, fmt::format("XSHUT line {} is driven high", line));
        const bool is_high = !port.drives_low(kXshutPins.at(i).number);
        const bool was_high = std::exchange(xshut_pin_levels_.at(i), is_high);
        if (is_high != was_high && on_xshut_) on_xshut_(line, is_high);
    }
}

bool NucleoBoard::is_xshut_high(std::uint32_t line) const {
    constexpr std::uint32_t kFirstPin = ShiftRegisterChain::kOutputs;
    return line < kFirstPin ? chain_->output(line) : xshut_pin_levels_.at(line - kFirstPin);
}

void NucleoBoard::drive_i2c(std::size_t bus) {
    const I2cPins& pins = kI2cPins.at(bus);
    const auto is_low = [this](const Pin& pin) { return ports_.at(pin.port)->drives_low(pin.number); };
    for (const Pin& pin : {pins.scl, pins.sda}) {
        if (ports_.at(pin.port)->drives_high(pin.number))
            log_.report(Rule::pin_function, fmt::format("I2C{}: a line is driven high", bus + 1));
    }
    wires_.at(bus).drive(is_low(pins.scl), is_low(pins.sda), now());
}

void NucleoBoard::after_clock_change() {
    core_->set_hclk(rcc_->hclk_hz());
    flash_interface_->check_latency(rcc_->hclk_hz());
}

void NucleoBoard::set_line(std::uint32_t irq, bool is_high) {
    control_->nvic().set_line(irq, is_high);
}

void NucleoBoard::pend_nmi() {
    control_->nvic().pend(exception::kNmi);
}

void NucleoBoard::offer(const std::optional<wire::CanFrame>& frame) {
    if (on_offer_) on_offer_(frame);
}

SimTime NucleoBoard::true_time(BoardTime time) const {
    return {static_cast<std::int64_t>(std::floor(static_cast<double>(time.ps) * 1e-6 / rate_))};
}

BoardTime NucleoBoard::to_board_time(SimTime time) const {
    return {static_cast<std::int64_t>(std::ceil(static_cast<double>(time.us) * 1e6 * rate_))};
}

void NucleoBoard::run_until(SimTime time) {
    const BoardTime end = to_board_time(time);
    while (now_ < end) {
        bus_->advance_due(now_);
        if (wanted_reset_) reset(*wanted_reset_);
        const BoardTime next = std::min(end, bus_->next_event());
        if (core_->is_idle() || rcc_->is_stopped()) {
            now_ = std::max(now_, next);
        } else {
            core_->run(next);
        }
    }
}

void NucleoBoard::reset(ResetFlag flag) {
    wanted_reset_.reset();
    ++reset_count_;
    bus_->reset_all();
    rcc_->note_reset(flag);
    control_->reset();
    core_->reset();
    after_clock_change();
}

void NucleoBoard::cycle_power() {
    fill_ram(reset_count_ + 1);
    reset(ResetFlag::brown_out);
}

std::uint32_t NucleoBoard::ram_word(std::uint32_t address) const {
    std::uint32_t value = 0;
    std::memcpy(&value, ram_.data() + (address - kRamBase), sizeof value);
    return value;
}

std::vector<std::uint16_t> NucleoBoard::patch(std::uint32_t address,
                                              const std::vector<std::uint16_t>& instructions) {
    std::vector<std::uint16_t> before(instructions.size());
    std::memcpy(before.data(), flash_.data() + (address - kFlashBase), 2 * before.size());
    core_->patch(address, instructions);
    return before;
}

void NucleoBoard::jump(const std::string& symbol) {
    const auto address = image_.address_of(symbol);
    if (!address) throw std::runtime_error(fmt::format("the program has no symbol '{}'", symbol));
    core_->jump(*address);
}

}  // namespace octoskin::sim::stm32
