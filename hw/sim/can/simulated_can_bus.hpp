// A CAN bus on simulated time: arbitration by identifier, frame durations by their bits, a tap that receives
// every frame, and faults as data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "common/wire/bus_load.hpp"
#include "common/wire/can_frame.hpp"
#include "firmware/core/ports.hpp"
#include "hw/sim/can/can_fault.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// A controller that is bus-off receives and sends nothing. Only transmit errors are modelled: 8 for each
/// frame that is disturbed, one less for each that is sent; over 127 the controller is passive, over 255
/// bus-off (ISO 11898-1, fault confinement).
///
/// Called at the end of a frame, which is the instant of every receive time stamp, also of SYNC.
using FrameHandler = std::function<void(const wire::CanFrame& frame, SimTime end_of_frame)>;

/// How long a frame and the three bits after it occupy the bus: worst-case stuffing, rounded up to whole
/// microseconds.
[[nodiscard]] std::int64_t frame_duration_us(const wire::CanFrame& frame, const wire::BitRates& rates);

/// A controller that selects its next frame, counts its errors and repeats its frames by itself: the
/// controller model of an emulated board.
class CanSeat {
  public:
    /// Sets the frame to send next and replaces the previous one; empty: none. A frame on the bus is always
    /// completed.
    virtual void offer(const std::optional<wire::CanFrame>& frame) = 0;
    /// Its own frame that is on the bus; null: none.
    [[nodiscard]] virtual const wire::CanFrame* under_way() const = 0;

  protected:
    ~CanSeat() = default;
};

/// Handlers of its owner, each called at the end of a frame.
struct CanSeatHandlers {
    FrameHandler on_frame;      ///< frames of the others
    FrameHandler on_sent;       ///< its own
    FrameHandler on_disturbed;  ///< its own, destroyed by a fault of the bus and received by no controller
};

class SimulatedCanBus {
  public:
    explicit SimulatedCanBus(const wire::BitRates& rates);
    SimulatedCanBus(const SimulatedCanBus&) = delete;
    SimulatedCanBus& operator=(const SimulatedCanBus&) = delete;

    /// Attaches a controller. `on_frame` is called for the frames of all others, never for its own. The
    /// transmitter lives as long as the bus, holds `mailboxes` frames and sends the lowest identifier first,
    /// equal ones in the order given. A frame counts as given at the bus's present time: call `advance(now)`
    /// before anything sends at `now`.
    node::CanTransmitter& attach(FrameHandler on_frame, std::size_t mailboxes = 3);
    /// Attaches a node's controller as its ports provide it: `node::may_join` decides which frames may wait
    /// in it.
    node::CanTransmitter& attach_node(FrameHandler on_frame);
    /// Attaches a controller that manages its own frames. It lives as long as the bus.
    CanSeat& attach_seat(CanSeatHandlers handlers);

    /// Called for every frame of every controller: for the recorder.
    void tap(FrameHandler on_frame);

    /// Applies from now on. Faults apply in the order they were added.
    void add_fault(const CanFault& fault);

    /// Ends and starts frames up to `now`, calling the handlers in the order of time, then taps first, then
    /// controllers in the order of attachment. Frames given at the same instant arbitrate with each other,
    /// whatever the order of the calls. Handlers may send; they must not call `advance`.
    void advance(SimTime now);

    /// The next instant at which `advance` changes something; empty if no frame is waiting or on the bus.
    [[nodiscard]] std::optional<SimTime> next_event() const;

    /// Share of the time from 0 to the last `advance` that the bus was busy, 0..1.
    [[nodiscard]] double busy_fraction() const;

  private:
    struct Pending {
        wire::CanFrame frame;
        SimTime given;
    };
    class Controller final : public node::CanTransmitter, public CanSeat {
      public:
        Controller(const SimulatedCanBus& bus, FrameHandler handler, std::size_t mailbox_count)
            : on_frame(std::move(handler)), bus_(bus), mailbox_count_(mailbox_count) {}
        bool send(const wire::CanFrame& frame) override;
        [[nodiscard]] node::CanState state() const override;
        void discard() override;
        [[nodiscard]] std::optional<wire::CanFrame> take_given_up() override;
        void offer(const std::optional<wire::CanFrame>& frame) override;
        [[nodiscard]] const wire::CanFrame* under_way() const override;
        void restart() override;

        void on_sent(const wire::CanFrame& frame, SimTime end);
        void on_error(const Pending& disturbed);
        /// The time at which a controller that is bus-off returns to the bus.
        [[nodiscard]] std::optional<SimTime> back_at() const { return back_at_; }
        [[nodiscard]] bool is_on_bus(SimTime time) const;

        FrameHandler on_frame;
        std::optional<CanSeatHandlers> seat;  ///< manages its own frames
        bool is_node = false;                 ///< else its mailboxes accept any frame
        std::vector<Pending> pending;         ///< in the order given; without the one on the bus

      private:
        void settle();
        [[nodiscard]] bool has_room_for(const wire::CanFrame& frame) const;

        const SimulatedCanBus& bus_;
        std::size_t mailbox_count_;
        std::deque<wire::CanFrame> given_up_;
        std::uint32_t transmit_errors_ = 0;
        bool is_off_ = false;
        std::optional<SimTime> back_at_;
    };
    struct Transmission {
        wire::CanFrame frame;
        Controller* sender = nullptr;
        SimTime end;
    };
    struct ActiveFault {
        CanFault fault;
        std::uint32_t matches = 0;
    };

    void end_transmission();
    [[nodiscard]] bool take_disturbance(const wire::CanFrame& frame);
    [[nodiscard]] bool start_transmission(SimTime now);
    void deliver_due(SimTime now);
    void deliver(const Transmission& heard);
    void schedule_heard(const Transmission& ended);
    [[nodiscard]] std::optional<SimTime> earliest_given() const;

    wire::BitRates rates_;
    SimTime now_;
    SimTime idle_since_;
    std::int64_t busy_us_ = 0;
    std::list<Controller> controllers_;  // a list: transmitters keep their addresses
    std::vector<FrameHandler> taps_;
    std::vector<ActiveFault> faults_;
    std::optional<Transmission> under_way_;
    std::multimap<SimTime, Transmission>
        heard_;  ///< ended frames to deliver; equal times in order of insertion
};

}  // namespace octoskin::sim
