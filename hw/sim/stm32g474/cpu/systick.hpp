// SysTick: the core's 24-bit down-counter (ARMv7-M ARM B3.3).
#pragma once

#include <cstdint>
#include <functional>

#include "hw/sim/stm32g474/board_time.hpp"
#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

class SysTick {
  public:
    using Frequency = std::function<std::uint32_t()>;
    /// `hclk_hz` returns HCLK; call `advance` before HCLK changes. `on_zero`: the exception is due.
    SysTick(const BoardTime& now, ViolationLog& log, Frequency hclk_hz, std::function<void()> on_zero)
        : now_(now), log_(log), hclk_hz_(std::move(hclk_hz)), on_zero_(std::move(on_zero)) {}

    void reset();
    void advance();
    [[nodiscard]] BoardTime next_event() const;
    /// Offset from 0xE000E010.
    [[nodiscard]] std::uint32_t read(std::uint32_t offset);
    void write(std::uint32_t offset, std::uint32_t value);

  private:
    [[nodiscard]] bool is_enabled() const { return (control_ & 1U) != 0; }
    [[nodiscard]] std::uint32_t hz() const { return (control_ & 4U) != 0 ? hclk_hz_() : hclk_hz_() / 8; }

    const BoardTime& now_;
    ViolationLog& log_;
    Frequency hclk_hz_;
    std::function<void()> on_zero_;
    std::uint32_t control_ = 0;
    std::uint32_t reload_ = 0;
    std::uint32_t value_ = 0;
    bool has_counted_to_zero_ = false;
    BoardTime counted_to_{};  ///< time of `value_`
};

}  // namespace octoskin::sim::stm32
