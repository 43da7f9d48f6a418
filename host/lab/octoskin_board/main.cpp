// octoskin_board: the flashed image on an emulated NUCLEO-G474RE. A separate program because Unicorn is under
// the GPL.
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <optional>
#include <thread>

#include "host/io/candump/log_writer.hpp"
#include "host/lab/octoskin_board/arguments.hpp"
#include "host/lab/octoskin_board/bench.hpp"
#include "host/lab/octoskin_board/can_gateway.hpp"
#include "host/lab/octoskin_board/server.hpp"
#include "hw/sim/experiment/sync_master.hpp"

namespace octoskin::board {
namespace {

constexpr WallTime kLogEpoch{1'750'000'000'000'000'000};
constexpr HostTime kHostAtStart{4'321'000'000'000};
constexpr Microseconds kSyncPeriod{1'000'000};

int report(const AppError& error) {
    fmt::print(stderr, "octoskin_board: {}\n", error.message());
    return static_cast<int>(error.exit);
}

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::string gateway_report(const std::string& interface, const GatewayCounts& counts) {
    return fmt::format(
        "{}: {} frames sent, {} not; {} received, {} of them not forwarded, the bus had no room", interface,
        counts.sent, counts.not_sent, counts.received + counts.not_received, counts.not_received);
}

/// Runs the board alone on its bus, with another controller that acknowledges, and with the host's SYNC if
/// asked for.
Status<AppError> run(const Arguments& arguments, Bench& bench) {
    sim::SimulatedCanBus bus({bench.config().nominal_bitrate, bench.config().data_bitrate});
    std::optional<candump::LogWriter> log;
    if (!arguments.can_log.empty()) {
        auto created = candump::LogWriter::create(arguments.can_log);
        if (!created) return fail(ExitCode::cannot_create, created.error());
        log.emplace(std::move(*created));
    }
    sim::SyncMaster master(sim::SimulatedHostClock(kHostAtStart), kSyncPeriod);
    std::optional<Error> write_error;
    bus.tap([&](const wire::CanFrame& frame, sim::SimTime end) {
        master.on_frame(frame, end);
        if (!log || write_error) return;
        if (const auto written = log->write(WallTime{kLogEpoch.ns + end.us * 1000}, frame); !written)
            write_error = written.error();
    });
    std::optional<CanGateway> gateway;
    if (!arguments.can_interface.empty()) {
        auto socket = open_interface(arguments.can_interface);
        if (!socket) return unexpected(socket.error());
        gateway.emplace(std::move(*socket), bus);
    }
    Status<AppError> tied = Done{};
    const auto begun = std::chrono::steady_clock::now();
    node::CanTransmitter& host = bus.attach({}, 16);
    sim::stm32::BoardOnBus on_bus(bench.board(), bus);
    on_bus.run_until({static_cast<std::int64_t>(arguments.seconds * 1e6)}, [&](sim::SimTime now) {
        if (gateway && tied) {
            std::this_thread::sleep_until(begun + std::chrono::microseconds(now.us));
            tied = gateway->poll();
        }
        const std::vector<wire::CanFrame> frames = master.poll(now);
        if (!arguments.sends_sync) return;
        for (const wire::CanFrame& frame : frames) static_cast<void>(host.send(frame));
    });
    if (!tied) return tied;
    if (gateway) fmt::print("{}\n", gateway_report(arguments.can_interface, gateway->counts()));
    if (log && !write_error) {
        if (const auto closed = log->close(); !closed) write_error = closed.error();
    }
    if (write_error) return fail(ExitCode::cannot_create, *write_error);
    return Done{};
}

int run_alone(const Arguments& arguments) {
    auto bench = Bench::build(arguments, wall_at(arguments.wall_m));
    if (!bench) return report(bench.error());
    const double begun_s = cpu_seconds();
    if (const auto ran = run(arguments, **bench); !ran) return report(ran.error());
    if (arguments.shows_serial) fmt::print("{}", (*bench)->board().serial_text());
    fmt::print("{}", use_report(**bench, cpu_seconds() - begun_s));
    fmt::print(stderr, "{}", violation_report((*bench)->board()));
    const bool is_clean = (*bench)->board().log().count() == 0 || arguments.allows_violations;
    return static_cast<int>(is_clean ? ExitCode::ok : ExitCode::failed);
}

int run_for_simulator(const Arguments& arguments) {
    sim::LinkSocket socket(arguments.socket);
    try {
        auto bench = Bench::build(arguments, scene_over(socket));
        if (!bench) return report(bench.error());
        serve(**bench, socket);
        const bool is_clean = (*bench)->board().log().count() == 0 || arguments.allows_violations;
        return static_cast<int>(is_clean ? ExitCode::ok : ExitCode::failed);
    } catch (const sim::BoardLinkError& error) {
        return report({ExitCode::bad_data, {ErrorCode::damaged, error.what()}});
    }
}

}  // namespace
}  // namespace octoskin::board

int main(int argc, char** argv) {
    using namespace octoskin;
    CLI::App app{"Runs a flashed image on an emulated NUCLEO-G474RE with simulated sensors."};
    board::Arguments arguments;
    board::describe(app, arguments);
    try {
        app.parse(argc, argv);
        return arguments.socket >= 0 ? board::run_for_simulator(arguments) : board::run_alone(arguments);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
}
