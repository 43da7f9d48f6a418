// The node: brings its sensors up, reads them on schedule, accepts or rejects each reading, and sends frames.
// The same code runs on the board, on Linux and in the simulator: time is an argument, buses and lines are
// interfaces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/alike_differences.hpp"
#include "firmware/core/announcer.hpp"
#include "firmware/core/black_box.hpp"
#include "firmware/core/bus_off_recovery.hpp"
#include "firmware/core/bus_worker.hpp"
#include "firmware/core/calibration.hpp"
#include "firmware/core/data_ready_hint.hpp"
#include "firmware/core/phase_clock.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/core/reading_queue.hpp"
#include "firmware/core/reflex.hpp"
#include "firmware/core/run_record.hpp"
#include "firmware/core/sensor.hpp"
#include "firmware/core/token_bucket.hpp"

namespace octoskin::node {

/// The node's counters since its start.
struct NodeCounts {
    std::uint32_t i2c_errors = 0;  ///< failed transfers, also those retried, except unanswered ones at 0x29
    std::uint32_t rejected = 0;    ///< results that did not become readings
    std::uint32_t reads_disagreed = 0;  ///< of these: the two reads never agreed
    std::uint32_t undated = 0;          ///< of these: time or zone not known well enough
    std::uint32_t withheld = 0;  ///< of these: a register that decides the range does not keep its value
    std::uint32_t suspect = 0;   ///< readings sent while a register may have been wrong
    std::uint32_t sensor_restarts = 0;
    std::uint32_t displaced = 0;  ///< readings displaced by a newer one of the same sensor before being sent
    std::uint32_t late = 0;       ///< readings that waited too long to be sent
    std::uint32_t others_late = 0;      ///< REFLEX and SYNC_REPORT that waited too long
    std::uint32_t given_up = 0;         ///< readings in frames that the controller took but could not send
    std::uint32_t others_given_up = 0;  ///< such frames without a reading
    std::uint32_t bus_off = 0;          ///< times that the controller went bus-off
    std::uint32_t accepted = 0;         ///< readings: sent, displaced, late, given up, or still waiting
    std::uint32_t frames_sent = 0;      ///< handed to the controller
    std::uint32_t rx_rejected = 0;      ///< frames for this node that failed a check, and refused commands
    std::uint32_t boots_late = 0;      ///< sensors that were given their address before the end of their boot
    std::uint32_t spurious_hints = 0;  ///< falling edges of data-ready lines while no sensor had data
};

/// If `config` is not valid or is for another type of board, the node does not range and its heartbeat
/// reports `bad_config`. For a missing or damaged configuration block see `without_configuration`.
///
/// Call `poll` in a loop of 100 us or faster, or at `wake_time` and whenever an I2C transfer ends or a
/// transmit mailbox becomes free. Call `on_frame` for every frame received (never for own ones), with the
/// time of its end. One thread only; no call waits, except `i2c::Bus::recover` for at most 1 ms. A `poll`
/// takes at most 4 steps on each I2C bus and sends at most 8 frames: O(sensors). Slower loops are safe, but
/// lose readings: each transfer of a reading needs a poll of its own.
class Node {
  public:
    Node(const NodeConfig& config, const Identity& identity, const Ports& ports, NodeTime now,
         const Policy& policy = {});
    Node(const Node&) = delete;
    Node& operator=(const Node&) = delete;

    void poll(NodeTime now);
    void on_frame(const wire::CanFrame& frame, NodeTime received);

    /// The next time at which `poll` has work, never before `now`. It does not include the ends of I2C
    /// transfers and of transmissions, which are events of the ports: call `poll` then, too.
    [[nodiscard]] NodeTime wake_time(NodeTime now) const;

    /// Readings that wait to be sent.
    [[nodiscard]] std::size_t waiting() const noexcept { return queue_.waiting(); }
    /// Readings handed to the controller and not given up since.
    [[nodiscard]] std::uint32_t readings_sent() const noexcept { return queue_.total_sent() - given_up_; }

