// The independent watchdog (RM0440 42), on its own slow oscillator.
#pragma once

#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Iwdg final : public Peripheral {
  public:
    /// `lsi_hz`: nominally 32,000, 29,500 to 34,000 by the datasheet. `bite` resets the chip.
    Iwdg(const Surroundings& surroundings, std::uint32_t lsi_hz, std::function<void()> bite);

    [[nodiscard]] std::string_view name() const override { return "IWDG"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override;
    [[nodiscard]] bool is_running() const noexcept { return is_running_; }

  private:
    void write_key(std::uint32_t value);
    void reload();
    [[nodiscard]] std::int64_t period() const;

    Surroundings env_;
    std::uint32_t lsi_hz_;
    std::function<void()> bite_;
    RegisterBank bank_;
    bool is_running_ = false;
    bool is_unlocked_ = false;
    std::uint32_t prescaler_ = 0;  ///< in force; a written value applies later
    std::uint32_t reload_ = 0xFFF;
    BoardTime prescaler_arrives_ = kNever;
    BoardTime reload_arrives_ = kNever;
    BoardTime window_arrives_ = kNever;
    BoardTime bites_at_ = kNever;
};

}  // namespace octoskin::sim::stm32
