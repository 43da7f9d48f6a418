// The address, clock and allowed accesses of each peripheral.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hw/sim/stm32g474/cpu/cortex_m4.hpp"
#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/peripherals/rcc.hpp"

namespace octoskin::sim::stm32 {

class SystemBus final : public MemoryMappedDevices {
  public:
    SystemBus(ViolationLog& log, const Rcc& rcc, SystemControl& control)
        : log_(log), rcc_(rcc), control_(control) {}

    /// `size` up to 64 KiB; `clock`: none if it is always clocked.
    void add(Peripheral& peripheral, std::uint32_t base, std::uint32_t size,
             std::optional<ClockEnable> clock);
    /// The core whose slices events shorten.
    void attach(CortexM4& core) { core_ = &core; }

    std::uint32_t read(std::uint32_t address, std::uint32_t size) override;
    void write(std::uint32_t address, std::uint32_t value, std::uint32_t size) override;

    void advance_all();
    void advance_due(BoardTime now);
    void reset_all();
    void reset_clocked_by(ClockEnable clock);
    [[nodiscard]] BoardTime next_event() const;

  private:
    struct Entry {
        Peripheral* peripheral;
        std::uint32_t base;
        std::uint32_t size;
        std::optional<ClockEnable> clock;
    };
    [[nodiscard]] Entry* find(std::uint32_t address);
    [[nodiscard]] Entry* usable(std::uint32_t address, const char* what);
    void write_peripheral(Entry& entry, std::uint32_t address, std::uint32_t value, std::uint32_t size);

    ViolationLog& log_;
    const Rcc& rcc_;
    SystemControl& control_;
    CortexM4* core_ = nullptr;
    std::vector<Entry> entries_;
};

}  // namespace octoskin::sim::stm32