    /// Times that the CAN controller went bus-off.
    [[nodiscard]] std::uint32_t bus_off_count() const noexcept { return bus_off_.count(); }

    /// Bit b: the data-ready line of bus b had too many spurious falls and is ignored until the next start.
    /// Its sensors are still read.
    [[nodiscard]] std::uint8_t ignored_data_ready() const noexcept;

    /// Register differences that several sensors have in common, in the order in which they were recognised.
    [[nodiscard]] std::span<const AlikeDifferences::CommonDifference> alike() const noexcept {
        return alike_.learnt();
    }

    /// The host requested a reset: the application performs it.
    [[nodiscard]] bool is_reset_requested() const noexcept { return is_reset_requested_; }

    [[nodiscard]] wire::NodeState state() const noexcept;
    [[nodiscard]] NodeCounts counts() const noexcept;
    /// In the rig's order; none of the optionals is empty.
    [[nodiscard]] std::span<const std::optional<Sensor>> sensors() const noexcept {
        return std::span(sensors_).first(sensor_count_);
    }

  private:
    /// The sensors that a command names: [first, end).
    struct Selection {
        std::uint8_t first = 0;
        std::uint8_t end = 0;
        [[nodiscard]] bool is_empty() const noexcept { return first == end; }
    };
    /// What was last reported about a sensor, and the worst capture bound since.
    struct ReportedSensor {
        wire::SensorState state = wire::SensorState::starting;
        wire::SensorFault fault = wire::SensorFault::none;
        Microseconds bound{0};
        Microseconds bound_since{0};
    };
    struct ReceivedCommand {
        wire::Command command;
        NodeTime received;
    };

    // --- work (node.cpp)
    void create_sensors(NodeTime now);
    [[nodiscard]] DataReadyHint data_ready_hint(std::uint8_t bus) const noexcept;
    void advance_buses(NodeTime now);
    void collect_readings(NodeTime now);
    void collect_calibration();
    void watch_reflex(std::uint8_t sensor, const Reading& reading, NodeTime now);
    void note_health_changes(NodeTime now);
    void learn_what_is_alike(NodeTime now);
    void end_what_has_expired(NodeTime now);
    void blink(NodeTime now);

    // --- the node as a whole (node_supervision.cpp)
    void start_run(NodeTime now);
    void supervise_can(NodeTime now);
    void count_uptime(NodeTime now);
    void judge_run(NodeTime now);
    void leave_safe_mode(RunMode mode, NodeTime now);
    [[nodiscard]] bool is_safe() const noexcept { return run_.mode == RunMode::safe; }
    void keep_run_record() noexcept;
    void feed_watchdog(NodeTime now);

    // --- frames in (node_receive.cpp)
    [[nodiscard]] bool is_for_us(const wire::CanFrame& frame) const noexcept;
    void on_own_id_heard(NodeTime now);
    void apply_order_to_range(NodeTime now);
    void on_command(const wire::Command& command, NodeTime now);
    void refuse(const wire::Command& command, NodeTime now);
    [[nodiscard]] bool perform_in_safe_mode(const wire::Command& command, NodeTime now);
    [[nodiscard]] bool perform(const wire::Command& command, NodeTime now);
    [[nodiscard]] bool calibrate(const wire::Command& command, NodeTime now);
    [[nodiscard]] bool request_black_box(const Selection& selection, NodeTime now);
    [[nodiscard]] bool set_rate(const Selection& selection, std::uint16_t period_ms, NodeTime now);
    [[nodiscard]] Selection selected(std::uint8_t sensor) const noexcept;
    [[nodiscard]] static std::uint64_t mask_of(const Selection& selection) noexcept;

