// A peripheral with registers only: writes have no other effect.
#pragma once

#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class PlainRegisters final : public Peripheral {
  public:
    /// `name` and `specs` with static storage.
    PlainRegisters(const Surroundings& surroundings, std::string_view name,
                   std::span<const RegisterSpec> specs)
        : name_(name), bank_(name, specs, surroundings.log) {}

    [[nodiscard]] std::string_view name() const override { return name_; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override { return bank_.read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) override { bank_.write(offset, value); }
    void reset() override { bank_.reset(); }

  private:
    std::string_view name_;
    RegisterBank bank_;
};

}  // namespace octoskin::sim::stm32
