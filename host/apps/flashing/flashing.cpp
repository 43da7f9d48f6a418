#include "host/apps/flashing/flashing.hpp"

#include <fmt/format.h>

#include "common/wire/crc.hpp"
#include "host/apps/flashing/openocd_script.hpp"
#include "host/apps/flashing/record.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "hw/image/image_check.hpp"

namespace octoskin::flashing {
namespace {

constexpr const char* kLogFile = "openocd.log";
constexpr std::chrono::seconds kPatience{60};
constexpr std::chrono::seconds kRehearsalPatience{20};

Result<image::ElfImage, AppError> load_image(const Order& order) {
    std::error_code ignored;
    if (!std::filesystem::exists(order.elf, ignored)) {
        return fail(ExitCode::no_input, {.code = ErrorCode::not_found,
                                         .what = "no such file",
                                         .remedy = "build it with `firmware/flash` of octoskin's sources, or "
                                                   "give a built image with --elf",
                                         .file = order.elf});
    }
    auto image = image::ElfImage::load(order.elf.string());
    if (!image) return unexpected(reading_error(order.elf, {ExitCode::bad_data, image.error()}));
    const std::vector<std::string> faults = image::faults_of(*image, order.board);
    if (faults.empty()) return image.value();
    return fail(ExitCode::bad_data, {.code = ErrorCode::mismatch,
                                     .what = fmt::format("not an image for the board {}: {}",
                                                         order.board.name, fmt::join(faults, "; ")),
                                     .file = order.elf});
}

/// Reads the block back from the bytes that will be written, as the board will read it.
Result<std::size_t, AppError> check_block(const Order& order, const image::FlashContents& contents) {
    const image::FlashPart& page = contents.back();
    const auto decoded = decode_node_config(page.bytes);
    const bool is_nodes = decoded && *decoded == order.node.config;
    if (!is_nodes || page.address != order.board.configuration_page.address) {
        return fail(ExitCode::bad_config,
                    {.code = ErrorCode::bad_value,
                     .what = "its configuration block does not read back as the rig's configuration",
                     .key = "node " + order.node.name});
    }
    return page.bytes.size();
}

Result<Done, AppError> write_files(const Order& order, const image::FlashContents& contents) {
    std::error_code error;
    std::filesystem::create_directories(order.folder, error);
    if (error) {
        return cannot_create(order.folder,
                             {.code = error == std::errc::permission_denied ? ErrorCode::no_permission
                                                                            : ErrorCode::system_error,
                              .what = fmt::format("cannot be created ({})", error.message()),
                              .remedy = "choose another folder with --out"});
    }
    // Checks all files before any programming: a board must not be programmed without a record.
    for (const char* const name : {kHexFile, kScriptFile, kLogFile, kRecordFile}) {
        if (auto checked = check_text_place({NamedFolder(order.folder), name}); !checked) return checked;
    }
    if (auto done = write_text({NamedFolder(order.folder), kHexFile}, image::intel_hex(contents)); !done)
        return done;
    return write_text({NamedFolder(order.folder), kScriptFile},
                      openocd_script({.openocd_board = order.board.openocd_board,
                                      .device_id = order.board.device_id,
                                      .adapter_serial = order.adapter_serial,
                                      .writes_option_bytes = order.writes_option_bytes}));
}

std::string script_for_openocd() {
    return std::string(kOpenocdFolder) + "/" + kScriptFile;
}

Result<OpenocdRun, AppError> run(const Order& order, std::vector<std::string> arguments,
                                 std::chrono::seconds patience) {
    const auto folder = OpenFolder::open(order.folder, FolderAccess::write);
    if (!folder) return fail(ExitCode::cannot_create, to_error(folder.error()));
    const OpenocdRun run = run_openocd(*folder, std::move(arguments), patience);
    if (auto done = write_text({NamedFolder(order.folder), kLogFile}, run.output); !done)
        return unexpected(done.error());
    return run;
}

}  // namespace

Result<rig::Node, AppError> choose_node(const rig::Rig& rig, const std::string& wanted) {
    std::string names;
    for (const rig::Node& node : rig.nodes) {
        const bool is_only = wanted.empty() && rig.nodes.size() == 1;
        if (is_only || node.name == wanted || std::to_string(node.config.node_id) == wanted) return node;
        names += (names.empty() ? "" : ", ") + node.name;
    }
    if (wanted.empty()) {
        return fail(ExitCode::usage, {.code = ErrorCode::bad_argument,
                                      .what = "is missing",
                                      .remedy = "give one of " + names,
                                      .key = "--node"});
    }
    return fail(ExitCode::usage,
                {.code = ErrorCode::unknown_name,
                 .what = fmt::format("expected a node of rig {}, which has {}", rig.name, names),
                 .value = "'" + wanted + "'",
                 .key = "--node"});
}

Result<Prepared, AppError> prepare(const Order& order) {
    if (order.node.board.name != order.board.name) {
        return fail(ExitCode::bad_config, {.code = ErrorCode::mismatch,
                                           .what = "expected a node with the board " + order.board.name,
                                           .value = order.node.board.name,
                                           .key = "node " + order.node.name});
    }
    const auto image = load_image(order);
    if (!image) return unexpected(image.error());
    Prepared prepared;
    const auto bytes = image::binary(*image, order.board);
    prepared.image_bytes = bytes.size();
    prepared.image_crc32 = crc32(bytes);
    prepared.contents = image::merge(*image, order.node.config, order.board);
    const auto block_bytes = check_block(order, prepared.contents);
    if (!block_bytes) return unexpected(block_bytes.error());
    prepared.block_bytes = *block_bytes;
    if (const auto written = write_files(order, prepared.contents); !written)
        return unexpected(written.error());
    return prepared;
}

Result<Programmed, AppError> program(const Order& order) {
    const auto ended = run(order, {"-f", script_for_openocd()}, kPatience);
    if (!ended) return unexpected(ended.error());
    return judge(*ended, {.device_id = order.board.device_id, .adapter_serial = order.adapter_serial});
}

Result<Done, AppError> rehearse(const Order& order) {
    const auto ended =
        run(order, {"-c", "set octoskin_dry_run 1", "-f", script_for_openocd()}, kRehearsalPatience);
    if (!ended) return unexpected(ended.error());
    if (const auto fault = judge_dry_run(*ended)) return unexpected(*fault);
    return Done{};
}

}  // namespace octoskin::flashing
