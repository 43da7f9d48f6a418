#include "hw/rigfile/hardware_keys.hpp"

namespace octoskin::rig {
namespace hardware_keys {
namespace {

constexpr auto kTopKeys = std::to_array<AnyKey>(
    {&kName, &kOpenocdBoard, &kDeviceId, &kMemoryTable, &kClocksTable, &kPins, &kReservedPins});
constexpr auto kMemoryKeys = std::to_array<AnyKey>(
    {&memory::kFlash, &memory::kConfigurationPage, &memory::kRam, &memory::kVectorCount});
constexpr auto kMemoryRangeKeys = std::to_array<AnyKey>({&memory_range::kAddress, &memory_range::kSize});
constexpr auto kClocksKeys = std::to_array<AnyKey>(
    {&clocks::kCrystal, &clocks::kCore, &clocks::kCan, &clocks::kI2cMax, &clocks::kSerialBaud});
constexpr auto kSignalKeys =
    std::to_array<AnyKey>({&signal::kSignal, &signal::kPin, &signal::kConnector, &signal::kFunction,
                           &signal::kAlternate, &signal::kDrive, &signal::kPull});
constexpr auto kReservedPinKeys = std::to_array<AnyKey>({&reserved_pin::kPin, &reserved_pin::kWhy});

/// The reference page has all these keys in one table.
constexpr std::string_view kTitle = "hardware keys of a board";

}  // namespace

constinit const KeyTable kTop{kTitle, kTopKeys};
constinit const KeyTable kMemory{kTitle, kMemoryKeys};
constinit const KeyTable kMemoryRange{kTitle, kMemoryRangeKeys};
constinit const KeyTable kClocks{kTitle, kClocksKeys};
constinit const KeyTable kSignal{kTitle, kSignalKeys};
constinit const KeyTable kReservedPin{kTitle, kReservedPinKeys};

}  // namespace hardware_keys

std::span<const KeyTable> hardware_key_tables() noexcept {
    using namespace hardware_keys;
    static const std::array kTables{kTop, kMemory, kMemoryRange, kClocks, kSignal, kReservedPin};
    return kTables;
}

}  // namespace octoskin::rig
