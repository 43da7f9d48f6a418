// octoskin flash: an image and one node's configuration into a sensor board.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/flashing/flashing.hpp"
#include "host/apps/flashing/record.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "hw/image/option_bytes.hpp"

namespace octoskin::app {
namespace {

constexpr const char* kFlashAbout =
    "Check the image, merge the node's configuration block, program and verify through OpenOCD and the "
    "board's "
    "ST-LINK. The files, what OpenOCD said and a record go to --out. docs/hardware/flashing.md has the "
    "details";

struct FlashOptions {
    std::filesystem::path rig;
    std::string node;
    std::filesystem::path elf;
    std::filesystem::path folder;
    std::string adapter_serial;
    bool writes_option_bytes = false;
    bool is_dry_run = false;
};

rig::BoardHardware read_board(const rig::Node& node) {
    const auto file = shipped_file("hw/boards/" + node.board.name + ".hardware.yaml");
    if (!std::filesystem::exists(file)) {
        throw CommandFailure(ExitCode::bad_config,
                             {.code = ErrorCode::unsupported,
                              .what = "expected a board that can be flashed",
                              .value = "'" + node.board.name + "'",
                              .remedy = fmt::format(
                                  "a Linux board takes `octoskin rig RIG --node {} --block FILE`", node.name),
                              .key = fmt::format("node '{}'", node.name)});
    }
    const auto board = rig::read_board_hardware(file);
    if (!board) throw CommandFailure(reading_error(ExitCode::bad_config, board.error()));
    return *board;
}

flashing::Order make_order(const FlashOptions& options) {
    if (!std::all_of(options.adapter_serial.begin(), options.adapter_serial.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0; })) {
        throw CommandFailure(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                               .what = "expected letters and digits",
                                               .value = "'" + options.adapter_serial + "'",
                                               .key = "--adapter-serial"});
    }
    const rig::Rig rig = value_or_fail(read_given_rig(options.rig));
    const rig::Node node = value_or_fail(flashing::choose_node(rig, options.node));
    flashing::Order order{.elf = options.elf,
                          .node = node,
                          .board = read_board(node),
                          .folder = options.folder,
                          .adapter_serial = options.adapter_serial,
                          .writes_option_bytes = options.writes_option_bytes};
    if (order.elf.empty())
        order.elf = shipped_file("build/firmware-release/bin/octoskin_node_" + node.board.name + ".elf");
    if (order.folder.empty())
        order.folder = std::filesystem::path("out/flash") / (rig.name + "_" + node.name);
    return order;
}

void write_record(const flashing::Order& order, const flashing::Prepared& prepared,
                  const std::optional<flashing::Programmed>& programmed) {
    (void)value_or_fail(write_text({NamedFolder(order.folder), flashing::kRecordFile},
                                   flashing::record(order, prepared, programmed)));
}

void describe(const flashing::Order& order, const flashing::Prepared& prepared) {
    const rig::BoardHardware& board = order.board;
    const std::uint32_t room = board.configuration_page.address - board.flash.address;
    print("image {}: fit for {}, {} bytes ({:.0f} % of its flash), CRC-32 {:08x}\n",
          order.elf.filename().string(), board.name, prepared.image_bytes,
          100.0 * static_cast<double>(prepared.image_bytes) / room, prepared.image_crc32);
    print("node {} '{}': {} sensors, node_hash {:08x}, {} bytes at 0x{:08X}\n", order.node.config.node_id,
          order.node.name, order.node.sensors.size(), node_hash(order.node.config), prepared.block_bytes,
          board.configuration_page.address);
    print("files in {}\n", order.folder.string());
}

/// Describes what a run without --dry-run would do with the option bytes.
void describe_option_bytes(const flashing::Order& order) {
    const image::MaskedWord wanted = image::wanted_option_bytes();
    print("option bytes (FLASH_OPTR, 0x{:08X}): would be read, and must contain {}\n", image::kOptionRegister,
          image::wanted_text());
    if (order.writes_option_bytes) {
        print(
            "  if they differ, 0x{:08X} would be written under the mask 0x{:08X} (all of these but {}), and "
            "the chip restarted\n",
            wanted.value, wanted.mask, image::unwritten_text());
    } else {
        print("  they would not be written: --write-option-bytes does that\n");
    }
}

/// The image is programmed, but the board is not as required: exit code 1.
void report_option_bytes(const flashing::Programmed& programmed) {
    const auto faults = image::option_byte_faults(programmed.flash_optr);
    if (faults.empty()) {
        print("option bytes 0x{:08X}: as required\n", programmed.flash_optr);
        return;
    }
    throw CommandFailure(
        ExitCode::failed,
        {.code = ErrorCode::mismatch,
         .what = fmt::format("programmed and running, but the option bytes are not as required: {}",
                             fmt::join(faults, "; ")),
         .value = fmt::format("0x{:08X}", programmed.flash_optr),
         .remedy = "run the same command with --write-option-bytes"});
}

void flash(const FlashOptions& options) {
    const flashing::Order order = make_order(options);
    const flashing::Prepared prepared = value_or_fail(flashing::prepare(order));
    describe(order, prepared);
    write_record(order, prepared, std::nullopt);
    if (options.is_dry_run) {
        (void)value_or_fail(flashing::rehearse(order));
        describe_option_bytes(order);
        print("dry run: OpenOCD has read the script; nothing was programmed\n");
        return;
    }
    const flashing::Programmed programmed = value_or_fail(flashing::program(order));
    write_record(order, prepared, programmed);
    print("programmed, verified, started\n");
    report_option_bytes(programmed);
}

}  // namespace

void add_flash_command(CLI::App& app) {
    auto options = std::make_shared<FlashOptions>();
    CLI::App* command = app.add_subcommand("flash", kFlashAbout);
    command->add_option("--rig", options->rig, "Rig (YAML)")->required()->check(existing_file());
    command->add_option("--node", options->node, "Name or number of the node; needed if the rig has several");
    command
        ->add_option("--elf", options->elf,
                     "Image; default: the one that the preset firmware-release built from octoskin's sources")
        ->check(existing_file());
    command->add_option("--out", options->folder, "Folder for the files; default: out/flash/RIG_NODE");
    command->add_option("--adapter-serial", options->adapter_serial,
                        "Serial number of the ST-LINK, if there are several");
    command->add_flag("--write-option-bytes", options->writes_option_bytes,
                      "Also set brown-out level and start from flash, if they differ");
    command->add_flag("--dry-run", options->is_dry_run, "Everything but the adapter");
    command->callback([options] { flash(*options); });
}

}  // namespace octoskin::app