    // --- frames out (node_transmit.cpp)
    void count_given_up();
    void drop_late(NodeTime now);
    void transmit(NodeTime now);
    [[nodiscard]] bool send_most_urgent(NodeTime now);
    [[nodiscard]] bool send(const wire::Message& message);
    [[nodiscard]] bool send_reflex();
    [[nodiscard]] wire::Heartbeat heartbeat() const noexcept;
    [[nodiscard]] wire::NodeInfo info(wire::InfoPage page) const noexcept;
    [[nodiscard]] wire::InfoFault fault_to_report() const noexcept;
    void note_fault_change();
    void forward_faults();
    void note_fault_reported() noexcept;
    template <class Visitor>
    void visit_present_faults(Visitor visit) const;
    [[nodiscard]] std::uint32_t fault_count() const noexcept;
    [[nodiscard]] wire::SensorHealth health(std::uint8_t sensor) const noexcept;
    [[nodiscard]] Microseconds bound_to_report(std::uint8_t sensor) const noexcept;
    [[nodiscard]] std::uint8_t bound_on_wire(Microseconds bound) const noexcept;
    void note_reported(std::uint8_t sensor) noexcept;

    NodeConfig config_;
    Identity identity_;
    Ports ports_;
    Policy policy_;
    bool is_config_usable_;
    std::uint32_t node_hash_;
    std::uint16_t uid_crc_;
    std::uint8_t sensor_count_ = 0;  ///< sensors in use: none in safe mode or with a bad configuration

    PhaseClock phase_clock_;
    BusRecorders recorders_{};
    std::array<std::optional<BusWorker>, kNodeBusesMax> buses_{};
    vl53l1x::Verification verification_;
    std::array<std::optional<Sensor>, kNodeSensorsMax> sensors_{};
    AlikeDifferences alike_{verification_, sensors_};
    std::array<ReportedSensor, kNodeSensorsMax> reported_{};
    std::array<std::optional<Reflex>, kNodeSensorsMax> reflexes_{};
    struct ReflexEvent {
        wire::Reflex message;
        NodeTime since;
    };
    std::array<ReflexEvent, kNodeSensorsMax> reflex_events_{};
    std::uint64_t reflex_due_ = 0;  ///< bit i: `reflex_events_[i]` is to be sent
    std::uint8_t reflex_sequence_ = 0;
    std::uint32_t faults_seen_ = 0;        ///< hash of the faults at the last check
    std::uint32_t fault_turn_ = 0;         ///< number of the fault to report next; counts on
    std::uint32_t faults_unreported_ = 0;  ///< faults not yet reported since they changed
    bool is_refusal_unreported_ = false;   ///< a command was refused since the last `forward_faults`
    bool is_refusal_due_ = false;          ///< the next fault page reports the refused command
    ReadingQueue queue_;
    Announcer announcer_;
    TokenBucket tokens_;
    TokenBucket reflex_tokens_;
    BlackBox black_box_;
    CalibrationDialogue calibration_;
    BusOffRecovery bus_off_;
    CanState can_state_ = CanState::active;
    RunRecord run_;
    wire::ResetCause reset_cause_ = wire::ResetCause::unknown;

    bool has_unsent_ = false;
    bool is_lit_ = false;
    bool is_reset_requested_ = false;
    bool is_health_look_due_ = false;
    NodeTime health_looked_at_;
    bool looks_at_faults_ = false;  ///< the next check is of the faults, not of the health
    std::uint32_t frames_sent_ = 0;
    std::uint32_t given_up_ = 0;
    std::uint32_t others_given_up_ = 0;
    std::uint32_t others_late_ = 0;
    std::uint32_t accepted_ = 0;
    std::uint32_t rx_rejected_ = 0;
    std::optional<wire::SyncReport> sync_report_;
    std::optional<ReceivedCommand> last_command_;
    std::optional<ReceivedCommand> refused_command_;  ///< first of a recent series, with the time of the last
    std::uint64_t commanded_to_range_ = 0;            ///< bit i: sensor i
    std::optional<NodeTime> own_id_heard_;
    std::optional<NodeTime> identify_until_;
    NodeTime blink_at_;
    std::uint32_t uptime_ms_ = 0;
    NodeTime uptime_counted_;
    std::uint32_t mode_since_ms_ = 0;  ///< start of `run_.mode`, in uptime
    NodeTime feed_at_;
};

}  // namespace octoskin::node
