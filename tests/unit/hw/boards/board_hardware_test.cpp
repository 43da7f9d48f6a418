// The board's file against the firmware: its own parts are started in a test's address space, and the pins
// that they set up are read from the ports' registers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "firmware/port/stm32g4/can_controller.hpp"
#include "firmware/port/stm32g4/clock_plan.hpp"
#include "firmware/port/stm32g4/configuration_page.hpp"
#include "firmware/port/stm32g4/data_ready_lines.hpp"
#include "firmware/port/stm32g4/i2c_controller.hpp"
#include "firmware/port/stm32g4/i2c_timing.hpp"
#include "firmware/port/stm32g4/registers/interrupts.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"
#include "firmware/port/stm32g4/xshut_chain.hpp"
#include "firmware/port/stm32g4/xshut_lines.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/stm32g4/address_space.hpp"
#include "tests/unit/hw/boards/shipped_board.hpp"

namespace octoskin::rig {
namespace {

using stm32g4::Address;

/// What a port's registers say of a pin. RM0440, "GPIO registers".
struct PinState {
    std::uint32_t mode = 3;  ///< 0 input, 1 output, 2 alternate, 3 analog
    std::uint32_t alternate = 0;
    bool is_open_drain = false;
    bool is_pulled_up = false;
    friend bool operator==(const PinState&, const PinState&) = default;
    friend std::ostream& operator<<(std::ostream& out, const PinState& state) {
        return out << "mode " << state.mode << " function " << state.alternate
                   << (state.is_open_drain ? " open drain" : "") << (state.is_pulled_up ? " pulled up" : "");
    }
};

constexpr Address port_base(char port) {
    return 0x4800'0000U + 0x400U * static_cast<Address>(port - 'A');
}

PinState state_of(test::AddressSpace& space, const BoardPin& pin) {
    const Address base = port_base(pin.port);
    PinState state;
    state.mode = space[base] >> (2U * pin.number) & 3U;
    state.is_open_drain = (space[base + 0x04] >> pin.number & 1U) != 0;
    state.is_pulled_up = (space[base + 0x0C] >> (2U * pin.number) & 3U) == 1;
    if (state.mode == 2)
        state.alternate = space[base + 0x20 + 4U * (pin.number / 8U)] >> (4U * (pin.number % 8U)) & 15U;
    return state;
}

class FirmwareOnBoard : public testing::Test {
  protected:
    FirmwareOnBoard() {
        // After reset. RM0440, "GPIO registers": all analog but the debug port's pins.
        for (char port = 'A'; port <= 'G'; ++port) space_[port_base(port)] = 0xFFFF'FFFF;
        space_[port_base('A')] = 0xABFF'FFFF;
        space_[port_base('B')] = 0xFFFF'FEBF;
        space_[0x4000'6418] = 1;  // FDCAN1's CCCR: INIT
    }
    [[nodiscard]] std::map<BoardPin, PinState> states() {
        std::map<BoardPin, PinState> all;
        for (char port = 'A'; port <= 'G'; ++port) {
            for (std::uint8_t number = 0; number < 16; ++number)
                all[{port, number}] = state_of(space_, {port, number});
        }
        return all;
    }
    /// The pins that `action` changes.
    template <class Action>
    std::map<BoardPin, PinState> set_up_by(const Action& action) {
        const auto before = states();
        action();
        std::map<BoardPin, PinState> changed;
        for (const auto& [pin, state] : states()) {
            if (state != before.at(pin)) changed[pin] = state;
        }
        return changed;
    }
    /// What the file says of the signals that begin with `prefix`.
    [[nodiscard]] std::map<BoardPin, PinState> described(const std::string& prefix) const {
        std::map<BoardPin, PinState> all;
        for (const BoardSignal& signal : board_.signals) {
            if (!signal.signal.starts_with(prefix)) continue;
            const bool is_input = signal.function == "input";
            all[signal.pin] = {.mode = signal.alternate ? 2U
                                       : is_input       ? 0U
                                                        : 1U,
                               .alternate = signal.alternate.value_or(0),
                               .is_open_drain = signal.is_open_drain,
                               .is_pulled_up = signal.is_pulled_up};
        }
        return all;
    }
    [[nodiscard]] BoardPin pin_of(const std::string& signal) const {
        for (const BoardSignal& each : board_.signals) {
            if (each.signal == signal) return each.pin;
        }
        ADD_FAILURE() << "no signal " << signal;
        return {};
    }

    BoardHardware board_ = nucleo();
    test::AddressSpace space_;
    stm32g4::MicrosecondTimer timer_;
};

TEST_F(FirmwareOnBoard, sets_up_exactly_the_pins_of_the_file) {
    std::map<BoardPin, PinState> used = set_up_by([&] {
        stm32g4::StatusLight().start();
        stm32g4::XshutLines().start();
        stm32g4::DataReadyLines().start(0b1111);
        stm32g4::SerialPort().start(stm32g4::kCrystalPlan.core_hz());
        stm32g4::CanController can{timer_};
        EXPECT_TRUE(can.start({.nominal = 1'000'000, .data = 5'000'000, .has_fd = true}, 1, stm32g4::kCanHz));
        for (const stm32g4::I2cWiring& wiring : stm32g4::kI2cWirings)
            stm32g4::I2cController(wiring, timer_).start(0);
    });
    EXPECT_EQ(used, described(""));
}

TEST_F(FirmwareOnBoard, each_part_sets_up_its_own_pins) {
    EXPECT_EQ(set_up_by([] { stm32g4::StatusLight().start(); }), described("light"));
    EXPECT_EQ(set_up_by([] { stm32g4::XshutChain().start(); }), described("xshut_"));
    EXPECT_EQ(set_up_by([] { stm32g4::XshutLines().start(); }), described("xshut4"))
        << "beside the chain's, which are set up by now";
    EXPECT_EQ(set_up_by([] { stm32g4::SerialPort().start(160'000'000); }), described("serial_"));
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        const auto buses = static_cast<std::uint8_t>(1U << bus);
        EXPECT_EQ(set_up_by([=] { stm32g4::DataReadyLines().start(buses); }),
                  described("data_ready" + std::to_string(bus)));
    }
    for (std::size_t bus = 0; bus < stm32g4::kI2cWirings.size(); ++bus) {
        EXPECT_EQ(set_up_by([&] { stm32g4::I2cController(stm32g4::kI2cWirings[bus], timer_).start(0); }),
                  described("i2c" + std::to_string(bus)));
    }
}

TEST_F(FirmwareOnBoard, scl_and_sda_are_not_swapped) {
    for (std::size_t bus = 0; bus < stm32g4::kI2cWirings.size(); ++bus) {
        const std::string name = "i2c" + std::to_string(bus);
        const stm32g4::I2cWiring& wiring = stm32g4::kI2cWirings[bus];
        const auto scl = set_up_by([&] { wiring.scl.make_output(stm32g4::Drive::open_drain); });
        ASSERT_EQ(scl.size(), 1U);
        EXPECT_EQ(scl.begin()->first, pin_of(name + "_scl"));
        const auto sda = set_up_by([&] { wiring.sda.make_output(stm32g4::Drive::open_drain); });
        ASSERT_EQ(sda.size(), 1U);
        EXPECT_EQ(sda.begin()->first, pin_of(name + "_sda"));
    }
}

TEST_F(FirmwareOnBoard, moves_the_chain_by_the_pins_of_the_file) {
    std::map<char, std::vector<std::uint32_t>> writes;
    for (const char port : {'A', 'B', 'C'}) {
        space_.on_write(port_base(port) + 0x18, [&writes, port](std::uint32_t&, std::uint32_t value) {
            writes[port].push_back(value);
        });
    }
    stm32g4::XshutChain chain;
    chain.start();
    writes.clear();
    chain.set(0, true);  // the last of forty bits is high, all others are low
    ASSERT_EQ(writes.size(), 1U);
    const auto rises_of = [&](const std::string& signal) {
        const BoardPin pin = pin_of(signal);
        const auto& all = writes[pin.port];
        return std::count(all.begin(), all.end(), 1U << pin.number);
    };
    EXPECT_EQ(rises_of("xshut_shift"), 40);
    EXPECT_EQ(rises_of("xshut_show"), 1);
    EXPECT_EQ(rises_of("xshut_data"), 1);
    EXPECT_EQ(rises_of("xshut_outputs_off"), 0);
}

TEST_F(FirmwareOnBoard, moves_lines_40_to_47_by_the_pins_of_the_file) {
    stm32g4::XshutLines lines;
    lines.start();
    for (std::uint8_t line = 40; line < 48; ++line) {
        space_.forget_writes();
        lines.set(line, true);
        const BoardPin pin = pin_of("xshut" + std::to_string(line));
        const std::vector<test::AddressSpace::Write> rise = {{port_base(pin.port) + 0x18, 1U << pin.number}};
        EXPECT_EQ(space_.writes(), rise) << int{line};
    }
}

// --- the chip's own facts, from its documents

/// Datasheet DS12288, "Alternate function", as far as the file needs it.
const std::map<std::string, std::map<std::string, int>> kAlternateFunctions = {
    {"PA15", {{"I2C1_SCL", 4}, {"FDCAN3_TX", 11}}},
    {"PB7", {{"I2C1_SDA", 4}, {"I2C4_SDA", 3}}},
    {"PB9", {{"I2C1_SDA", 4}, {"FDCAN1_TX", 9}}},
    {"PA9", {{"I2C2_SCL", 4}}},
    {"PC4", {{"I2C2_SCL", 4}}},
    {"PA8", {{"I2C2_SDA", 4}, {"I2C3_SCL", 2}, {"FDCAN3_RX", 11}}},
    {"PC8", {{"I2C3_SCL", 8}}},
    {"PC9", {{"I2C3_SDA", 8}}},
    {"PC11", {{"I2C3_SDA", 8}}},
    {"PC6", {{"I2C4_SCL", 8}}},
    {"PC7", {{"I2C4_SDA", 8}}},
    {"PA11", {{"FDCAN1_RX", 9}}},
    {"PA12", {{"FDCAN1_TX", 9}}},
    {"PB12", {{"FDCAN2_RX", 9}}},
    {"PB13", {{"FDCAN2_TX", 9}}},
    {"PA2", {{"LPUART1_TX", 12}}},
    {"PA3", {{"LPUART1_RX", 12}}},
};

TEST(NucleoBoard, every_alternate_function_is_the_datasheets) {
    for (const BoardSignal& signal : nucleo().signals) {
        if (!signal.alternate) continue;
        ASSERT_TRUE(kAlternateFunctions.contains(text(signal.pin))) << text(signal.pin);
        const auto& functions = kAlternateFunctions.at(text(signal.pin));
        ASSERT_TRUE(functions.contains(signal.function)) << text(signal.pin) << " has no " << signal.function;
        EXPECT_EQ(functions.at(signal.function), *signal.alternate) << text(signal.pin);
    }
}

TEST(NucleoBoard, no_signal_is_on_a_pin_that_something_else_needs) {
    // Debug port, crystals, BOOT0, button; and the two pins with pull-downs of their own (errata, UCPD).
    const std::set<std::string> kept_free = {"PA13", "PA14", "PB3",  "PB4", "PB6", "PB8",
                                             "PC13", "PC14", "PC15", "PF0", "PF1"};
    std::set<BoardPin> seen;
    for (const BoardSignal& signal : nucleo().signals) {
        EXPECT_FALSE(kept_free.contains(text(signal.pin))) << signal.signal;
        EXPECT_TRUE(seen.insert(signal.pin).second) << text(signal.pin);
    }
}

/// UM2505, "ST morpho connectors", of the pins in use.
TEST(NucleoBoard, the_connectors_are_the_boards) {
    const std::map<std::string, std::string> morpho = {
        {"PA15", "CN7-17"},  {"PB7", "CN7-21"},   {"PC0", "CN7-38"},   {"PC1", "CN7-36"},
        {"PC2", "CN7-35"},   {"PC3", "CN7-37"},   {"PC9", "CN10-1"},   {"PC8", "CN10-2"},
        {"PC6", "CN10-4"},   {"PA5", "CN10-11"},  {"PA12", "CN10-12"}, {"PA11", "CN10-14"},
        {"PC7", "CN10-19"},  {"PA9", "CN10-21"},  {"PA8", "CN10-23"},  {"PA2", "CN10-35"},
        {"PB12", "CN10-16"}, {"PB13", "CN10-30"}, {"PB14", "CN10-28"}, {"PB15", "CN10-26"},
        {"PA0", "CN7-28"},   {"PA1", "CN7-30"},   {"PA4", "CN7-32"},   {"PB0", "CN7-34"},
        {"PA6", "CN10-13"},  {"PA7", "CN10-15"},  {"PB10", "CN10-25"}, {"PB5", "CN10-29"}};
    for (const BoardSignal& signal : nucleo().signals)
        EXPECT_EQ(morpho.at(text(signal.pin)), signal.connector);
}

TEST(NucleoBoard, the_clocks_are_the_firmwares) {
    const BoardHardware board = nucleo();
    EXPECT_EQ(board.crystal_hz, stm32g4::kCrystalHz);
    EXPECT_EQ(board.core_hz, stm32g4::kCrystalPlan.core_hz());
    EXPECT_EQ(board.can_hz, stm32g4::kCanHz);
    std::uint32_t fastest_hz = 0;
    for (const auto& timing : stm32g4::kI2cTimings) fastest_hz = std::max(fastest_hz, timing.bus_hz);
    EXPECT_EQ(board.i2c_hz_max, fastest_hz);
    // LPUART: 256 clocks a bit, divided (RM0440).
    const double baud = 256.0 * board.core_hz / stm32g4::lpuart_divider(board.core_hz);
    EXPECT_NEAR(baud, board.serial_baud, 1.0);
}

TEST(NucleoBoard, the_memory_is_the_linker_scripts) {
    const BoardHardware board = nucleo();
    std::ifstream stream(OCTOSKIN_SOURCE_DIR "/firmware/port/stm32g4/stm32g474re.ld");
    const std::string script{std::istreambuf_iterator<char>(stream), {}};
    const auto region = [&script](const std::string& name) {
        std::smatch found;
        const std::regex line(name + R"(\s*\([rwx]+\)\s*:\s*ORIGIN = (0x[0-9A-Fa-f]+), LENGTH = (\d+)K)");
        EXPECT_TRUE(std::regex_search(script, found, line)) << name;
        if (found.empty()) return MemoryRange{};
        return MemoryRange{.address = static_cast<std::uint32_t>(std::stoul(found[1], nullptr, 16)),
                           .size_bytes = static_cast<std::uint32_t>(std::stoul(found[2])) * 1024};
    };
    EXPECT_EQ(region("RAM").address, board.ram.address);
    EXPECT_EQ(region("RAM").size_bytes, board.ram.size_bytes);
    EXPECT_EQ(region("CONFIG").address, board.configuration_page.address);
    EXPECT_EQ(region("CONFIG").size_bytes, board.configuration_page.size_bytes);
    EXPECT_EQ(region("FLASH").address, board.flash.address);
    EXPECT_EQ(region("FLASH").end(), board.configuration_page.address);
    EXPECT_EQ(stm32g4::kConfigurationPage, board.configuration_page.address);
    EXPECT_EQ(kNodeConfigBytesMax, board.configuration_page.size_bytes);
    EXPECT_EQ(16 + stm32g4::kInterruptCount, board.vector_count);
}

TEST(NucleoBoard, its_two_files_agree) {
    const auto rig = read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/bench_one_board.yaml");
    ASSERT_TRUE(rig) << rig.error().message();
    const BoardHardware board = nucleo();
    EXPECT_EQ(rig->nodes.at(0).board.name, board.name);
    std::size_t buses = 0;
    for (const BoardSignal& signal : board.signals) buses += signal.function.ends_with("_SCL") ? 1U : 0U;
    EXPECT_EQ(rig->nodes.at(0).board.i2c_bus_count, buses);
    std::uint8_t xshut_lines = stm32g4::XshutChain::kLines;
    for (const BoardSignal& signal : board.signals) {
        // Numbered from the end of the chain on, without a gap.
        if (signal.signal == "xshut" + std::to_string(xshut_lines)) ++xshut_lines;
    }
    EXPECT_EQ(rig->nodes.at(0).board.xshut_line_count, xshut_lines);
    std::set<std::uint8_t> lines;  // EXTI has one for all the pins of a number
    for (const BoardSignal& signal : board.signals) {
        if (signal.signal.starts_with("data_ready")) lines.insert(signal.pin.number);
    }
    EXPECT_EQ(lines.size(), rig->nodes.at(0).board.has_data_ready_lines ? buses : 0U);
}

}  // namespace
}  // namespace octoskin::rig
