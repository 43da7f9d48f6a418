// octoskin black-box: the I2C transfers of a node before a fault, from a candump log.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "common/wire/codec.hpp"
#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/core/black_box/dump_assembler.hpp"
#include "host/core/black_box/transfer_script.hpp"
#include "host/io/candump/log_reader.hpp"

namespace octoskin::app {
namespace {

struct Pieces {
    DumpAssembler assembler;
    std::uint64_t dumps = 0;
    std::uint64_t incomplete = 0;

    void take(const Dump& dump) {
        ++dumps;
        incomplete += dump.is_complete ? 0U : 1U;
        print_text(transfer_script(dump) + "\n");
    }
    void take(const wire::CanFrame& frame) {
        const auto decoded = wire::decode(frame);
        if (!decoded) return;
        const auto* piece = std::get_if<wire::BlackBox>(&decoded->message);
        if (piece == nullptr) return;
        if (const auto dump = assembler.take(decoded->node_id, *piece)) take(*dump);
    }
};

void print_black_boxes(const std::filesystem::path& log) {
    auto reader = candump::LogReader::open(log);
    if (!reader) throw CommandFailure(reading_error(ExitCode::no_input, reader.error()));
    Pieces pieces;
    while (true) {
        const auto entry = reader->next();
        if (!entry) throw CommandFailure(reading_error(ExitCode::bad_data, entry.error()));
        if (!*entry) break;
        pieces.take((*entry)->frame);
    }
    if (const auto foreign = reader->foreign_file()) throw CommandFailure(ExitCode::bad_data, *foreign);
    if (reader->inputs().used() == 0)
        throw CommandFailure(ExitCode::bad_data,
                             in_file({ErrorCode::no_content, "no frames: the log is empty"}, log));
    for (const Dump& dump : pieces.assembler.finish()) pieces.take(dump);
    spdlog::info("{}: {} dumps, {} of them incomplete", log.string(), pieces.dumps, pieces.incomplete);
}

}  // namespace

void add_black_box_command(CLI::App& app) {
    auto log = std::make_shared<std::filesystem::path>();
    CLI::App* command = app.add_subcommand(
        "black-box", "Print the I2C transfers that nodes recorded before a fault, as test scripts");
    command->add_option("log", *log, "candump log with BLACK_BOX frames in it")
        ->required()
        ->check(existing_file());
    command->callback([log] { print_black_boxes(*log); });
}

}  // namespace octoskin::app
