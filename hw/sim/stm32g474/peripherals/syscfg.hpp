// System configuration (RM0440 10): here only the port of each external interrupt line.
#pragma once

#include <functional>

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Syscfg final : public Peripheral {
  public:
    Syscfg(const Surroundings& surroundings, std::function<void()> after_change);

    [[nodiscard]] std::string_view name() const override { return "SYSCFG"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override { return bank_.read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override { bank_.reset(); }

    /// EXTICR: the port (0 is A) whose pin of the line's own number (0..15) is the line's source.
    [[nodiscard]] std::uint32_t port_of(std::uint32_t line) const;

  private:
    Surroundings env_;
    std::function<void()> after_change_;
    RegisterBank bank_;
};

}  // namespace octoskin::sim::stm32
