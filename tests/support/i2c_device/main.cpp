// Serves modelled VL53L1X as a /dev/i2c-N of this machine, wired to GPIO lines of the kernel's simulator.
#include <sched.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/i2c_device/i2c_dev_protocol.hpp"
#include "tests/support/i2c_device/range_function.hpp"

namespace {

using octoskin::test::ServedBus;

struct Options {
    std::string device;
    std::string record;
    octoskin::test::ServedBusOptions bus;
};

void declare(CLI::App& app, Options& options, std::vector<std::vector<std::string>>& sensors) {
    app.add_option("--device", options.device, "name below /dev, such as i2c-7")->required();
    app.add_option("--hz", options.bus.hz, "clock of the bus")->check(CLI::Range(100'000, 1'000'000));
    app.add_option(
        "--record", options.record,
        "append each ranging: NAME INDEX MIDDLE_US READY_US STATUS STREAM RANGE_MM (CLOCK_MONOTONIC)");
    app.add_option(
        "--faults", options.bus.faults_path,
        "a named pipe for faults: SENSOR none|absent|never_boots|wrong_id|ignores_xshut|freezes_stream|"
        "never_ready|always_ready|brown_out, SENSOR status BYTE, bus KIND COUNT POSITION [ADDRESS]");
    app.add_option(
           "--sensor", sensors,
           "NAME XSHUT GPIO1 RANGE: files of gpio-sim (sim_gpioN/value, sim_gpioN/pull) or '-'; none, "
           "constant:MM, triangle:NEAR:FAR:PERIOD_MS or file:PATH")
        ->type_size(4)
        ->required();
}

// The sensors go on whatever the programs of the machine do: else they would miss a short pulse of XSHUT
// while those keep the processor busy.
void run_before_others() {
    const sched_param priority{.sched_priority = 1};
    if (::sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
        std::fprintf(stderr, "i2c_device: no real-time priority; a short pulse of XSHUT may be missed\n");
    }
}

// Calls `step` every `period` until asked to stop, in a thread of its own.
template <typename Step>
std::jthread repeating(std::chrono::microseconds period, Step step) {
    return std::jthread([period, step](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            step();
            std::this_thread::sleep_for(period);
        }
    });
}

// The pins move while nobody talks to the bus; and no pin waits for the record's file.
int serve(const Options& options) {
    ServedBus bus(options.bus);
    std::ofstream record;
    if (!options.record.empty()) record.open(options.record, std::ios::app);
    if (!record) throw std::runtime_error(options.record + ": cannot be written");
    const auto write_record = [&] { record << bus.take_record() << std::flush; };
    const std::jthread recorder = repeating(std::chrono::milliseconds{10}, write_record);
    run_before_others();
    const std::jthread follower = repeating(octoskin::test::kLinePeriod, [&bus] { bus.follow_lines(); });
    return octoskin::test::serve_i2c_device(options.device, bus);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    std::vector<std::vector<std::string>> sensors;
    CLI::App app{"Serves modelled VL53L1X sensors as /dev/i2c-N through CUSE."};
    declare(app, options, sensors);
    CLI11_PARSE(app, argc, argv);
    for (const auto& sensor : sensors) {
        options.bus.sensors.push_back({sensor[0], sensor[1], sensor[2], sensor[3]});
        if (!octoskin::test::true_range_mm(sensor[3], {})) {
            std::fprintf(stderr, "i2c_device: %s: range '%s' is not understood\n", sensor[0].c_str(),
                         sensor[3].c_str());
            return 2;
        }
    }
    try {
        return serve(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "i2c_device: %s\n", error.what());
        return 1;
    }
}
