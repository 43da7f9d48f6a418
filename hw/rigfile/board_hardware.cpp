#include "hw/rigfile/board_hardware.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {
namespace {

constexpr std::int64_t kHertzMax = 1'000'000'000;

MemoryRange read_range(const Table& memory, std::string_view key) {
    const Table table(memory.require(key), memory.path_of(key), {"address", "size_bytes"});
    MemoryRange range{.address = table.integer<std::uint32_t>("address", {0, 0xFFFF'FFFF}),
                      .size_bytes = table.integer<std::uint32_t>("size_bytes", {1, 0x4000'0000})};
    if (range.end() > 0x1'0000'0000)
        table.fail("size_bytes", "expected a range below 4 GiB, found one that ends above");
    return range;
}

void read_memory(const Table& top, BoardHardware& board) {
    const Table memory(top.require("memory"), "memory",
                       {"flash", "configuration_page", "ram", "vector_count"});
    board.flash = read_range(memory, "flash");
    board.configuration_page = read_range(memory, "configuration_page");
    board.ram = read_range(memory, "ram");
    board.vector_count = memory.integer<std::uint32_t>("vector_count", {2, 512});
    const MemoryRange& page = board.configuration_page;
    if (!board.flash.contains(page.address, page.size_bytes) || page.end() != board.flash.end()) {
        memory.fail("configuration_page", "expected a range at the end of flash, found another place");
    }
}

void read_clocks(const Table& top, BoardHardware& board) {
    const Table clocks(top.require("clocks"), "clocks",
                       {"crystal_hz", "core_hz", "can_hz", "i2c_hz_max", "serial_baud"});
    const auto hertz = [&](std::string_view key) {
        return clocks.integer<std::uint32_t>(key, {1, kHertzMax});
    };
    board.crystal_hz = hertz("crystal_hz");
    board.core_hz = hertz("core_hz");
    board.can_hz = hertz("can_hz");
    board.i2c_hz_max = hertz("i2c_hz_max");
    board.serial_baud = hertz("serial_baud");
}

/// "PA15": ports A to G, numbers 0 to 15.
BoardPin read_pin(const Table& table) {
    const std::string name = table.name("pin");
    const bool has_shape =
        (name.size() == 3 || name.size() == 4) && name[0] == 'P' && name[1] >= 'A' && name[1] <= 'G';
    const std::string digits = has_shape ? name.substr(2) : "";
    const bool is_number = has_shape && digits.find_first_not_of("0123456789") == std::string::npos &&
                           (digits.size() == 1 || digits[0] == '1') && std::stoi(digits) < 16;
    if (!is_number) table.fail("pin", fmt::format("expected a pin from PA0 to PG15, found '{}'", name));
    return {.port = name[1], .number = static_cast<std::uint8_t>(std::stoi(digits))};
}

std::map<BoardPin, std::string> read_reserved(const Table& top) {
    std::map<BoardPin, std::string> reserved;
    const std::string path = "reserved_pins";
    for (const Value& item : read_list(top.require(path), path)) {
        const Table table(item, path, {"pin", "why"});
        reserved[read_pin(table)] = table.require("why").text;
    }
    return reserved;
}

BoardSignal read_signal(const Table& table) {
    BoardSignal signal{.signal = table.name("signal"),
                       .pin = read_pin(table),
                       .connector = table.name("connector"),
                       .function = table.name("function"),
                       .alternate = std::nullopt};
    const bool is_input = signal.function == "input";
    if (is_input) {
        signal.is_pulled_up = table.choice<bool>("pull", {{"up", true}, {"none", false}});
    } else {
        signal.is_open_drain = table.choice<bool>("drive", {{"open_drain", true}, {"push_pull", false}});
    }
    if (table.find(is_input ? "drive" : "pull"))
        table.fail("function", "expected `pull` with `input`, `drive` with every other function");
    if (table.find("alternate")) signal.alternate = table.integer<std::uint8_t>("alternate", {0, 15});
    if (signal.alternate.has_value() == (is_input || signal.function == "output")) {
        table.fail("function",
                   "expected `input` or `output` without `alternate`, or another function with it");
    }
    return signal;
}

void read_signals(const Table& top, BoardHardware& board) {
    const auto reserved = read_reserved(top);
    std::map<BoardPin, std::string> taken;
    std::set<std::string> names;
    const auto& items = read_list(top.require("pins"), "pins");
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table table(items[i], fmt::format("pins[{}]", i),
                          {"signal", "pin", "connector", "function", "alternate", "drive", "pull"});
        BoardSignal signal = read_signal(table);
        if (const auto found = reserved.find(signal.pin); found != reserved.end()) {
            table.fail("pin",
                       fmt::format("expected a free pin, found {}: {}", text(signal.pin), found->second));
        }
        if (const auto [first, is_new] = taken.try_emplace(signal.pin, signal.signal); !is_new) {
            table.fail("pin", fmt::format("expected a free pin, found {}: {} has it", text(signal.pin),
                                          first->second));
        }
        if (!names.insert(signal.signal).second) {
            table.fail("signal", fmt::format("expected each signal once, found {} again", signal.signal));
        }
        board.signals.push_back(std::move(signal));
    }
}

}  // namespace

std::string text(const BoardPin& pin) {
    return fmt::format("P{}{}", pin.port, pin.number);
}

Result<BoardHardware, RigError> read_board_hardware(const std::filesystem::path& file) {
    try {
        const Value document = load_document(file);
        const Table top(document, "",
                        {"name", "openocd_board", "device_id", "memory", "clocks", "pins", "reserved_pins"});
        BoardHardware board;
        board.name = top.folder_name("name");
        board.openocd_board = top.name("openocd_board");
        board.device_id = top.integer<std::uint32_t>("device_id", {0, 0xFFF});
        read_memory(top, board);
        read_clocks(top, board);
        read_signals(top, board);
        return board;
    } catch (const Fault& fault) {
        return unexpected(fault.error);
    }
}

}  // namespace octoskin::rig
