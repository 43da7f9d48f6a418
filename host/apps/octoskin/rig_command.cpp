// octoskin rig: checks a rig, and prints the loads of its buses.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/wire/bus_load.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/flashing/flashing.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/query/joint_lines.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/rig/new_rig.hpp"
#include "host/apps/rig/rig_picture.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/can_load.hpp"
#include "hw/rigfile/i2c_load.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/phase_spread.hpp"
#include "hw/rigfile/reflex.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::app {
namespace {

struct RigOptions {
    std::filesystem::path rig;
    GivenRobot robot;
    bool prints_canonical = false;
    std::string node;
    std::filesystem::path block;
    std::filesystem::path picture;
    std::string joints;
    std::filesystem::path new_robot;
    std::string base_link;
    std::vector<SensorRing> rings;
    std::filesystem::path out;
};

/// The load of each bus, and whether other values of phase_us would improve it.
void describe_i2c(const rig::Node& node) {
    for (std::uint8_t bus = 0; bus < node.board.i2c_bus_count; ++bus) {
        const double load = rig::i2c_load(node.config, bus);
        if (load == 0.0) continue;
        const rig::PhaseSpread spread = rig::phase_spread(node.config, bus);
        print("    I2C bus {} at {} kHz: load {:.1f} %, at most {:.0f} %; {:.0f} % of its busiest 5 ms{}\n",
              bus, node.config.i2c_hz / 1000, 100.0 * load, 100.0 * rig::kI2cLoadMax, 100.0 * spread.peak,
              spread.is_even() ? "" : ": phase_us could spread the readings better");
    }
    for (const auto& group : rig::groups_ranging_together(node)) {
        std::vector<std::string> names;
        for (const std::size_t sensor : group) names.push_back(node.sensors[sensor].name);
        print(
            "    {}: neighbours among these see the same light and range at the same time: set their "
            "phase_us apart\n",
            rig::joined(names));
    }
}

void describe(const rig::Rig& rig, const HostSetup& host) {
    print("rig {}: hash {:08x}, robot {}: {} links at or below {}, {} capsules\n", rig.name,
          rig::rig_hash(rig), rig.urdf.filename(), host.robot.link_count(), rig.base_link,
          host.rig.body.size());
    for (const LinkWithoutBody& link : host.rig.links_without_body) {
        print("  link {}: no body{}\n", link.link,
              link.is_listed ? ", as the rig lists" : ": a query answers unknown instead of free");
    }
    for (const LinkWithBorrowedBody& link : host.rig.links_with_borrowed_body)
        print("  link {}: no body of its own: it uses that of {}, which is fixed to it\n", link.link,
              link.body_of);
    for (const rig::Node& node : rig.nodes) {
        print("  node {} '{}': {} sensors, node_hash {:08x}\n", node.config.node_id, node.name,
              node.sensors.size(), node_hash(node.config));
        describe_i2c(node);
        for (const std::string& line : rig::reflex_lines(node)) print("    {}\n", line);
    }
    for (const rig::JointSource& source : rig.joint_sources)
        print("  node {} sends {} joints at {:g} Hz{}\n", source.node_id, source.joints.size(),
              source.rate_hz, source.way == rig::JointWay::socket ? " through the joint socket" : "");
    for (const rig::Camera& camera : rig.cameras)
        print("  {} {} x {} at {:g} Hz{}\n", camera_text(camera.name), camera.width, camera.height,
              camera.rate_hz, camera.link.empty() ? "" : " on " + camera.link);
    print("  CAN{} {} bit/s{}: load {:.1f} % in the worst case, at most {:.0f} %\n",
          rig.bus.uses_can_fd ? " FD" : "", rig.bus.nominal_bitrate,
          rig.bus.uses_can_fd ? fmt::format(" / {} bit/s", rig.bus.data_bitrate) : "",
          100.0 * rig::can_load(rig), 100.0 * wire::kBusLoadLimit);
}

/// The files of a rig are its only source, and not written by anything else.
void refuse_output_over_rig(const rig::Rig& rig, const RigOptions& options) {
    std::vector<std::filesystem::path> files{options.rig, rig.urdf.shown()};
    for (const FilePlace& extended : rig.extended_files) files.push_back(extended.shown());
    const auto& output = options.block.empty() ? options.picture : options.block;
    if (const auto checked = check_replaces_none(output, files); !checked)
        throw CommandFailure(checked.error());
}

/// The same bytes that `octoskin flash` writes to a microcontroller's page.
void write_block(const rig::Rig& rig, const RigOptions& options) {
    const auto node = flashing::choose_node(rig, options.node);
    if (!node) throw CommandFailure(node.error());
    std::array<std::uint8_t, kNodeConfigBytesMax> memory{};
    const auto block = encode(node->config, memory);
    const std::string_view bytes(reinterpret_cast<const char*>(block.data()), block.size());
    if (const auto written = write_text(options.block, bytes); !written)
        throw CommandFailure(written.error());
    print("node {} '{}': node_hash {:08x}, {} bytes in {}\n", node->config.node_id, node->name,
          node_hash(node->config), block.size(), options.block.string());
}

std::vector<double> posture_of(const RigOptions& options, const RobotModel& robot) {
    if (options.joints.empty()) return posture_at_rest(robot);
    const auto numbers = read_numbers(options.joints);
    if (numbers && numbers->size() == robot.joint_count()) return *numbers;
    throw CommandFailure(ExitCode::usage,
                         {.code = ErrorCode::bad_argument,
                          .what = fmt::format("expected {} numbers, one for each joint", robot.joint_count()),
                          .value = "'" + options.joints + "'",
                          .key = "--joints"});
}

void write_picture(const HostSetup& host, const RigOptions& options) {
    const std::string picture = rig_picture(host, posture_of(options, host.robot));
    if (const auto written = write_text(options.picture, picture); !written)
        throw CommandFailure(written.error());
    print("{}: look whether sensors and cameras are where they are on the robot\n", options.picture.string());
}

/// As a rig in `file` has to name it: relative, if it is given so.
std::string named_in_rig(const std::filesystem::path& file, const std::filesystem::path& rig) {
    const auto absolute = std::filesystem::absolute(file).lexically_normal();
    if (rig.empty() || file.is_absolute()) return absolute.string();
    return absolute.lexically_relative(std::filesystem::absolute(rig).lexically_normal().parent_path())
        .string();
}

void write_new(const RigOptions& options) {
    if (!options.out.empty() && std::filesystem::exists(options.out)) {
        throw CommandFailure(ExitCode::cannot_create, {.code = ErrorCode::already_exists,
                                                       .what = "exists already",
                                                       .remedy = "give another name, or remove it",
                                                       .file = options.out});
    }
    const auto board = shipped_file("hw/boards/nucleo_g474re.yaml");
    const std::string text =
        value_or_fail(new_rig_text({.robot = {options.new_robot, options.robot.packages},
                                    .base_link = options.base_link,
                                    .rings = options.rings,

                                    .robot_in_rig = named_in_rig(options.new_robot, options.out),
                                    .board_in_rig = board.string()}));
    if (options.out.empty()) {
        print_exactly(text);
        return;
    }
    if (const auto written = write_text(options.out, text); !written) throw CommandFailure(written.error());
    print("{}: check it with `octoskin rig {}`\n", options.out.string(), options.out.string());
}

void run(const RigOptions& options) {
    if (!options.new_robot.empty()) return write_new(options);
    if (options.rig.empty())
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "expected a rig, or --new with a robot",
                                               .remedy = "see octoskin rig --help"});
    const rig::Rig rig =
        value_or_fail(read_rig_with_body(options.rig, options.robot, BodyFitting::if_needed));
    refuse_output_over_rig(rig, options);
    const auto host = make_host_setup(rig);
    if (!host) throw CommandFailure(reading_error(ExitCode::bad_config, host.error()));
    for (const std::string& warning : host->warnings) spdlog::warn("{}", warning);
    if (!options.block.empty()) {
        write_block(rig, options);
    } else if (!options.picture.empty()) {
        write_picture(*host, options);
    } else if (options.prints_canonical) {
        print_exactly(rig::canonical_text(rig, rig.urdf.shown().string()));
    } else {
        describe(rig, *host);
    }
}

}  // namespace

