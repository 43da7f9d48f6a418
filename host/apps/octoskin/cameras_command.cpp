// octoskin cameras: the depth cameras that OpenNI2 finds, and their modes.
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>

#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin::app {
namespace {

/// The helper's output until its end; empty if it takes too long.
std::optional<std::string> text_of(const openni2::HelperProcess& helper) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds kPatience{20};  // a camera may take seconds to open
    const auto end = Clock::now() + kPatience;
    std::string text;
    while (true) {  // until the helper ends, or the patience is over
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
        pollfd ready{helper.descriptor(), POLLIN, 0};
        if (left.count() <= 0 || ::poll(&ready, 1, static_cast<int>(left.count())) != 1) return std::nullopt;
        std::array<char, 4096> bytes{};
        const ssize_t count = ::read(helper.descriptor(), bytes.data(), bytes.size());
        if (count <= 0) return text;
        text.append(bytes.data(), static_cast<std::size_t>(count));
    }
}

void list_cameras() {
    constexpr const char* kHelper = "octoskin-camera";
    const auto program = openni2::find_helper(kHelper);
    if (!program) throw CommandFailure(ExitCode::unavailable, {ErrorCode::no_program, program.error()});
    auto helper = openni2::HelperProcess::start(*program, {"--list"}, openni2::HelperPipe::its_output);
    if (!helper) throw CommandFailure(ExitCode::unavailable, {ErrorCode::no_program, helper.error()});
    const auto text = text_of(*helper);
    if (!text)
        throw CommandFailure(ExitCode::io_failed, {.code = ErrorCode::no_device,
                                                   .what = "a camera does not answer",
                                                   .remedy = "unplug it and plug it in again"});
    if (const auto failed = helper->wait(std::chrono::seconds(2)))
        throw CommandFailure(ExitCode::io_failed,
                             in_file({ErrorCode::no_device, "failed: " + *failed}, kHelper));
    if (text->empty()) {
        throw CommandFailure(
            ExitCode::unavailable,
            {.code = ErrorCode::no_device,
             .what = "no camera found",
             .remedy = "check that one is plugged in, that it has an OpenNI2 driver, and that "
                       "you may use it (group video)"});
    }
    print_text(*text);
}

}  // namespace

void add_cameras_command(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("cameras", "List the depth cameras of this machine and their modes");
    command->footer(
        "For each camera: its URI (for `octoskin run --camera`), vendor and name, and its depth "
        "modes.\n`octoskin run` sets the mode with width_px and height_px of the rig's camera whose rate is "
        "nearest\nto rate_hz.\nExit codes: 0 there is one; 69 there is none; 74 one does not answer.");
    command->callback(list_cameras);
}

}  // namespace octoskin::app
