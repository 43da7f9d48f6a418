// An I2C controller's registers and the targets behind it, one bus event at a time, by RM0440. Independent of
// the port's code.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/port/stm32g4/registers/i2c.hpp"
#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::test {

class I2cModel {
  public:
    using Registers = stm32g4::Peripheral<stm32g4::I2cMap>;

    I2cModel(AddressSpace& space, const Registers& registers);

    /// A target answers with these bytes, then with 0xFF.
    void add_target(std::uint8_t address, std::vector<std::uint8_t> answer) { targets_[address] = answer; }

    // --- faults
    std::optional<std::size_t> refuses_byte;  ///< the n-th byte written, from 0
    bool loses_arbitration = false;           ///< at the next START
    bool reports_false_bus_error = false;     ///< once, at the next START
    bool is_stretched = false;                ///< nothing moves any more

    /// Executes the next event on the bus. False if there is none.
    bool step();
    /// Whether one of the two interrupt lines is active.
    [[nodiscard]] bool is_interrupting();

    /// The log of the bus: "S52w", "R52r", a byte written as "3A", one read as "(3A)", "n" for each refusal,
    /// "P".
    [[nodiscard]] const std::string& trace() const { return trace_; }
    void clear_trace() { trace_.clear(); }

  private:
    using F = stm32g4::Field<stm32g4::I2cMap>;
    enum class Phase { idle, starting, loading, shifting, receiving, holding };

    [[nodiscard]] std::uint32_t& word(stm32g4::Register<stm32g4::I2cMap> where);
    void raise(F flag) { word("ISR") |= flag.mask(); }
    void lower(F flag) { word("ISR") &= ~flag.mask(); }
    [[nodiscard]] bool is(F flag) { return (word("ISR") & flag.mask()) != 0; }
    [[nodiscard]] std::uint32_t bytes() { return F("CR2.NBYTES").of(word("CR2")); }
    void start();
    void load();
    void shift();
    void receive();
    void refuse();
    void stop();
    void end_of_bytes();
    void log(const std::string& text) { trace_ += (trace_.empty() ? "" : " ") + text; }

    AddressSpace& space_;
    Registers registers_;
    std::map<std::uint8_t, std::vector<std::uint8_t>> targets_;
    Phase phase_ = Phase::idle;
    std::uint8_t address_ = 0;
    std::uint32_t moved_ = 0;  ///< bytes of this phase
    std::uint8_t shifted_ = 0;
    std::string trace_;
};

}  // namespace octoskin::test
