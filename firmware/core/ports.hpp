// The interfaces that the node core needs from a board, and the board's identity.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/run_record.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::node {

/// The XSHUT outputs of a board. All of them are low until the node raises one.
class XshutLines {
  public:
    virtual void set(std::uint8_t line, bool is_high) = 0;

  protected:
    ~XshutLines() = default;
};

/// The error states of a CAN controller: ISO 11898-1, fault confinement.
enum class CanState : std::uint8_t {
    active,   ///< takes part without restriction
    passive,  ///< over 127 errors in one of its counters: no acknowledge, or disturbed lines
    bus_off,  ///< over 255 transmit errors: it has left the bus, and returns only by `restart`
};

/// The transmit side of the CAN controller. The core decides when to leave bus-off (`BusOffRecovery`); the
/// port reports the state and obeys.
class CanTransmitter {
  public:
    /// Takes a frame if there is room; false means try again later. Never waits.
    [[nodiscard]] virtual bool send(const wire::CanFrame& frame) = 0;
    /// The present state. Called once a poll, so it must cost no more than a register read.
    [[nodiscard]] virtual CanState state() const = 0;
    /// Gives up every frame that was taken and not sent yet, so that nothing stale is sent when the bus is
    /// back. A frame that is on the wire at this moment may still end. `take_given_up` returns the frames
    /// that were given up.
    virtual void discard() = 0;
    /// A frame that was taken and will certainly never be sent: discarded, or taken back by the port because
    /// it was not acknowledged in time. Each frame once; empty if there is none.
    [[nodiscard]] virtual std::optional<wire::CanFrame> take_given_up() = 0;
    /// Starts the recovery of a bus-off controller: 128 times 11 recessive bits, after which `state` is
    /// `active`. Returns at once. No effect on a controller that is not bus-off or is already recovering.
    virtual void restart() = 0;

  protected:
    ~CanTransmitter() = default;
};

/// The watchdog; the port sets it to reset the node at most 200 ms after the last feed. Only the core feeds
/// it, and only while its loop runs, its clock moves and no I2C transfer is overdue. An interrupt that never
/// ends starves the loop, and so is covered. The port guards anything else by leaving the loop.
class Watchdog {
  public:
    virtual void feed() = 0;

  protected:
    ~Watchdog() = default;
};

/// The data-ready lines of a board, one per bus: GPIO1 of the bus's sensors wired together, low while one of
/// them has data. A fall is only a hint to poll now: no time is taken from it, and the sensors are asked. So
/// a port may lose falls, and may report false ones.
class DataReadyLines {
  public:
    /// Whether the line of `bus` has fallen since the last call. Never waits. The core calls it no more often
    /// than every `Policy::hint_interval`, and not at all once it treats the line as broken. A port that
    /// enables a line's event only from a call to the next fall is safe from a chattering line. Where the
    /// port waits for events, a fall must end the wait.
    [[nodiscard]] virtual bool take_fall(std::uint8_t bus) = 0;

  protected:
    ~DataReadyLines() = default;
};

/// A light that shows a person which board the `identify` command means.
class Indicator {
  public:
    virtual void set(bool is_on) = 0;

  protected:
    ~Indicator() = default;
};

/// What a board reports about itself.
struct Identity {
    std::array<std::uint8_t, 12> uid{};
    std::uint32_t build_id = 0;
    std::uint8_t board_type = 0;  ///< hw/boards/: a configuration for another type is not used
    /// As reported by the hardware. The core itself detects from `Ports::kept` whether a recorded fault
    /// caused a software reset.
    wire::ResetCause reset_cause = wire::ResetCause::power_on;
    /// The result of `begin_start_up`, from a port that called it; else the node begins its run itself.
    std::optional<RunStart> run = std::nullopt;
};

/// Everything referred to must outlive the node.
struct Ports {
    std::span<i2c::Bus* const> buses;  ///< one per I2C bus of the board, index as in the configuration
    XshutLines& xshut;
    CanTransmitter& can;
    DataReadyLines* data_ready = nullptr;  ///< read for the buses that the configuration names
    Indicator* indicator = nullptr;        ///< null on a board without a light
    Watchdog* watchdog = nullptr;          ///< null: a process on Linux has none of its own
    /// Memory that survives a reset and is not cleared by start-up code. Without it every start is the first:
    /// no fault is reported after a reset, and there is no safe mode.
    KeptMemory* kept = nullptr;
};

}  // namespace octoskin::node
