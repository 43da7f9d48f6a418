// octoskin calibrate: one sensor's offset or crosstalk, from a target at a known range.
#include <fmt/format.h>

#include <array>
#include <memory>

#include "common/wire/frame_type.hpp"
#include "host/apps/calibration/calibration.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/given_rig.hpp"

namespace octoskin::app {
namespace {

constexpr const char* kCalibrateAbout =
    "Calibrate one sensor's offset, or the crosstalk of its cover glass, with a grey target (17 %) in the "
    "dark.\n"
    "Offset first (target at 140 mm), flash, then crosstalk (target where ranges begin to fall short: "
    "docs/hardware/calibration.md).";

struct CalibrateOptions {
    std::string quantity;
    std::filesystem::path rig;
    std::string interface;
    calibrating::Wish wish;
    bool is_written = false;
};

wire::Calibration calibrate(const calibrating::Question& question, const std::string& interface) {
    const std::array<socketcan::IdFilter, 3> filters{
        {{wire::can_id(wire::FrameType::heartbeat, question.node_id), wire::kStandardIdMax},
         {wire::can_id(wire::FrameType::calibration, question.node_id), wire::kStandardIdMax},
         {wire::can_id(wire::FrameType::node_info, question.node_id), wire::kStandardIdMax}}};
    socketcan::CanSocket socket = open_can(interface, {.filters = filters, .wants_error_frames = false});
    const Outside outside = this_machine();
    calibrating::Dialogue dialogue(question, outside.now());
    return value_or_fail(calibrating::converse(dialogue, socket, outside));
}

void run(CalibrateOptions options) {
    options.wish.quantity = options.quantity == "offset" ? wire::CalibrationQuantity::offset
                                                         : wire::CalibrationQuantity::crosstalk;
    const rig::Rig rig = value_or_fail(read_given_rig(options.rig));
    const auto question = value_or_fail(calibrating::question_of(rig, options.wish, new_sequence()));
    fmt::print(stderr, "{} of node {} '{}', sensor '{}', target at {} mm: 50 ranges\n", options.quantity,
               question.node_id, question.node_name, question.sensor_name, question.target_mm);
    const rig::SensorEdit edit = calibrating::edit_of(question, calibrate(question, options.interface));
    print("{}: {}\n", edit.key, edit.value);
    if (!options.is_written) {
        fmt::print(stderr, "not written; --write writes it into the sensor's entry of the rig\n");
        return;
    }
    const auto file = value_or_fail(calibrating::write_into_rig(options.rig, edit));
    fmt::print(stderr,
               "written to {}; it takes effect once the node is flashed: octoskin flash --rig {} --node {} "
               "--elf IMAGE (in octoskin's sources firmware/flash builds the image, too)\n",
               file.string(), options.rig.string(), question.node_name);
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
    auto options = std::make_shared<CalibrateOptions>();
    CLI::App* command = app.add_subcommand("calibrate", kCalibrateAbout);
    command->add_option("quantity", options->quantity, "offset or crosstalk")
        ->required()
        ->check(CLI::IsMember({"offset", "crosstalk"}));
    command->add_option("--rig", options->rig, "Rig (YAML)")->required();
    command->add_option("--node", options->wish.node,
                        "Name or number of the node; needed if the rig has several");
    command->add_option("--sensor", options->wish.sensor, "Name of the sensor")->required();
    command->add_option("--target-mm", options->wish.target_mm, "From the sensor's front to the target, mm")
        ->required()
        ->check(from_to(1, 4'000));
    command
        ->add_option(
            "--can", options->interface,
            "CAN interface of Linux, such as can0, or fd:N, an open socket that carries frames as one")
        ->required();
    command->add_flag("--write", options->is_written, "Write the result into the rig");
    command->callback([options] { run(*options); });
}

}  // namespace octoskin::app
