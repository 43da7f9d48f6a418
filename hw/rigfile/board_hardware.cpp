#include "hw/rigfile/board_hardware.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/hardware_keys.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {
namespace {

MemoryRange read_range(const Table& memory, const TableKey& key) {
    const Table table(memory.require(key), memory.path_of(key), hardware_keys::kMemoryRange);
    MemoryRange range{.address = table.integer<std::uint32_t>(hardware_keys::memory_range::kAddress),
                      .size_bytes = table.integer<std::uint32_t>(hardware_keys::memory_range::kSize)};
    if (range.end() > 0x1'0000'0000)
        table.fail(hardware_keys::memory_range::kSize,
                   {ErrorCode::out_of_range, "expected a range below 4 GiB", "one that ends above"});
    return range;
}

void read_memory(const Table& top, BoardHardware& board) {
    const Table memory(top.require(hardware_keys::kMemoryTable), top.path_of(hardware_keys::kMemoryTable),
                       hardware_keys::kMemory);
    board.flash = read_range(memory, hardware_keys::memory::kFlash);
    board.configuration_page = read_range(memory, hardware_keys::memory::kConfigurationPage);
    board.ram = read_range(memory, hardware_keys::memory::kRam);
    board.vector_count = memory.integer<std::uint32_t>(hardware_keys::memory::kVectorCount);
    const MemoryRange& page = board.configuration_page;
    if (!board.flash.contains(page.address, page.size_bytes) || page.end() != board.flash.end()) {
        memory.fail(hardware_keys::memory::kConfigurationPage,
                    {ErrorCode::bad_value, "expected a range at the end of flash", "another place"});
    }
}

void read_clocks(const Table& top, BoardHardware& board) {
    const Table clocks(top.require(hardware_keys::kClocksTable), top.path_of(hardware_keys::kClocksTable),
                       hardware_keys::kClocks);
    board.crystal_hz = clocks.integer<std::uint32_t>(hardware_keys::clocks::kCrystal);
    board.core_hz = clocks.integer<std::uint32_t>(hardware_keys::clocks::kCore);
    board.can_hz = clocks.integer<std::uint32_t>(hardware_keys::clocks::kCan);
    board.i2c_hz_max = clocks.integer<std::uint32_t>(hardware_keys::clocks::kI2cMax);
    board.serial_baud = clocks.integer<std::uint32_t>(hardware_keys::clocks::kSerialBaud);
}

/// "PA15": ports A to G, numbers 0 to 15.
BoardPin read_pin(const Table& table, const TextKey& key) {
    const std::string name = table.text(key);
    const bool has_shape =
        (name.size() == 3 || name.size() == 4) && name[0] == 'P' && name[1] >= 'A' && name[1] <= 'G';
    const std::string digits = has_shape ? name.substr(2) : "";
    const bool is_number = has_shape && digits.find_first_not_of("0123456789") == std::string::npos &&
                           (digits.size() == 1 || digits[0] == '1') && std::stoi(digits) < 16;
    if (!is_number)
        table.fail(key, {ErrorCode::bad_name, "expected a pin from PA0 to PG15", fmt::format("'{}'", name)});
    return {.port = name[1], .number = static_cast<std::uint8_t>(std::stoi(digits))};
}

std::map<BoardPin, std::string> read_reserved(const Table& top) {
    std::map<BoardPin, std::string> reserved;
    const std::string path = top.path_of(hardware_keys::kReservedPins);
    for (const Value& item : top.list(hardware_keys::kReservedPins)) {
        const Table table(item, path, hardware_keys::kReservedPin);
        reserved[read_pin(table, hardware_keys::reserved_pin::kPin)] =
            table.require(hardware_keys::reserved_pin::kWhy).text;
    }
    return reserved;
}

BoardSignal read_signal(const Table& table) {
    BoardSignal signal{.signal = table.text(hardware_keys::signal::kSignal),
                       .pin = read_pin(table, hardware_keys::signal::kPin),
                       .connector = table.text(hardware_keys::signal::kConnector),
                       .function = table.text(hardware_keys::signal::kFunction),
                       .alternate = std::nullopt};
    const bool is_input = signal.function == "input";
    if (is_input) {
        signal.is_pulled_up = table.choice(hardware_keys::signal::kPull);
    } else {
        signal.is_open_drain = table.choice(hardware_keys::signal::kDrive);
    }
    if (table.find(is_input ? hardware_keys::signal::kDrive : hardware_keys::signal::kPull))
        table.fail(hardware_keys::signal::kFunction,
                   {ErrorCode::conflict, "expected `pull` with `input`, `drive` with every other function"});
    if (table.find(hardware_keys::signal::kAlternate))
        signal.alternate = table.integer<std::uint8_t>(hardware_keys::signal::kAlternate);
    if (signal.alternate.has_value() == (is_input || signal.function == "output")) {
        table.fail(hardware_keys::signal::kFunction,
                   {ErrorCode::conflict,
                    "expected `input` or `output` without `alternate`, or another function with it"});
    }
    return signal;
}

void read_signals(const Table& top, BoardHardware& board) {
    const auto reserved = read_reserved(top);
    std::map<BoardPin, std::string> taken;
    std::set<std::string> names;
    const auto& items = top.list(hardware_keys::kPins);
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Table table(items[i], fmt::format("{}[{}]", top.path_of(hardware_keys::kPins), i),
                          hardware_keys::kSignal);
        BoardSignal signal = read_signal(table);
        if (const auto found = reserved.find(signal.pin); found != reserved.end()) {
            table.fail(hardware_keys::signal::kPin,
                       {ErrorCode::conflict, "expected a free pin", text(signal.pin), found->second});
        }
        if (const auto [first, is_new] = taken.try_emplace(signal.pin, signal.signal); !is_new) {
            table.fail(hardware_keys::signal::kPin,
                       {ErrorCode::duplicate, "expected a free pin", text(signal.pin),
                        fmt::format("{} has it", first->second)});
        }
        if (!names.insert(signal.signal).second) {
            table.fail(hardware_keys::signal::kSignal,
                       {ErrorCode::duplicate, "expected each signal once", signal.signal + " again"});
        }
        board.signals.push_back(std::move(signal));
    }
}

}  // namespace

std::string text(const BoardPin& pin) {
    return fmt::format("P{}{}", pin.port, pin.number);
}

Result<BoardHardware, Error> read_board_hardware(const std::filesystem::path& file) {
    try {
        const Value document = load_document(file);
        const Table top(document, "", hardware_keys::kTop);
        BoardHardware board;
        board.name = top.text(hardware_keys::kName);
        board.openocd_board = top.text(hardware_keys::kOpenocdBoard);
        board.device_id = top.integer<std::uint32_t>(hardware_keys::kDeviceId);
        read_memory(top, board);
        read_clocks(top, board);
        read_signals(top, board);
        return board;
    } catch (const Error& error) {
        return unexpected(error);
    }
}

}  // namespace octoskin::rig
