// Violations of the manuals by a program. The models report them and continue as the hardware does.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hw/sim/stm32g474/board_time.hpp"

namespace octoskin::sim::stm32 {

/// The rules, by name: tests and reports use the names.
enum class Rule : std::uint8_t {
    unclocked,         ///< a peripheral whose clock is off was accessed
    not_modelled,      ///< the accessed function has no model
    reserved_bits,     ///< a bit that is reserved or read-only was changed
    access_width,      ///< a register was written with a width that it does not accept
    read_only,         ///< a read-only register was written
    wrong_state,       ///< a register was written in a state that forbids it
    clock_tree,        ///< a clock outside its limits, or switched in a forbidden sequence
    flash_latency,     ///< too few wait states, or no boost mode, for HCLK
    debug_access,      ///< debugger access was disabled
    fpu_disabled,      ///< floating point while CPACR does not enable it
    pin_function,      ///< a peripheral was started without its pins
    bus_timing,        ///< I2C or CAN timing outside the limits of the bus
    start_while_busy,  ///< I2C: START while the bus is busy
    data_lost,         ///< a register that holds data was overwritten, or read while empty
    exception_model,   ///< EXC_RETURN, vector table or priority misuse; lockup
    memory,            ///< an access that faults
};
[[nodiscard]] const char* name_of(Rule rule) noexcept;

struct Violation {
    Rule rule = Rule::not_modelled;
    std::uint32_t pc = 0;  ///< start of the basic block that did it
    BoardTime time{};      ///< of the first occurrence
    std::uint64_t count = 1;
    std::string what;
};

/// Each (rule, pc, what) once, with a count; at most 1000 different ones are kept, all are counted.
class ViolationLog {
  public:
    using Where = std::function<std::uint32_t()>;  ///< the program counter
    /// `now` must outlive the log.
    explicit ViolationLog(const BoardTime& now) : now_(now) {}
    void set_where(Where where) { where_ = std::move(where); }

    void report(Rule rule, std::string what);
    [[nodiscard]] const std::vector<Violation>& all() const noexcept { return violations_; }
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    [[nodiscard]] bool has(Rule rule) const;

  private:
    const BoardTime& now_;
    Where where_;
    std::vector<Violation> violations_;
    std::uint64_t count_ = 0;
};

}  // namespace octoskin::sim::stm32