void add_rig_command(CLI::App& app) {
    auto options = std::make_shared<RigOptions>();
    CLI::App* command = app.add_subcommand(
        "rig",
        "Check a rig and its robot; print nodes, hashes and loads of the buses; draw one; write a new one");
    auto* const rig = command->add_option("rig", options->rig, "Rig (YAML)")->check(existing_file());
    add_robot_options(*command, options->robot, "Robot (URDF) in place of the rig's");
    auto* const canonical = command->add_flag("--canonical", options->prints_canonical,
                                              "Print the rig in full, in its canonical form");
    auto* const node = command->add_option(
        "--node", options->node, "For --block: name or number of the node; required if the rig has several");
    auto* const block =
        command->add_option("--block", options->block,
                            "Write a node's configuration block to this file, for octoskin-node --config");
    auto* const picture =
        command->add_option("--picture", options->picture,
                            "Draw arm, sensors, cones and cameras to this file (SVG), to be looked at");
    command
        ->add_option("--joints", options->joints,
                     "For --picture: the posture, as 0.1,-0.5,...; default: 0 of each")
        ->needs(picture);
    auto* const new_rig =
        command->add_option("--new", options->new_robot, "Write a rig for this robot (URDF)");
    new_rig->check(existing_file())->excludes(rig)->excludes(canonical)->excludes(picture)->excludes(block);
    command->add_option("--base", options->base_link, "For --new: base link; default: the root")
        ->needs(new_rig);
    command
        ->add_option_function<std::vector<std::string>>(
            "--ring",
            [options](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    auto ring = sensor_ring_of(text);
                    if (!ring) throw CommandFailure(ExitCode::usage, ring.error());
                    options->rings.push_back(*std::move(ring));
                }
            },
            "For --new: N sensors around a link's body at Z metres along its z, looking outward; may be "
            "given "
            "several times")
        ->type_name("LINK,N,Z")
        ->allow_extra_args(false)
        ->needs(new_rig);
    command->add_option("--out", options->out, "For --new: the rig's file; default: standard output")
        ->needs(new_rig);
    block->excludes(canonical)->excludes(picture);
    canonical->excludes(picture);
    node->needs(block);
    command->callback([options] { run(*options); });
}

}  // namespace octoskin::app
