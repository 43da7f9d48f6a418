// The CAN controller: sends frames at once, receives frames with the time of their end, and recovers from
// bus-off. RM0440, "FDCAN".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/port/stm32g4/can_bit_timing.hpp"
#include "firmware/port/stm32g4/can_message_ram.hpp"
#include "firmware/port/stm32g4/microsecond_timer.hpp"

namespace octoskin::stm32g4 {

struct CanCounts {
    std::uint32_t given_up = 0;  ///< frames taken but not sent: not acknowledged in time, or bus-off
    std::uint32_t failed = 0;    ///< times that the controller left the bus for a reason other than bus-off
    std::uint32_t received = 0;
    std::uint32_t receive_lost = 0;  ///< frames lost for lack of room
};

/// Traffic received on a bus while its bit rates are being determined.
struct Heard {
    std::uint32_t frames = 0;
    bool has_errors = false;  ///< a frame could not be decoded: wrong rates, or a disturbed line
};

struct ReceivedFrame {
    wire::CanFrame frame;
    NodeTime received;  ///< end of the frame, as timed by the interrupt
};

class CanController final : public node::CanTransmitter {
  public:
    /// A frame that is not acknowledged within this time is cancelled, so that no old frame is sent.
    static constexpr Microseconds kTransmitAgeMax{20'000};
    /// A failure stays visible in `state` for this long after it happened.
    static constexpr Microseconds kFailureShown{1'000'000};

    constexpr explicit CanController(const MicrosecondTimer& timer) : timer_(timer) {}

    /// Joins the bus at these rates and receives the frames for `node_id`. Returns false and stays off the
    /// bus if `clock_hz` is 0 or cannot give these rates.
    [[nodiscard]] bool start(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz);

    /// As `start`, but receives every frame, sends nothing and does not disturb the bus at any rate. May be
    /// called again with other rates.
    [[nodiscard]] bool listen(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz);
    /// Call after `listen`: leaves monitoring mode and joins the bus.
    [[nodiscard]] bool join();
    /// Traffic received since `listen`.
    [[nodiscard]] Heard heard() const;

    /// Takes the frame if one of the three transmit buffers (`Place`) is free and `node::may_join` permits
    /// it. The lowest identifier is sent first.
    [[nodiscard]] bool send(const wire::CanFrame& frame) override;
    /// The oldest frame received and not yet taken.
    [[nodiscard]] std::optional<ReceivedFrame> receive();
    [[nodiscard]] bool has_received() const { return put_ != taken_; }

    /// `passive` also while the controller is silent, since nothing is acknowledged then, and shortly after a
    /// failure, so that the heartbeat reports it.
    [[nodiscard]] node::CanState state() const override;
    void discard() override;
    [[nodiscard]] std::optional<wire::CanFrame> take_given_up() override;
    void restart() override;
    /// True while the controller is on the bus or in bus-off.
    [[nodiscard]] bool is_started() const { return is_started_; }
    [[nodiscard]] bool is_listening() const { return is_listening_; }

    /// Cancels frames that are too old. Detects a failure of the controller, which is then silent until it is
    /// started again. Call at `wake_time` and after each event.
    void poll(NodeTime now);
    /// Time at which the oldest waiting frame becomes too old.
    [[nodiscard]] std::optional<NodeTime> wake_time() const;
    /// Whether there was an interrupt since the last `acknowledge_event`. Call `acknowledge_event` before
    /// checking the state.
    [[nodiscard]] bool has_event() const { return has_event_; }
    void acknowledge_event() { has_event_ = false; }

    [[nodiscard]] CanCounts counts() const;

    /// Call from the interrupt handler.
    void on_interrupt();

  private:
    struct Place {
        wire::CanFrame frame;
        NodeTime given;
        bool is_pending = false;
        bool is_taken_back = false;
        bool is_given_up = false;  ///< not yet returned by `take_given_up`; blocks this place
    };

    [[nodiscard]] bool enter(const CanRates& rates, wire::NodeId node_id, std::uint32_t clock_hz);
    void set_timing(const CanRates& rates, std::uint32_t clock_hz) const;
    void prepare(wire::NodeId node_id) const;
    void listen_to_all() const;
    [[nodiscard]] bool set_init(bool is_set) const;
    [[nodiscard]] bool has_room_for(const wire::CanFrame& frame) const;
    void note_ended();
    void take_back(std::uint32_t index);
    void receive_all(NodeTime now);
    void give_up_all();
    [[nodiscard]] bool has_failed() const;
    void fall_silent(NodeTime now);

    const MicrosecondTimer& timer_;
    bool is_started_ = false;
    bool is_listening_ = false;
    std::optional<NodeTime> failed_at_;  ///< set for `kFailureShown`
    std::array<Place, kFifoElements> places_{};
    CanCounts counts_;

    static constexpr std::uint32_t kQueueFrames = 16;  // a power of two: the counters below wrap freely
    std::array<ReceivedFrame, kQueueFrames> queue_{};
    std::atomic<std::uint32_t> put_ = 0;    ///< written by the interrupt
    std::atomic<std::uint32_t> taken_ = 0;  ///< written by the main loop
    std::atomic<std::uint32_t> lost_ = 0;
    std::atomic<std::uint32_t> heard_ = 0;
    std::atomic<bool> has_errors_ = false;
    std::atomic<bool> has_lost_ram_ = false;
    std::atomic<bool> has_event_ = false;
};

}  // namespace octoskin::stm32g4
