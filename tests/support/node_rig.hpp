// One node in a simulation controlled by a test: the real node core and driver, simulated sensors, I2C buses
// and a CAN bus. It records all frames and the true data of every range.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/node.hpp"
#include "hw/sim/can/simulated_can_bus.hpp"
#include "hw/sim/clock.hpp"
#include "hw/sim/data_ready/simulated_data_ready_lines.hpp"
#include "hw/sim/i2c/simulated_i2c_bus.hpp"
#include "hw/sim/vl53l1x/sensor_model.hpp"

namespace octoskin::test {

/// `count` sensors on `buses` buses in turn, sensor i on XSHUT line i with address 0x30 + i.
[[nodiscard]] NodeConfig fleet_config(std::uint8_t count, std::uint8_t buses);

struct SensorSetup {
    sim::SensorPart part;
    sim::SensorFaults faults;
    bool is_fitted = true;
    /// Its constant view; without it each range has another distance.
    std::optional<sim::RangingReturn> target{};
};

/// The true data of a range. Its distance in millimetres distinguishes it from its neighbours in time and
/// from those of all other sensors.
struct TrueRange {
    std::uint16_t range_mm = 0;
    sim::SimTime window_middle{};
    Roi roi;
};

struct SaidMessage {
    wire::Message message;
    sim::SimTime end{};
};

/// A reading on the bus, from a RANGE or RANGE_FD frame.
struct SaidReading {
    wire::RangeReading reading;
    sim::SimTime end{};
};

struct XshutEvent {
    std::uint8_t line = 0;
    bool is_high = false;
    sim::SimTime time{};
};

/// A reset of the node's controller: the cause in the reset register, and the state of its pins meanwhile.
struct Reset {
    wire::ResetCause cause = wire::ResetCause::watchdog;
    bool is_xshut_kept = false;  ///< the lines keep their levels, as with a latch
    Microseconds takes{1'000};
};

class NodeRig final : private node::XshutLines,
                      private node::Indicator,
                      private node::CanTransmitter,
                      private node::Watchdog {
  public:
    /// `setups`: one for each sensor of the configuration. `board_type`: the type of the board, independent
    /// of the configuration.
    NodeRig(const NodeConfig& config, const std::vector<SensorSetup>& setups, sim::NodeClock clock = {},
            const node::Policy& policy = {}, std::uint8_t board_type = 0);

    /// Runs from event to event.
    void run_for(Microseconds duration);
    /// Runs in steps of `step`, as a main loop of that length would.
    void run_in_steps_for(Microseconds duration, Microseconds step);
    /// A frame from outside, as if another controller sent it.
    void send_from_host(const wire::Message& message, wire::NodeId id);
    void send_from_host(const wire::CanFrame& frame);
    /// While blocked, the node's controller accepts no frame, as if every mailbox were full.
    void block_transmission(bool is_blocked) { is_transmission_blocked_ = is_blocked; }
    /// No acknowledge on the bus: the node's controller accepts frames and withdraws each after 20 ms.
    void leave_unacknowledged(bool is_alone);
    /// Resets the controller at once. Its memory is lost except `kept()`.
    void reset(const Reset& reset);
    /// The node's loop hangs for this time.
    void hang_for(Microseconds duration);
    [[nodiscard]] node::KeptMemory& kept() { return kept_; }
    /// When the watchdog was fed.
    [[nodiscard]] const std::vector<sim::SimTime>& feeds() const noexcept { return feeds_; }

    /// Adds a sensor with an unconnected XSHUT: it acknowledges at 0x29 from the start.
    void attach_stray_sensor(std::size_t bus, const sim::SensorFaults& faults = {});

    [[nodiscard]] const NodeConfig& config() const noexcept { return config_; }
    [[nodiscard]] sim::SimTime now() const noexcept { return present_.time; }
    [[nodiscard]] NodeTime node_now() const { return clock_.to_node(present_.time); }
    [[nodiscard]] const sim::NodeClock& clock() const noexcept { return clock_; }
    [[nodiscard]] node::Node& node() { return *node_; }
    [[nodiscard]] sim::SensorModel& sensor(std::size_t index) { return sensors_.at(index)->model; }
    [[nodiscard]] sim::SimulatedI2cBus& bus(std::size_t index) { return buses_.at(index); }
    [[nodiscard]] sim::SimulatedCanBus& can() { return can_; }

    /// Connected to the sensors of all buses; the node queries those of its configuration.
    [[nodiscard]] sim::SimulatedDataReadyLines& data_ready() { return data_ready_; }

    [[nodiscard]] const std::vector<TrueRange>& truth(std::size_t sensor) const {
        return sensors_.at(sensor)->truth;
    }
    [[nodiscard]] const std::deque<wire::CanFrame>& frames() const noexcept { return frames_; }
    /// All messages on the bus, decoded, also the host's.
    [[nodiscard]] const std::deque<SaidMessage>& said() const noexcept { return said_; }
    [[nodiscard]] std::vector<SaidReading> readings_of(std::uint8_t sensor) const;
    [[nodiscard]] std::optional<wire::SensorHealth> last_health(std::uint8_t sensor) const;
    [[nodiscard]] const std::vector<XshutEvent>& xshut_events() const noexcept { return xshut_events_; }
    [[nodiscard]] std::vector<bool> lit() const { return lit_; }
    [[nodiscard]] std::uint32_t undecodable_count() const noexcept { return undecodable_count_; }
    [[nodiscard]] std::uint64_t poll_count() const noexcept { return poll_count_; }

    template <class T>
    [[nodiscard]] std::vector<T> said_of() const {
        std::vector<T> all;
        for (const SaidMessage& item : said_) {
            if (const auto* message = std::get_if<T>(&item.message)) all.push_back(*message);
        }
        return all;
    }
    template <class T>
    [[nodiscard]] std::vector<sim::SimTime> times_of() const {
        std::vector<sim::SimTime> all;
        for (const SaidMessage& item : said_) {
            if (std::holds_alternative<T>(item.message)) all.push_back(item.end);
        }
        return all;
    }

  private:
    /// Those of one sensor, one range after the other, then from the first on again: after 26 s at 30 Hz if
    /// there are four, after 4 s if there are 34. No two sensors have one in common, so that a reading with
    /// another sensor's name is detected.
    struct Distances {
        std::uint32_t first_mm = 0;
        std::uint32_t step_mm = 0;
        std::uint32_t count = 0;
    };
    [[nodiscard]] Distances distances_of(std::size_t sensor) const;

    struct FittedSensor {
        FittedSensor(const SensorSetup& setup, const Distances& distances);
        std::vector<TrueRange> truth;
        sim::SensorModel model;
    };

    void set(std::uint8_t line, bool is_high) override;
    void set(bool is_on) override { lit_.push_back(is_on); }
    bool send(const wire::CanFrame& frame) override;
    [[nodiscard]] node::CanState state() const override { return controller_->state(); }
    void discard() override;
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() override;
    void restart() override { controller_->restart(); }
    void feed() override { feeds_.push_back(present_.time); }
    void start_node(wire::ResetCause cause);
    void turn();
    [[nodiscard]] sim::SimTime next_event() const;
    void record(const wire::CanFrame& frame, sim::SimTime end);

    NodeConfig config_;
    node::Policy policy_;
    std::uint8_t board_type_ = 0;
    node::KeptMemory kept_{};
    sim::NodeClock clock_;
    sim::Present present_;
    std::vector<std::unique_ptr<FittedSensor>> sensors_;
    std::deque<sim::SimulatedI2cBus> buses_;
    std::vector<i2c::Bus*> bus_pointers_;
    sim::SimulatedDataReadyLines data_ready_;
    sim::SimulatedCanBus can_;
    node::CanTransmitter* controller_ = nullptr;
    node::CanTransmitter* host_ = nullptr;
    std::unique_ptr<node::Node> node_;
    // These grow with the time simulated. A deque never needs the memory twice, which counts on the target.
    std::deque<wire::CanFrame> frames_;
    std::deque<SaidMessage> said_;
    std::vector<XshutEvent> xshut_events_;
    std::vector<bool> lit_;
    std::vector<sim::SimTime> feeds_;
    bool is_transmission_blocked_ = false;
    struct Unacknowledged {
        wire::CanFrame frame;
        sim::SimTime given{};
    };
    bool is_alone_ = false;
    std::deque<Unacknowledged> unacknowledged_;
    std::unique_ptr<FittedSensor> stray_;
    std::uint32_t undecodable_count_ = 0;
    std::uint64_t poll_count_ = 0;
};

}  // namespace octoskin::test
