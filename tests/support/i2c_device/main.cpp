// Serves simulated VL53L1X as /dev/i2c-N of this machine, wired to GPIO lines of the kernel's simulator.
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/i2c_device/i2c_dev_protocol.hpp"
#include "tests/support/i2c_device/range_function.hpp"

namespace {

using octoskin::test::I2cDevice;
using octoskin::test::ServedBus;
using octoskin::test::ServedBusOptions;

struct DeviceOptions {
    std::string name;
    ServedBusOptions bus;
};

struct Options {
    std::vector<std::vector<std::string>> sensors;
    std::string record;
    std::string faults;
    std::uint32_t hz = 400'000;
};

void declare(CLI::App& app, Options& options) {
    app.add_option("--hz", options.hz, "clock of the buses")->check(CLI::Range(100'000, 1'000'000));
    app.add_option(
        "--record", options.record,
        "append each ranging of DEVICE to RECORD.DEVICE: NAME INDEX MIDDLE_US READY_US STATUS STREAM "
        "RANGE_MM (CLOCK_MONOTONIC)");
    app.add_option(
        "--faults", options.faults,
        "FAULTS.DEVICE is a named pipe for its faults: SENSOR none|absent|never_boots|wrong_id|ignores_xshut|"
        "freezes_stream|never_ready|always_ready|brown_out, SENSOR status BYTE, bus KIND COUNT POSITION "
        "[ADDRESS]");
    app.add_option(
           "--sensor", options.sensors,
           "DEVICE NAME XSHUT GPIO1 RANGE: name below /dev, such as i2c-7; its own name; files of gpio-sim "
           "(sim_gpioN/value, sim_gpioN/pull) or '-'; none, constant:MM, triangle:NEAR:FAR:PERIOD_MS or "
           "file:PATH")
        ->type_size(5)
        ->required();
}

// Throws std::runtime_error for a range that cannot be parsed.
std::vector<DeviceOptions> devices_of(const Options& options) {
    std::vector<DeviceOptions> devices;
    for (const auto& sensor : options.sensors) {
        if (!octoskin::test::true_range_mm(sensor[4], {})) {
            throw std::runtime_error(sensor[1] + ": range '" + sensor[4] + "' is not understood");
        }
        auto device = std::ranges::find(devices, sensor[0], &DeviceOptions::name);
        if (device == devices.end()) {
            const std::string faults = options.faults.empty() ? "" : options.faults + "." + sensor[0];
            device =
                devices.insert(device, {sensor[0], {.sensors = {}, .hz = options.hz, .faults_path = faults}});
        }
        device->bus.sensors.push_back({sensor[1], sensor[2], sensor[3], sensor[4]});
    }
    return devices;
}

// The sensors run at high priority: else they would miss a short pulse of XSHUT while other programs keep the
// processor busy.
void run_before_others() {
    const sched_param priority{.sched_priority = 1};
    if (::sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
        std::fprintf(stderr, "i2c_device: no real-time priority; a short pulse of XSHUT may be missed\n");
    }
}

// One device and its output file. Writing the file delays no pin.
struct Served {
    Served(const DeviceOptions& options, const std::string& record_path)
        : bus(options.bus), device(options.name, bus) {
        if (record_path.empty()) return;
        record.open(record_path + "." + options.name, std::ios::app);
        if (!record) throw std::runtime_error(record_path + "." + options.name + ": cannot be written");
    }
    void write_record() {
        const std::lock_guard lock(record_mutex);
        record << bus.take_record() << std::flush;
    }
    // A device that ends by itself ends the program, so that a test that waits for it learns the reason.
    [[noreturn]] void serve() {
        device.serve();
        std::fprintf(stderr, "i2c_device: a device has ended\n");
        std::_Exit(1);
    }

    ServedBus bus;
    I2cDevice device;
    std::ofstream record;
    std::mutex record_mutex;
};

// Calls `step` for each every `period`, in a thread of its own, as long as the process runs. One thread for
// all devices: on an emulated processor a wake-up costs more than the step.
template <typename Step>
void keep_doing(std::vector<std::unique_ptr<Served>>& all, std::chrono::microseconds period, Step step) {
    std::thread([&all, period, step] {
        while (true) {
            for (const auto& served : all) step(*served);
            std::this_thread::sleep_for(period);
        }
    }).detach();
}

// Until SIGINT or SIGTERM; the devices are gone with the process, and no program has to close them for that.
[[noreturn]] void serve(const std::vector<DeviceOptions>& devices, const std::string& record_path) {
    sigset_t ends{};
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &ends, nullptr);  // for the threads, too
    std::vector<std::unique_ptr<Served>> all;
    for (const DeviceOptions& options : devices)
        all.push_back(std::make_unique<Served>(options, record_path));
    keep_doing(all, std::chrono::milliseconds{10}, [](Served& served) { served.write_record(); });
    run_before_others();
    keep_doing(all, octoskin::test::kLinePeriod, [](Served& served) { served.bus.follow_lines(); });
    for (const auto& served : all) std::thread([&served] { served->serve(); }).detach();
    int signal = 0;
    sigwait(&ends, &signal);
    for (const auto& served : all) served->write_record();
    std::_Exit(0);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"Serves modelled VL53L1X sensors as /dev/i2c-N through CUSE."};
    declare(app, options);
    CLI11_PARSE(app, argc, argv);
    try {
        serve(devices_of(options), options.record);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "i2c_device: %s\n", error.what());
        return 1;
    }
}
