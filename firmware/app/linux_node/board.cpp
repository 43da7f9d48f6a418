#include "firmware/app/linux_node/board.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "firmware/core/time_bracket.hpp"
#include "firmware/port/linux/node_clock.hpp"

namespace octoskin::linux_node {
namespace {

using linux_port::I2cDevice;
using linux_port::node_now;
using linux_port::StartFailure;

constexpr Microseconds kSleepMax{1'000'000};
constexpr int kFramesPerTurn = 64;

Result<std::vector<I2cDevice>, StartFailure> open_buses(const std::vector<std::string>& paths) {
    std::vector<I2cDevice> devices;
    for (const std::string& path : paths) {
        auto device = I2cDevice::open(path);
        if (!device) return unexpected(device.error());
        devices.push_back(std::move(*device));
    }
    return devices;
}

std::vector<std::unique_ptr<linux_port::I2cThreadBus>> start_threads(std::vector<I2cDevice>& devices,
                                                                     int event) {
    std::vector<std::unique_ptr<linux_port::I2cThreadBus>> threads;
    threads.reserve(devices.size());
    for (I2cDevice& device : devices)
        threads.push_back(std::make_unique<linux_port::I2cThreadBus>(device, event, linux_port::node_now));
    return threads;
}

node::Policy policy_for(const Arguments& arguments) {
    node::Policy policy;
    policy.i2c_lateness = arguments.i2c_lateness;
    return policy;
}

}  // namespace

Result<std::unique_ptr<Board>, StartFailure> Board::open(const Arguments& arguments, const NodeConfig& config,
                                                         const node::Identity& identity,
                                                         node::KeptMemory& kept) {
    auto xshut = linux_port::XshutOutputs::request(
        arguments.xshut);  // first, so that all sensors are in reset from here on
    if (!xshut) return unexpected(xshut.error());
    auto data_ready = linux_port::DataReadyInputs::request(arguments.data_ready);
    if (!data_ready) return unexpected(data_ready.error());
    auto buses = open_buses(arguments.i2c);
    if (!buses) return unexpected(buses.error());
    return std::unique_ptr<Board>(new Board(
        arguments, config, identity, kept,
        {.i2c = std::move(*buses), .xshut = std::move(*xshut), .data_ready = std::move(*data_ready)}));
}

Board::Board(const Arguments& arguments, const NodeConfig& config, const node::Identity& identity,
             node::KeptMemory& kept, Devices devices)
    : arguments_(arguments),
      devices_(std::move(devices)),
      transfers_ended_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      threads_(start_threads(devices_.i2c, transfers_ended_)),
      can_(arguments.can, config.node_id, config.uses_can_fd, node_now()),
      policy_(policy_for(arguments)),
      node_(config, identity, ports(kept), node_now(), policy_) {}

Board::~Board() {
    threads_.clear();  // the threads write to the descriptor
    ::close(transfers_ended_);
}

Board::Left Board::end() {
    constexpr Microseconds kPatience{1'000'000};
    Left left{.xshut_refused = devices_.xshut.set_all_low(), .stuck = {}};
    const NodeTime begun = node_now();
    for (std::size_t bus = 0; bus < threads_.size(); ++bus) {
        const Microseconds rest = std::max(kPatience - elapsed(begun, node_now()), Microseconds{0});
        if (!threads_[bus]->end(rest)) left.stuck.push_back(arguments_.i2c[bus]);
    }
    return left;
}

node::Ports Board::ports(node::KeptMemory& kept) {
    for (const auto& thread : threads_) buses_.push_back(thread.get());
    return {.buses = buses_,
            .xshut = devices_.xshut,
            .can = can_,
            .data_ready = &devices_.data_ready,
            .kept = &kept};
}

Board::Ending Board::run(int stop, Journal& journal, linux_port::ServiceManager& manager) {
    const Microseconds sleep_max = std::min(kSleepMax, manager.sleep_max().value_or(kSleepMax));
    manager.started();
    while (true) {
        turn();
        manager.turned(node_now());
        journal.update(node_, can_, devices_.xshut, devices_.data_ready);
        if (node_.is_reset_requested()) return Ending::reset;
        if (!wait(stop, sleep_max)) return Ending::stopped;
    }
}

void Board::turn() {
    can_.poll(node_now());
    for (int i = 0; i < kFramesPerTurn; ++i) {
        const auto received = can_.receive();
        if (!received) break;
        node_.on_frame(received->frame, received->received);
    }
    node_.poll(node_now());
}

bool Board::wait(int stop, Microseconds sleep_max) {
    constexpr std::size_t kOthers = 3;
    std::array<pollfd, kOthers + kNodeBusesMax> waits{};
    waits[0] = {.fd = stop, .events = POLLIN, .revents = 0};
    waits[1] = {.fd = transfers_ended_, .events = POLLIN, .revents = 0};
    waits[2] = {.fd = can_.descriptor(), .events = POLLIN, .revents = 0};
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus)
        waits.at(kOthers + bus) = {.fd = devices_.data_ready.descriptor(bus), .events = POLLIN, .revents = 0};
    const NodeTime now = node_now();
    const auto left = std::clamp(elapsed(now, wake_time(now)), Microseconds{0}, sleep_max);
    const timespec patience{.tv_sec = left.count() / 1'000'000, .tv_nsec = left.count() % 1'000'000 * 1'000};
    if (::ppoll(waits.data(), waits.size(), &patience, nullptr) <= 0) return true;
    eventfd_t ended = 0;
    if (waits[1].revents != 0) (void)::eventfd_read(transfers_ended_, &ended);
    for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if (waits.at(kOthers + bus).revents != 0) devices_.data_ready.on_readable(bus);
    }
    return waits[0].revents == 0;
}

NodeTime Board::wake_time(NodeTime now) const {
    NodeTime wake = node_.wake_time(now);
    if (const auto due = can_.wake_time()) wake = node::earlier_of(wake, *due);
    for (const auto& thread : threads_) {
        if (const auto due = thread->deadline()) wake = node::earlier_of(wake, *due);
    }
    return wake;
}

}  // namespace octoskin::linux_node
