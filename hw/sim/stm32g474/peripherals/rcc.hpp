// Reset and clock control (RM0440 7): oscillators, PLL, the clock tree with its limits, clock enables, reset
// causes.
#pragma once

#include <cstdint>
#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

/// The 24 MHz crystal of the board.
struct Crystal {
    bool is_present = true;
    BoardTime fails_at = kNever;
    BoardTime returns_at = kNever;  ///< after it failed, or if it was missing from the start
    BoardTime starts_in = BoardTime{2'000 * kPsPerUs};  ///< DS12288: 2 ms typical
};

/// Bits of RCC_CSR.
enum class ResetFlag : std::uint8_t { pin = 26, brown_out = 27, software = 28, watchdog = 29 };

/// A clock enable: offset of the register and bit.
struct ClockEnable {
    std::uint32_t offset;
    std::uint32_t bit;
};

class Rcc final : public Peripheral {
  public:
    struct Hooks {
        std::function<void()> before_change;  ///< advances models that count a clock to the present time
        std::function<void()> after_change;
        std::function<void(ClockEnable enable)> reset_peripheral;  ///< with the offset of the enable register
    };
    Rcc(const Surroundings& surroundings, const Crystal& crystal, Hooks hooks);

    [[nodiscard]] std::string_view name() const override { return "RCC"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override;

    void note_reset(ResetFlag flag);
    /// For tests: the core's clock can never be switched to the PLL.
    void refuse_pll() { refuses_pll_ = true; }
    [[nodiscard]] bool is_enabled(ClockEnable enable) const;
    /// The core's clock stopped: only the watchdog can reset the chip.
    [[nodiscard]] bool is_stopped() const noexcept { return is_stopped_; }

    [[nodiscard]] std::uint32_t hclk_hz() const;
    [[nodiscard]] std::uint32_t pclk1_hz() const;
    [[nodiscard]] std::uint32_t timer1_hz() const;                   ///< of the timers on APB1
    [[nodiscard]] std::uint32_t i2c_hz(std::uint32_t number) const;  ///< 1..4
    [[nodiscard]] std::uint32_t fdcan_hz() const;
    [[nodiscard]] std::uint32_t lpuart_hz() const;
    /// Whether FDCAN's clock comes from the crystal: the internal oscillator is not good enough for CAN.
    [[nodiscard]] bool is_fdcan_from_crystal() const;

  private:
    [[nodiscard]] bool is_set(std::uint32_t offset, std::uint32_t bit) const {
        return (bank_.get(offset) >> bit & 1U) != 0;
    }
    [[nodiscard]] std::uint32_t field(std::uint32_t offset, std::uint32_t position,
                                      std::uint32_t width) const {
        return bank_.get(offset) >> position & ((1U << width) - 1U);
    }
    [[nodiscard]] std::uint32_t pll_input_hz() const;
    [[nodiscard]] std::uint32_t vco_hz() const;
    [[nodiscard]] std::uint32_t pll_output_hz(std::uint32_t divider_position) const;
    [[nodiscard]] std::uint32_t sysclk_hz() const;
    [[nodiscard]] std::uint32_t ahb_divider() const;
    void write_control(std::uint32_t value);
    void write_configuration(std::uint32_t value);
    void write_pll(std::uint32_t value);
    void write_resets(std::uint32_t offset, std::uint32_t value);
    void check_pll();
    void check_step(std::uint32_t hclk_before, std::uint32_t divider_before, bool has_switched);
    void lose_crystal();

    Surroundings env_;
    Crystal crystal_;
    Hooks hooks_;
    RegisterBank bank_;
    BoardTime crystal_ready_at_ = kNever;
    BoardTime pll_ready_at_ = kNever;
    BoardTime lsi_ready_at_ = kNever;
    BoardTime switched_to_pll_at_{};
    bool is_stopped_ = false;
    bool refuses_pll_ = false;
};

}  // namespace octoskin::sim::stm32
