// LPUART1 as a transmitter (RM0440 38): the output of the virtual COM port.
#pragma once

#include <functional>
#include <optional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Lpuart final : public Peripheral {
  public:
    struct Hooks {
        std::function<std::uint32_t()> clock_hz;
        std::function<bool()> has_pin;           ///< the TX pin is assigned to it
        std::function<void(char byte)> on_byte;  ///< at the end of its stop bit
    };
    Lpuart(const Surroundings& surroundings, Hooks hooks);

    [[nodiscard]] std::string_view name() const override { return "LPUART1"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override { return shifted_at_; }
    [[nodiscard]] bool takes_narrow_writes(std::uint32_t offset) const override;

  private:
    [[nodiscard]] bool is_on() const { return (bank_.get(0x00) & 9U) == 9U; }  // UE, TE
    void check_baud_rate();
    void load();
    void update_line();

    Surroundings env_;
    Hooks hooks_;
    RegisterBank bank_;
    std::optional<char> waiting_;
    std::optional<char> shifting_;
    BoardTime shifted_at_ = kNever;
};

}  // namespace octoskin::sim::stm32
