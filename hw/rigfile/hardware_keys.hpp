// The one declaration of each key of a board's hardware file, `hw/boards/<board>.hardware.yaml`.
#pragma once

#include <array>
#include <span>

#include "hw/rigfile/key.hpp"

namespace octoskin::rig {

/// All tables of the file, which are one table of docs/rig.md. Each declared key is in one of them.
[[nodiscard]] std::span<const KeyTable> hardware_key_tables() noexcept;

namespace hardware_keys {

/// The keys of each table; the namespace below with its name has their declarations.
extern const KeyTable kTop;
extern const KeyTable kMemory;
extern const KeyTable kMemoryRange;
extern const KeyTable kClocks;
extern const KeyTable kSignal;
extern const KeyTable kReservedPin;

inline constexpr TextKey kName{
    .path = "name", .kind = TextKind::folder_name, .meaning = "the name of the type of board"};
inline constexpr TextKey kOpenocdBoard{.path = "openocd_board",
                                       .meaning = "the script of OpenOCD for the board"};
inline constexpr IntegerKey kDeviceId{
    .path = "device_id", .range = {0, 0xFFF}, .meaning = "of the chip, as its debug port reads it"};
inline constexpr TableKey kMemoryTable{.path = "memory", .meaning = "the chip's memory"};
inline constexpr TableKey kClocksTable{.path = "clocks", .meaning = "the clocks that the image sets"};
inline constexpr ListKey kPins{
    .path = "pins", .items = "signals", .meaning = "the pins in use; no pin and no signal twice"};
inline constexpr ListKey kReservedPins{
    .path = "reserved_pins", .items = "pins", .meaning = "pins that no signal may have"};

namespace memory {
inline constexpr std::string_view kExpected = "`address` and `size_bytes`";
inline constexpr TableKey kFlash{.path = "memory.flash", .expected = kExpected, .meaning = "the whole flash"};
inline constexpr TableKey kConfigurationPage{
    .path = "memory.configuration_page",
    .expected = kExpected,
    .meaning = "page of the node's configuration block, at the end of flash; the image ends before it"};
inline constexpr TableKey kRam{
    .path = "memory.ram", .expected = kExpected, .meaning = "the RAM that the image uses"};
inline constexpr IntegerKey kVectorCount{
    .path = "memory.vector_count",
    .range = {2, 512},
    .meaning = "entries of the vector table, the initial stack pointer included"};
}  // namespace memory

/// Of `memory.flash`, `memory.configuration_page` and `memory.ram`.
namespace memory_range {
inline constexpr IntegerKey kAddress{
    .path = "memory.*.address", .range = {0, 0xFFFF'FFFF}, .meaning = "first address of flash, page or RAM"};
inline constexpr IntegerKey kSize{.path = "memory.*.size_bytes",
                                  .unit = "bytes",
                                  .range = {1, 0x4000'0000},
                                  .meaning = "its size; it must end below 4 GiB"};
}  // namespace memory_range

namespace clocks {
inline constexpr Range<std::int64_t> kFrequency_hz{1, 1'000'000'000};
inline constexpr IntegerKey kCrystal{
    .path = "clocks.crystal_hz", .unit = "Hz", .range = kFrequency_hz, .meaning = "the board's crystal"};
inline constexpr IntegerKey kCore{
    .path = "clocks.core_hz", .unit = "Hz", .range = kFrequency_hz, .meaning = "the processor"};
inline constexpr IntegerKey kCan{
    .path = "clocks.can_hz", .unit = "Hz", .range = kFrequency_hz, .meaning = "the CAN controller"};
inline constexpr IntegerKey kI2cMax{.path = "clocks.i2c_hz_max",
                                    .unit = "Hz",
                                    .range = kFrequency_hz,
                                    .meaning = "the fastest clock of its I2C buses"};
inline constexpr IntegerKey kSerialBaud{
    .path = "clocks.serial_baud", .unit = "baud", .range = kFrequency_hz, .meaning = "the serial line"};
}  // namespace clocks

namespace signal {
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kDrives{
    {{"open_drain", true}, {"push_pull", false}}};
inline constexpr std::array<std::pair<std::string_view, bool>, 2> kPulls{{{"up", true}, {"none", false}}};
inline constexpr TextKey kSignal{.path = "pins[].signal", .meaning = "octoskin's name of the signal"};
inline constexpr TextKey kPin{.path = "pins[].pin", .meaning = "from `PA0` to `PG15`"};
inline constexpr TextKey kConnector{.path = "pins[].connector",
                                    .meaning = "its place on the board, as `CN7-17`"};
inline constexpr TextKey kFunction{
    .path = "pins[].function",
    .meaning = "`input`, `output`, or the datasheet's name of the pin's alternate function"};
inline constexpr IntegerKey kAlternate{
    .path = "pins[].alternate",
    .range = {0, 15},
    .fallback = {.text = "none"},
    .meaning = "number of the alternate function; required with one, refused with `input` and `output`"};
/// The meaning of its words: open drain.
inline constexpr WordKey<bool> kDrive{
    .path = "pins[].drive",
    .words = kDrives,
    .fallback = {.text = "none"},
    .meaning = "how the pin drives; required with each function but `input`, refused with that"};
/// The meaning of its words: pulled up by the chip's own resistor.
inline constexpr WordKey<bool> kPull{
    .path = "pins[].pull",
    .words = kPulls,
    .fallback = {.text = "none"},
    .meaning = "the chip's own resistor; required with `input`, refused with every other function"};
}  // namespace signal

namespace reserved_pin {
inline constexpr TextKey kPin{.path = "reserved_pins[].pin", .meaning = "from `PA0` to `PG15`"};
inline constexpr TableKey kWhy{
    .path = "reserved_pins[].why", .expected = "a text", .meaning = "the reason, for the message"};
}  // namespace reserved_pin

}  // namespace hardware_keys
}  // namespace octoskin::rig
