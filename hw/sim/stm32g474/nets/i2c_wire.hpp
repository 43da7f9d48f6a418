// Two wires with pull-ups and devices, byte by byte: the bus for the I2C controller and GPIO. The faults are
// those of hw/sim/i2c/simulated_i2c_bus.hpp.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "hw/sim/i2c/i2c_target.hpp"
#include "hw/sim/i2c/simulated_i2c_bus.hpp"

namespace octoskin::sim::stm32 {

class I2cWire {
  public:
    /// The target must outlive the wire.
    void attach(I2cTarget& target) { targets_.push_back(&target); }
    void inject(const I2cFault& fault);
    void clear_faults() { faults_.clear(); }
    /// Releases SDA from a fault that holds it.
    void let_go_of_sda() { stuck_clocks_ = 0; }
    /// Number of times that a fault had an effect.
    [[nodiscard]] std::uint64_t fault_hits() const noexcept { return fault_hits_; }

    // --- the controller's side; a transfer lasts from a START on an idle bus to its STOP
    enum class Answer : std::uint8_t { acknowledged, refused, arbitration_lost, stretched };
    /// Address and acknowledge have passed. `stretched`: the clock stays low until the controller releases
    /// the bus.
    Answer start(std::uint8_t address, bool is_read, SimTime time);
    Answer write(std::uint8_t byte, SimTime time);
    /// The byte that the targets drive from now on.
    std::uint8_t read(SimTime time);
    void stop(SimTime time);
    /// The controller releases the bus in the middle of a byte, of which `bits_done` clocks (0..9) have
    /// passed.
    void abandon(std::uint32_t bits_done);
    void count_bits(std::uint32_t bits) { bit_count_ += bits; }

    /// `listener` is called at each end of a transfer: a device may have released its pins.
    void on_stop(std::function<void()> listener) { on_stop_ = std::move(listener); }

    // --- GPIO's side: open-drain outputs
    void drive(bool scl_low, bool sda_low, SimTime time);

    [[nodiscard]] bool is_scl_low() const { return is_scl_driven_low_ || is_stretched_; }
    [[nodiscard]] bool is_sda_low(SimTime time);
    [[nodiscard]] bool is_in_transfer() const noexcept { return is_in_transfer_; }
    /// End of the first address on this bus.
    [[nodiscard]] std::optional<SimTime> first_address() const noexcept { return first_address_; }
    [[nodiscard]] std::uint64_t transfer_count() const noexcept { return transfer_count_; }
    [[nodiscard]] std::uint64_t bit_count() const noexcept { return bit_count_; }
    [[nodiscard]] std::uint64_t refused_count() const noexcept { return refused_count_; }

  private:
    [[nodiscard]] const I2cFault* fault(I2cFaultKind kind) const;
    void begin_transfer(std::uint8_t address);
    void end_transfer();
    void note_stuck_sda();

    std::function<void()> on_stop_;
    std::vector<I2cTarget*> targets_;
    std::vector<I2cTarget*> selected_;
    std::vector<I2cFault> faults_;
    bool is_in_transfer_ = false;
    std::uint8_t address_ = 0;
    std::uint32_t written_ = 0;
    std::uint32_t read_ = 0;
    std::optional<std::uint8_t> byte_being_read_;
    bool is_stretched_ = false;
    std::uint32_t stuck_clocks_ = 0;  ///< still needed before SDA is released
    bool is_scl_driven_low_ = false;
    bool is_sda_driven_low_ = false;
    std::optional<SimTime> first_address_;
    std::uint64_t transfer_count_ = 0;
    std::uint64_t bit_count_ = 0;
    std::uint64_t refused_count_ = 0;
    std::uint64_t fault_hits_ = 0;
};

}  // namespace octoskin::sim::stm32
