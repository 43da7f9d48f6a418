#include "tests/support/i2c_device/served_bus.hpp"

#include <fcntl.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

#include "tests/support/i2c_device/range_function.hpp"

namespace octoskin::test {
namespace {

constexpr const char* kNotWired = "-";
constexpr Microseconds kBootTime{200};

sim::SimTime monotonic_now() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return {std::int64_t{now.tv_sec} * 1'000'000 + now.tv_nsec / 1'000};
}

void wait_until(sim::SimTime time) {
    const timespec until{.tv_sec = time.us / 1'000'000, .tv_nsec = (time.us % 1'000'000) * 1'000};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

// -1 if the pin is not wired.
int open_line(const std::string& path, int flags) {
    if (path == kNotWired) return -1;
    const int line = ::open(path.c_str(), flags | O_CLOEXEC);
    if (line < 0) throw std::runtime_error(path + ": " + std::strerror(errno));
    return line;
}

// The error numbers of the kernel's Documentation/i2c/fault-codes.rst.
int error_number(i2c::TransferError error) {
    switch (error) {
        case i2c::TransferError::nack_address:
            return ENXIO;
        case i2c::TransferError::nack_data:
            return EIO;
        case i2c::TransferError::timeout:
            return ETIMEDOUT;
        case i2c::TransferError::arbitration_lost:
            return EAGAIN;
        case i2c::TransferError::bus_stuck:
            return EBUSY;
    }
    return EIO;
}

}  // namespace

struct ServedBus::Wired {
    Wired(const ServedSensor& wiring)
        : name(wiring.name),
          model({.boot_time = kBootTime}, scene_of(wiring.range)),
          xshut(open_line(wiring.xshut_path, O_RDONLY)) {}
    ~Wired() {
        if (xshut >= 0) ::close(xshut);
    }
    Wired(const Wired&) = delete;
    Wired& operator=(const Wired&) = delete;

    [[nodiscard]] bool is_xshut_high() const {
        char level = '1';
        return xshut < 0 || ::pread(xshut, &level, 1, 0) != 1 || level == '1';
    }

    std::string name;
    sim::SensorModel model;
    int xshut;
    sim::SimTime recorded_until{-1};  // when the newest ranging in the record was ready
};

// The line of GPIO1 of one sensor, or of several wired together.
struct ServedBus::Gpio1Line {
    explicit Gpio1Line(const std::string& wired_to) : path(wired_to), file(open_line(path, O_WRONLY)) {}
    ~Gpio1Line() {
        if (file >= 0) ::close(file);
    }
    Gpio1Line(const Gpio1Line&) = delete;
    Gpio1Line& operator=(const Gpio1Line&) = delete;

    std::string path;
    int file;
    std::vector<sim::SensorModel*> sensors{};
    std::optional<bool> driven{};  // the level that the line was last pulled to
};

ServedBus::ServedBus(const ServedBusOptions& options) : bus_(present_, options.hz) {
    for (const ServedSensor& sensor : options.sensors) {
        sensors_.push_back(std::make_unique<Wired>(sensor));
        bus_.attach(sensors_.back()->model);
        if (sensor.gpio1_path != kNotWired) wire_gpio1(sensor.gpio1_path, sensors_.back()->model);
    }
    if (!options.faults_path.empty()) faults_.emplace(options.faults_path);
}

ServedBus::~ServedBus() = default;

int ServedBus::transfer(i2c::Address address, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) {
    constexpr Microseconds kLimit{1'000'000};  // the i2c core's own default
    std::unique_lock lock(mutex_);
    present_.time = monotonic_now();
    follow_lines_at(present_.time);
    const NodeTime begin = sim::NodeClock{}.to_node(present_.time);
    bus_.submit({address, write, read}, begin, begin + kLimit);
    const sim::SimTime end = bus_.transfer_end().value_or(sim::SimTime{present_.time.us + kLimit.count()});
    lock.unlock();
    wait_until(end);
    lock.lock();
    present_.time = end;
    const auto state = bus_.poll(sim::NodeClock{}.to_node(end));
    drive_gpio1(end);  // applies this transfer's effect on a pin before the next range reverts it
    return state == i2c::TransferState::done ? 0 : error_number(bus_.error());
}

void ServedBus::follow_lines() {
    const std::lock_guard lock(mutex_);
    follow_lines_at(monotonic_now());
    for (const auto& sensor : sensors_) record(*sensor);
}

void ServedBus::follow_lines_at(sim::SimTime now) {
    take_faults(now);
    // The models keep 64 rangings: after a long pause, those from before it would be lost unrecorded.
    for (const auto& sensor : sensors_) record(*sensor);
    for (const auto& sensor : sensors_) sensor->model.set_xshut(sensor->is_xshut_high(), now);
    drive_gpio1(now);
}

void ServedBus::take_faults(sim::SimTime now) {
    if (!faults_) return;
    while (const auto line = faults_->next()) {
        auto command = parse_fault_command(*line);
        bool is_applied = false;
        if (command && std::holds_alternative<BusFaultCommand>(*command)) {
            sim::I2cFault fault = std::get<BusFaultCommand>(*command).fault;
            fault.first += bus_.transfer_count();
            bus_.inject(fault);
            is_applied = true;
        } else if (command) {
            is_applied = apply(std::get<SensorFaultCommand>(*command), now);
        }
        std::fprintf(stderr, "%s: %s\n", is_applied ? "fault" : "not understood", line->c_str());
    }
}

bool ServedBus::apply(const SensorFaultCommand& command, sim::SimTime now) {
    for (const auto& sensor : sensors_) {
        if (sensor->name != command.sensor) continue;
        if (command.is_brown_out) {
            sensor->model.brown_out(now);
        } else {
            sensor->model.set_faults(command.faults);
        }
        return true;
    }
    return false;
}

void ServedBus::wire_gpio1(const std::string& path, sim::SensorModel& sensor) {
    for (const auto& line : gpio1_lines_) {
        if (line->path == path) return line->sensors.push_back(&sensor);
    }
    gpio1_lines_.push_back(std::make_unique<Gpio1Line>(path));
    gpio1_lines_.back()->sensors.push_back(&sensor);
}

void ServedBus::drive_gpio1(sim::SimTime time) {
    for (const auto& line : gpio1_lines_) {
        bool is_high = true;  // open drain: any of them pulls it low
        for (sim::SensorModel* sensor : line->sensors) is_high &= sensor->gpio1_level(time);
        if (line->driven == is_high) continue;
        const std::string_view pull = is_high ? "pull-up" : "pull-down";
        if (::pwrite(line->file, pull.data(), pull.size(), 0) == static_cast<ssize_t>(pull.size())) {
            line->driven = is_high;
        }
    }
}

void ServedBus::record(Wired& wired) {
    const auto& history = wired.model.history();
    const auto is_known = [&](const sim::RangingRecord& ranging) {
        return ranging.ready <= wired.recorded_until;
    };
    const auto unknown = std::find_if(history.rbegin(), history.rend(), is_known).base();
    for (auto made = unknown; made != history.end(); ++made) {
        const sim::RangingRecord& ranging = *made;
        wired.recorded_until = ranging.ready;
        std::ostringstream line;
        line << wired.name << ' ' << ranging.index << ' ' << ranging.window_middle.us << ' '
             << ranging.ready.us << ' ' << unsigned{ranging.result.range_status} % 32 << ' '
             << unsigned{ranging.result.stream_count} << ' ' << ranging.result.range_mm << '\n';
        record_ += line.str();
    }
}

std::string ServedBus::take_record() {
    const std::lock_guard lock(mutex_);
    return std::exchange(record_, {});
}

}  // namespace octoskin::test
