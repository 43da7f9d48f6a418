#include "hw/sim/stm32g474/system_bus.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace octoskin::sim::stm32 {
namespace {

constexpr std::uint32_t kPrivateBus = 0xE000'0000;
constexpr std::uint32_t kVendorPart = 0xE004'0000;  // DBGMCU

}  // namespace

void SystemBus::add(Peripheral& peripheral, std::uint32_t base, std::uint32_t size,
                    std::optional<ClockEnable> clock) {
    entries_.push_back({&peripheral, base, size, clock});
    std::ranges::sort(entries_, {}, &Entry::base);
}

SystemBus::Entry* SystemBus::find(std::uint32_t address) {
    auto after = std::ranges::upper_bound(entries_, address, {}, &Entry::base);
    if (after == entries_.begin()) return nullptr;
    Entry& entry = *std::prev(after);
    return address - entry.base < entry.size ? &entry : nullptr;
}

SystemBus::Entry* SystemBus::usable(std::uint32_t address, const char* what) {
    Entry* entry = find(address);
    if (entry == nullptr) {
        log_.report(Rule::not_modelled, fmt::format("{} of 0x{:08X}", what, address));
        return nullptr;
    }
    if (entry->clock && !rcc_.is_enabled(*entry->clock)) {
        log_.report(Rule::unclocked,
                    fmt::format("{} of {} at 0x{:08X}", what, entry->peripheral->name(), address));
        return nullptr;
    }
    entry->peripheral->advance();
    return entry;
}

std::uint32_t SystemBus::read(std::uint32_t address, std::uint32_t size) {
    if (address >= kPrivateBus && address < kVendorPart) return control_.read(address, size);
    Entry* entry = usable(address, "read");
    if (entry == nullptr) return 0;
    const std::uint32_t word = entry->peripheral->read((address - entry->base) & ~3U);
    core_->shorten_slice(entry->peripheral->next_event());
    const std::uint32_t shifted = word >> (8 * (address & 3U));
    return size == 4 ? shifted : shifted & ((1U << (8 * size)) - 1U);
}

void SystemBus::write(std::uint32_t address, std::uint32_t value, std::uint32_t size) {
    if (address >= kPrivateBus && address < kVendorPart) {
        control_.write(address, value, size);
        core_->shorten_slice(control_.next_event());
        return;
    }
    if (Entry* entry = usable(address, "write")) write_peripheral(*entry, address, value, size);
}

void SystemBus::write_peripheral(Entry& entry, std::uint32_t address, std::uint32_t value,
                                 std::uint32_t size) {
    Peripheral& peripheral = *entry.peripheral;
    const std::uint32_t offset = (address - entry.base) & ~3U;
    if (size != 4) {
        const std::uint32_t shift = 8 * (address & 3U);
        const std::uint32_t mask = ((1U << (8 * size)) - 1U) << shift;
        if (!peripheral.takes_narrow_writes(offset)) {
            log_.report(Rule::access_width,
                        fmt::format("{}: {}-byte write to offset 0x{:X}", peripheral.name(), size, offset));
        }
        value = (peripheral.read(offset) & ~mask) | (value << shift & mask);
    }
    peripheral.write(offset, value);
    core_->shorten_slice(peripheral.next_event());
}

void SystemBus::advance_all() {
    control_.advance();
    for (const Entry& entry : entries_) entry.peripheral->advance();
}

void SystemBus::advance_due(BoardTime now) {
    if (control_.next_event() <= now) control_.advance();
    for (const Entry& entry : entries_) {
        if (entry.peripheral->next_event() <= now) entry.peripheral->advance();
    }
}

void SystemBus::reset_all() {
    for (const Entry& entry : entries_) entry.peripheral->reset();
}

void SystemBus::reset_clocked_by(ClockEnable clock) {
    for (const Entry& entry : entries_) {
        if (entry.clock && entry.clock->offset == clock.offset && entry.clock->bit == clock.bit)
            entry.peripheral->reset();
    }
}

BoardTime SystemBus::next_event() const {
    BoardTime next = control_.next_event();
    for (const Entry& entry : entries_) next = std::min(next, entry.peripheral->next_event());
    return next;
}

}  // namespace octoskin::sim::stm32
