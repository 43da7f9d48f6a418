#include "host/lab/octoskin_board/arguments.hpp"

#include <fmt/format.h>

#include <map>
#include <sstream>

namespace octoskin::board {
namespace {

const std::map<std::string, sim::I2cFaultKind> kFaultKinds = {
    {"nack_address", sim::I2cFaultKind::nack_address},
    {"nack_byte", sim::I2cFaultKind::nack_byte},
    {"nack_read", sim::I2cFaultKind::nack_read},
    {"flip_bit", sim::I2cFaultKind::flip_bit},
    {"flip_written_bit", sim::I2cFaultKind::flip_written_bit},
    {"lose_write", sim::I2cFaultKind::lose_write},
    {"read_ones", sim::I2cFaultKind::read_ones},
    {"lose_arbitration", sim::I2cFaultKind::lose_arbitration},
    {"stretch", sim::I2cFaultKind::stretch},
    {"sda_stuck_low", sim::I2cFaultKind::sda_stuck_low},
};

std::uint64_t number(const std::string& key, const std::string& text) {
    std::size_t used = 0;
    std::uint64_t value = 0;
    try {
        value = std::stoull(text, &used, 0);
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != text.size() || text.empty())
        throw CLI::ValidationError("--i2c-fault", fmt::format("{}={}: not a number", key, text));
    return value;
}

void set(BusFault& parsed, const std::string& key, const std::string& value) {
    if (key == "kind") {
        const auto kind = kFaultKinds.find(value);
        if (kind == kFaultKinds.end())
            throw CLI::ValidationError("--i2c-fault", fmt::format("no kind '{}'", value));
        parsed.fault.kind = kind->second;
    } else if (key == "bus") {
        parsed.bus = number(key, value);
        if (parsed.bus > 3) throw CLI::ValidationError("--i2c-fault", fmt::format("no bus {}", value));
    } else if (key == "first") {
        parsed.fault.first = number(key, value);
    } else if (key == "count") {
        parsed.fault.count = number(key, value);
    } else if (key == "position") {
        parsed.fault.position = static_cast<std::uint32_t>(number(key, value));
    } else if (key == "address") {
        parsed.fault.address = static_cast<std::uint8_t>(number(key, value));
    } else {
        throw CLI::ValidationError("--i2c-fault", fmt::format("unknown key '{}'", key));
    }
}

}  // namespace

BusFault parse_i2c_fault(const std::string& text) {
    BusFault parsed;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const auto equals = part.find('=');
        if (equals == std::string::npos)
            throw CLI::ValidationError("--i2c-fault", fmt::format("'{}' is not key=value", part));
        set(parsed, part.substr(0, equals), part.substr(equals + 1));
    }
    if (parsed.fault.kind == sim::I2cFaultKind::sda_stuck_low && parsed.fault.position == 0)
        throw CLI::ValidationError(
            "--i2c-fault",
            "sda_stuck_low needs position=CLOCKS, after which SDA is released; 100000 never releases it");
    return parsed;
}

void describe(CLI::App& app, Arguments& arguments) {
    app.add_option("--elf", arguments.elf, "The image to flash")->required()->check(CLI::ExistingFile);
    auto* config = app.add_option("--config", arguments.config, "Configuration block (binary)")
                       ->check(CLI::ExistingFile);
    auto* rig = app.add_option("--rig", arguments.rig, "Rig (YAML) to take the configuration from")
                    ->check(CLI::ExistingFile);
    app.add_option("--node", arguments.node, "Node of the rig: name or id; the first by default")->needs(rig);
    config->excludes(rig);
    app.add_option("--seconds", arguments.seconds, "Duration, simulated seconds")
        ->capture_default_str()
        ->check(CLI::Range(0.001, 1e6));
    app.add_option("--wall", arguments.wall_m,
                   "Distance of the wall that each sensor looks at, metres; the list is repeated")
        ->capture_default_str();
    app.add_option("--can-log", arguments.can_log,
                   "Write the bus's frames to this file, in the format of candump -L");
    app.add_option(
        "--can", arguments.can_interface,
        "Connect the bus to a CAN interface of this machine, such as vcan0; then runs in real time");
    app.add_flag("--sync", arguments.sends_sync, "Send the host's SYNC and FOLLOW_UP once a second");
    app.add_flag("--alone", arguments.is_alone_on_bus, "No other node on the CAN bus: no acknowledge");
    app.add_option("--drift-ppm", arguments.drift_ppm, "Error of the board's crystal, ppm")
        ->capture_default_str();
    app.add_option("--lsi-hz", arguments.lsi_hz, "Frequency of the watchdog's oscillator, Hz")
        ->capture_default_str();
    app.add_option("--cycles-per-instruction", arguments.cycles_per_instruction,
                   "Core cycles per instruction")
        ->capture_default_str()
        ->check(CLI::Range(1, 20));
    app.add_flag_callback(
        "--no-crystal", [&arguments] { arguments.has_crystal = false; },
        "The board's crystal does not start");
    app.add_option("--crystal-fails-at", arguments.crystal_fails_s,
                   "The crystal fails so many seconds after power-up");
    app.add_flag("--slow-edges", arguments.has_slow_edges,
                 "I2C edges at the slowest limit of the specification");
    app.add_option(
        "--i2c-fault", arguments.i2c_faults,
        "bus=0,kind=stretch,first=100[,count=1][,position=0][,address=0x30]; may be repeated. Transfers are "
        "counted from power-up, position is the byte (of flip_* the bit; of sda_stuck_low, which has no "
        "count, the clocks that release SDA). Kinds: "
        "nack_address nack_byte nack_read flip_bit flip_written_bit lose_write read_ones "
        "lose_arbitration stretch sda_stuck_low");
    app.add_option("--seed", arguments.seed,
                   "Seed of the sensors' constants, the unique id and the RAM content at power-up")
        ->capture_default_str();
    app.add_option("--slow-clock-min", arguments.slow_clocks.factor_min,
                   "Least factor by which the sensors' slow oscillators are faster than calibrated")
        ->capture_default_str();
    app.add_option("--slow-clock-max", arguments.slow_clocks.factor_max, "Greatest factor of the same")
        ->capture_default_str();
    app.add_option("--sensor-traits", arguments.sensor_traits,
                   "[sensor=3,][register=71,reads=12[,mask=255],][range_spread_us=1000,][range_step_us=300,]"
                   "[boot_load_us=3000]: of that sensor or of all; may be repeated")
        ->check([](const std::string& text) {
            return sim::parse_traits(text) ? std::string() : "'" + text + "' is not key=number,...";
        });
    app.add_flag("--allow-violations", arguments.allows_violations,
                 "Exit with code 0 although there are violations");
    app.add_flag("--serial", arguments.shows_serial,
                 "After the run, print the board's serial output (the NUCLEO's virtual COM port)");
    app.add_option("--socket-fd", arguments.socket,
                   "Serve a simulator over this inherited Unix socket instead of running alone");
    app.footer(
        "Violations are listed on standard error. Exit codes: 0 done; 1 the program broke a rule of the\n"
        "manuals; 64 command line; 65 unusable image or block; 69 no such CAN\n"
        "interface; 73 cannot write; 74 the CAN interface failed; 77 not allowed to use it; 78 rig.");
}

}  // namespace octoskin::board
