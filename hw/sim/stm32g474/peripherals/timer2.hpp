// TIM2 (RM0440 29): a 32-bit up-counter with compare events. Capture, encoder and trigger modes are not
// modelled.
#pragma once

#include <array>
#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Timer2 final : public Peripheral {
  public:
    Timer2(const Surroundings& surroundings, std::function<std::uint32_t()> clock_hz);

    [[nodiscard]] std::string_view name() const override { return "TIM2"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override;

    /// Time of the last write of 0 to the counter: tests use it to relate the board's clock to true time.
    [[nodiscard]] BoardTime counter_zero() const noexcept { return zeroed_at_; }

  private:
    [[nodiscard]] bool is_counting() const { return (bank_.get(0x00) & 1U) != 0; }
    [[nodiscard]] std::uint64_t modulus() const { return std::uint64_t{bank_.get(0x2C)} + 1; }
    [[nodiscard]] std::uint64_t counts_to(std::uint32_t value) const;
    [[nodiscard]] std::int64_t span_of_counts(std::uint64_t counts) const;
    void update_event();
    void update_line();

    Surroundings env_;
    std::function<std::uint32_t()> clock_hz_;
    RegisterBank bank_;
    std::uint32_t counter_ = 0;
    std::uint64_t divider_ = 1;  ///< PSC + 1, as taken over by the last update event
    std::uint64_t part_ = 0;     ///< timer clocks since the last count
    BoardTime counted_to_{};
    BoardTime zeroed_at_{};
};

}  // namespace octoskin::sim::stm32
