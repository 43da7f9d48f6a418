// octoskin command: start, stop, identify, reset, ... a sensor board over CAN.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>

#include "common/wire/frame_type.hpp"
#include "host/apps/command/dialogue.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/given_rig.hpp"

namespace octoskin::app {
namespace {

constexpr const char* kCommandAbout =
    "Send a command to a sensor board over CAN, and report whether the node follows or refuses it.\n  start  "
    "               start ranging; also ends safe mode\n  stop                  stop ranging\n  set_rate     "
    "         set another period, until reset: --period-ms, 0 is as configured\n  reinitialise_sensor   "
    "initialise the sensor again\n  identify              blink the board's light for --seconds\n  reset     "
    "            restart the node\n  send_info             print the information of the node\n  "
    "send_black_box        have it send its last I2C transfers (candump, then octoskin black-box)";

constexpr const char* kCommandFooter =
    "Exit codes, with `all` that of the first node that fails: 0 done; 1 the node refuses, or accepted it "
    "and\nnothing changed within 5 s; 64 no such node, sensor or command; 66, 78 the rig, or the node has "
    "another\nconfiguration; 69 no such interface, no heartbeat, or no answer; 74 silent since the command.";

struct CommandOptions {
    commanding::Wish wish;
    std::filesystem::path rig;
    std::string interface;
};

socketcan::CanSocket open_for(const std::vector<commanding::Order>& orders, const std::string& interface) {
    constexpr std::array kHeard{wire::FrameType::heartbeat, wire::FrameType::node_info,
                                wire::FrameType::sensor_health, wire::FrameType::black_box};
    if (const auto descriptor = descriptor_of(interface)) return {interface, *descriptor};
    std::vector<socketcan::IdFilter> filters;
    for (const commanding::Order& order : orders) {
        for (const wire::FrameType type : kHeard)
            filters.push_back({wire::can_id(type, order.node_id), wire::kStandardIdMax});
    }
    auto socket = socketcan::CanSocket::open(interface, {.filters = filters, .wants_error_frames = false});
    if (!socket)
        throw CommandFailure(ExitCode::unavailable,
                             in_file({ErrorCode::no_device, socket.error().what}, interface));
    return std::move(*socket);
}

std::string perform(const commanding::Order& order, socketcan::CanSocket& socket) {
    const Outside outside = this_machine();
    commanding::Dialogue dialogue(order, outside.now());
    if (const auto held = converse(dialogue, socket, outside); !held) throw CommandFailure(held.error());
    return value_or_fail(*dialogue.outcome());
}

/// If a node fails, the others still get their command.
void perform_each(const std::vector<commanding::Order>& orders, socketcan::CanSocket& socket) {
    std::optional<CommandFailure> first;
    for (const commanding::Order& order : orders) {
        try {
            print_text(perform(order, socket));
        } catch (const CommandFailure& failure) {
            if (orders.size() == 1) throw;
            spdlog::error("{}", failure.what());
            if (!first) first = failure;
        }
    }
    if (!first) return;
    const AppError& error = first->error();
    throw CommandFailure(error.exit,
                         {.code = error.error.code, .what = "failed: see above", .key = error.error.key});
}

void run(const CommandOptions& options) {
    std::optional<rig::Rig> rig;
    if (!options.rig.empty()) rig = value_or_fail(read_given_rig(options.rig));
    const auto orders =
        value_or_fail(commanding::orders_of(rig ? &*rig : nullptr, options.wish, new_sequence()));
    socketcan::CanSocket socket = open_for(orders, options.interface);
    perform_each(orders, socket);
}

}  // namespace

void add_command_command(CLI::App& app) {
    auto options = std::make_shared<CommandOptions>();
    CLI::App* command = app.add_subcommand("command", kCommandAbout);
    command
        ->add_option("node", options->wish.node,
                     "Number of the node; with --rig also its name, or all: each of the rig's sensor boards")
        ->required();
    command->add_option("code", options->wish.code, "One of the commands above")
        ->required()
        ->check(CLI::IsMember(commanding::code_names()));
    command
        ->add_option(
            "--can", options->interface,
            "CAN interface of Linux, such as can0, or fd:N, an open socket that carries frames as one")
        ->required();
    command->add_option("--rig", options->rig, "Rig (YAML), for names")->check(existing_file());
    command->add_option("--sensor", options->wish.sensor,
                        "Only this sensor: its number on the node; with --rig also its name");
    command->add_option("--period-ms", options->wish.period_ms, "For set_rate: from range to range, ms");
    command->add_option("--seconds", options->wish.seconds, "For identify: how long (10)")
        ->check(from_to(0, 1'800));
    command->footer(kCommandFooter);
    command->callback([options] { run(*options); });
}

}  // namespace octoskin::app
