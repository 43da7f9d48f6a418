// An I2C controller (RM0440 41), as a master with 7-bit addresses, on a wire. Target mode, DMA, SMBus and
// 10-bit addresses are not modelled.
#pragma once

#include <array>
#include <functional>

#include "hw/sim/stm32g474/nets/i2c_wire.hpp"
#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

/// Delays that the wire adds to SCLL and SCLH: filter delay, rise and fall time.
enum class BusEdges : std::uint8_t { typical, slowest };

class I2c final : public Peripheral {
  public:
    struct Hooks {
        std::function<std::uint32_t()> kernel_hz;
        std::function<bool()> has_pins;  ///< both are open-drain and assigned to it
        std::function<SimTime()> true_time;
    };
    /// `number`: 1..4.
    I2c(const Surroundings& surroundings, std::uint32_t number, I2cWire& wire, BusEdges edges, Hooks hooks);

    [[nodiscard]] std::string_view name() const override { return {name_.data(), name_.size()}; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override { return event_at_; }
    [[nodiscard]] bool takes_narrow_writes(std::uint32_t offset) const override;

    /// Time between START and STOP, picoseconds since power-up.
    [[nodiscard]] std::int64_t busy_ps() const noexcept { return busy_ps_; }

  private:
    enum class Phase : std::uint8_t {
        idle,
        waiting_for_bus,
        address,
        wants_byte,  ///< SCL is stretched: TXDR is empty
        sending,
        complete,  ///< SCL is stretched: TC or TCR
        receiving,
        wants_room,  ///< SCL is stretched: RXDR is full
        stopping,
        stretched,  ///< by a device
    };

    [[nodiscard]] bool is_enabled() const { return (bank_.get(0x00) & 1U) != 0; }
    [[nodiscard]] bool has_flag(std::uint32_t flag) const { return (bank_.get(0x18) & flag) != 0; }
    [[nodiscard]] std::uint32_t control(std::uint32_t position, std::uint32_t width) const {
        return bank_.get(0x04) >> position & ((1U << width) - 1U);
    }
    [[nodiscard]] std::int64_t clock_period() const;
    [[nodiscard]] bool is_bus_busy();

    void write_control_1(std::uint32_t value);
    void write_control_2(std::uint32_t value);
    void write_status(std::uint32_t value);
    void write_data(std::uint32_t value);
    [[nodiscard]] std::uint32_t read_data();
    void disable();
    void check_timing();
    void check_start();

    void begin_start();
    void end_address();
    void load_shift_register();
    void end_sending();
    void begin_receiving();
    void end_receiving();
    void store_received();
    void after_byte();
    void begin_stop();
    void end_stop();
    void wait_bits(Phase phase, std::uint32_t bits);
    void refuse();
    void update();

    std::array<char, 4> name_;
    Surroundings env_;
    std::uint32_t number_;
    I2cWire& wire_;
    BusEdges edges_;
    Hooks hooks_;
    RegisterBank bank_;

    Phase phase_ = Phase::idle;
    BoardTime event_at_ = kNever;
    BoardTime phase_begun_{};
    BoardTime transfer_begun_{};
    std::uint32_t bytes_left_ = 0;  ///< of this NBYTES, not yet acknowledged or received
    std::uint32_t to_load_ = 0;     ///< of this NBYTES, not yet in the shift register
    bool is_reading_ = false;
    std::uint8_t shift_register_ = 0;
    bool is_checked_ = false;  ///< timing and pins, once per PE
    bool was_read_disabled_ = true;
    std::int64_t busy_ps_ = 0;
};

}  // namespace octoskin::sim::stm32
