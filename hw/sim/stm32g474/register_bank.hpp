// The registers of a peripheral: storage with rules for bits that exist and bits that are writable.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hw/sim/stm32g474/violation.hpp"

namespace octoskin::sim::stm32 {

struct RegisterSpec {
    std::uint32_t offset;
    std::string_view name;
    std::uint32_t reset;
    std::uint32_t writable;  ///< the others must be written as they read, or as 0
};

class RegisterBank {
  public:
    /// `specs` in ascending order of offset, with static storage; `owner` too.
    RegisterBank(std::string_view owner, std::span<const RegisterSpec> specs, ViolationLog& log);

    void reset();
    /// Unknown offsets are reported and read as 0.
    [[nodiscard]] std::uint32_t read(std::uint32_t offset);
    /// Checks `value` against the register's rules and returns the value to store (read-only bits unchanged).
    /// Does not store it. Unknown offsets are reported and give 0.
    [[nodiscard]] std::uint32_t checked(std::uint32_t offset, std::uint32_t value);
    /// Stores the result of `checked`.
    void write(std::uint32_t offset, std::uint32_t value);

    /// Without checks, for the model itself. The offset must be one of the specs.
    [[nodiscard]] std::uint32_t get(std::uint32_t offset) const;
    void set(std::uint32_t offset, std::uint32_t value);
    void set_bits(std::uint32_t offset, std::uint32_t bits) { set(offset, get(offset) | bits); }
    void clear_bits(std::uint32_t offset, std::uint32_t bits) { set(offset, get(offset) & ~bits); }

  private:
    [[nodiscard]] const RegisterSpec* find(std::uint32_t offset) const;

    std::string_view owner_;
    std::span<const RegisterSpec> specs_;
    std::vector<std::uint32_t> values_;  ///< by offset / 4
    ViolationLog& log_;
};

}  // namespace octoskin::sim::stm32
