// All that the node core wants from a board, and what a board tells about itself.
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
    passive,  ///< over 127 errors in one of its counters: nobody acknowledges, or the lines are disturbed
    bus_off,  ///< over 255 transmit errors: it has left the bus, and comes back only by `restart`
};

/// The transmit side of the CAN controller. Who decides when to leave bus-off is the core (`BusOffRecovery`);
/// the port only tells and obeys.
class CanTransmitter {
  public:
    /// Takes a frame if there is room; false means try again later. Never waits.
    [[nodiscard]] virtual bool send(const wire::CanFrame& frame) = 0;
    /// As it is now: asked for once a poll, so no more than a register's read.
    [[nodiscard]] virtual CanState state() const = 0;
    /// Gives up every frame that was taken and is not sent yet, so that nothing stale goes out once the bus
    /// is back. One that is on the wire at this moment may still end. What was given up `take_given_up`
    /// tells.
    virtual void discard() = 0;
    /// A frame that was taken and is now certain never to be sent: discarded, or taken back by the port
    /// because nobody acknowledged it in time. Each once; empty if there is none.
    [[nodiscard]] virtual std::optional<wire::CanFrame> take_given_up() = 0;
    /// Lets a controller that is bus-off begin its way back: 128 times 11 recessive bits, after which
    /// `state` says `active`. Returns at once. For a controller that is not bus-off, or that is on its way
    /// already, it does nothing.
    virtual void restart() = 0;

  protected:
    ~CanTransmitter() = default;
};

/// The watchdog, which the port has set to bite 200 ms at most after the last feed. Nobody but the core
/// feeds it, and only a core that is alive does: its loop turns, its clock moves, and no I2C transfer is
/// overdue. What the port must guard by itself (an interrupt that never ends starves the loop, and so is
/// covered) it does by leaving the loop.
class Watchdog {
  public:
    virtual void feed() = 0;

  protected:
    ~Watchdog() = default;
};

/// The data-ready lines of a board, one per bus: GPIO1 of the bus's sensors wired together, low while one of
/// them has data. A fall is a hint to look now and nothing more: no time is taken from it, and what it hints
/// at is asked of the sensors. So a port may lose falls, and report some that were none.
class DataReadyLines {
  public:
    /// Whether the line of `bus` has fallen since this was last asked. Never waits. The core asks no more
    /// often than `Policy::hint_interval`, and no more at all once it holds the line for broken: a port that
    /// listens to a line only from one question to its next fall is safe from one that chatters. Wherever the
    /// port waits for events, a fall is to end the wait.
    [[nodiscard]] virtual bool take_fall(std::uint8_t bus) = 0;

  protected:
    ~DataReadyLines() = default;
};

/// A light by which a person finds the board that the `identify` command means.
class Indicator {
  public:
    virtual void set(bool is_on) = 0;

  protected:
    ~Indicator() = default;
};

/// What a board tells about itself.
struct Identity {
    std::array<std::uint8_t, 12> uid{};
    std::uint32_t build_id = 0;
    std::uint8_t board_type = 0;  ///< hw/boards/: a configuration for another type is not used
    /// What the hardware says. The core itself tells from `Ports::kept` whether a recorded fault was behind
    /// a software reset.
    wire::ResetCause reset_cause = wire::ResetCause::power_on;
    /// What `begin_start_up` said, from a port that called it; else the node begins its run itself.
    std::optional<RunStart> run = std::nullopt;
};

/// Everything referred to must outlive the node.
struct Ports {
    std::span<i2c::Bus* const> buses;  ///< one per I2C bus of the board, index as in the configuration
    XshutLines& xshut;
    CanTransmitter& can;
    DataReadyLines* data_ready = nullptr;  ///< asked about the buses that the configuration names
    Indicator* indicator = nullptr;        ///< boards without a light have none
    Watchdog* watchdog = nullptr;          ///< a process on Linux has none of its own
    /// Memory that outlives a reset and that no start-up code clears. Without it every start is the first:
    /// no fault is told after a reset, and there is no safe mode.
    KeptMemory* kept = nullptr;
};

}  // namespace octoskin::node
