// Command line of octoskin_board.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"

namespace octoskin::board {

struct Arguments {
    std::filesystem::path elf;
    std::filesystem::path config;  ///< configuration block; empty: from the rig
    std::filesystem::path rig;
    std::string node;  ///< name or id within the rig
    double seconds = 5.0;
    std::vector<double> wall_m = {1.0};  ///< per sensor, repeated
    std::filesystem::path can_log;
    std::string can_interface;  ///< of this machine; empty: none
    double drift_ppm = 0.0;
    std::uint32_t lsi_hz = 32'000;
    std::uint32_t cycles_per_instruction = 1;
    bool has_crystal = true;
    double crystal_fails_s = -1.0;  ///< negative: never
    bool has_slow_edges = false;
    bool is_alone_on_bus = false;
    bool sends_sync = false;
    std::vector<std::string> i2c_faults;
    std::uint64_t seed = 1;
    sim::SlowClockSpread slow_clocks{};
    std::vector<std::string> sensor_traits;
    bool allows_violations = false;
    bool shows_serial = false;
    int socket = -1;  ///< open file descriptor of the parent's socket; negative: alone
};

void describe(CLI::App& app, Arguments& arguments);

struct BusFault {
    std::size_t bus = 0;
    sim::I2cFault fault;
};
/// "bus=0,kind=stretch,first=100,count=1,position=0,address=0x30"; throws CLI::ValidationError.
[[nodiscard]] BusFault parse_i2c_fault(const std::string& text);

}  // namespace octoskin::board
