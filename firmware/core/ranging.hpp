// One configured sensor while it ranges: starts it in its phase, polls it when its data should be ready,
// passes each result to acceptance, cycles its zones, and restarts it to trim its period or correct its
// phase.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/acceptance.hpp"
#include "firmware/core/bus_use.hpp"
#include "firmware/core/period_trim.hpp"
#include "firmware/core/phase_clock.hpp"
#include "firmware/core/phase_hold.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/poll_plan.hpp"
#include "firmware/core/range_length.hpp"
#include "firmware/core/reading.hpp"
#include "firmware/core/steering_checks.hpp"
#include "firmware/core/zone_cycle.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

/// The part of the node's configuration that ranging needs.
struct RangingRules {
    StreamGate stream_gate = StreamGate::advanced;
    Microseconds zone_guard{1'000};
    std::uint32_t i2c_hz = 400'000;
    bool holds_phases = false;
};

class Ranging {
  public:
    enum class Event : std::uint8_t {
        none,
        reading,  ///< `reading()` was accepted
        undated,  ///< a good result of unknown time or zone was dropped
        refused,  ///< a result was not new, or its two reads did not agree: see `fault()`
        stopped,  ///< as requested
        failed,   ///< the sensor does not answer, or nothing was accepted for too long: see `fault()`
    };
    struct Result {
        BusUse bus = BusUse::releases;
        Event event = Event::none;
    };

    /// `node_began`: when the first bring-up of all the sensors began.
    Ranging(vl53l1x::Device& device, const SensorConfig& config, const RangingRules& rules,
            const Policy& policy, const PhaseClock& clock, NodeTime node_began) noexcept;

    /// The sensor was just configured: it is in its first zone, and all its settings were read back.
    void on_configured() noexcept {
        zones_.restart();
        checks_.restart();
    }
    /// The sensor is configured and stopped: starts it at its next phase.
    void begin(NodeTime now);
    /// Stops and starts it, to recover a silent sensor.
    void begin_restart(NodeTime now);
    /// Stops once the transfers under way have ended, then reports `stopped`.
    void request_stop(NodeTime now) noexcept;
    /// The bus's data-ready line fell: polls now if data may be there. Which sensor pulled the line is
    /// unknown, so this is only a reason to poll.
    void on_hint(NodeTime now) noexcept;
    /// Whether data was found that the line had announced. Returns true once.
    [[nodiscard]] bool take_confirmation() noexcept { return std::exchange(has_confirmed_, false); }
    /// Sets another period. It applies from the next start on; a ranging sensor is restarted for it.
    void set_period(Microseconds period, NodeTime now) noexcept;
    /// The sensor was taken away (reset, lost): nothing is under way any more.
    void abandon() noexcept { step_ = Step::idle; }

    /// When the sensor needs the bus punctually: for a start in its phase, or for a poll that would leave the
    /// ready time too uncertain if it came late.
    [[nodiscard]] std::optional<NodeTime> deadline_due() const noexcept {
        const bool is_punctual =
            step_ == Step::awaiting_phase || (step_ == Step::awaiting_data && is_poll_punctual_);
        if (is_punctual) return step_due_;
        // After its early polls, a sensor is polled punctually.
        if (step_ == Step::awaiting_data && is_early_) return early_until_;
        return std::nullopt;
    }
    /// Whether it waits for its start, which must be punctual.
    [[nodiscard]] bool awaits_start() const noexcept { return step_ == Step::awaiting_phase; }
    /// Whether the poll that is due comes before the first data is expected. It most likely finds none, so it
    /// can wait.
    [[nodiscard]] bool is_early(NodeTime now) const noexcept {
        return step_ == Step::awaiting_data && is_early_ && !is_reached(early_until_, now);
    }
    /// Whether another sensor may interrupt it. False during a start, which determines the times of all
    /// ranges of its run. False between a poll and the poll that confirms it. False while a zone is to be
    /// written, because that is short and soon too late.
    [[nodiscard]] bool is_preemptible() const noexcept {
        return step_ != Step::starting && step_ != Step::writing_zone &&
               !(step_ == Step::reading && device_.is_confirming_ready());
    }
    /// When the bus is needed; empty if nothing is under way.
    [[nodiscard]] std::optional<NodeTime> due() const noexcept {
        return step_ == Step::idle ? std::nullopt : std::optional(step_due_);
    }
    /// Advances by one step. The bus must be free, or in use by this sensor's own transfer.
    [[nodiscard]] Result advance(NodeTime now);

    [[nodiscard]] const Reading& reading() const noexcept { return acceptance_.reading(); }
    /// Whether the last reading followed another one, which proves that the sensor measures.
    [[nodiscard]] bool is_proven() const noexcept { return acceptance_.is_proven(); }
    [[nodiscard]] wire::SensorFault fault() const noexcept { return fault_; }
    /// Readings accepted since the last correct read-back of the registers that are now wrong; 0 for a
    /// failure of another kind.
    [[nodiscard]] std::uint32_t suspect_readings() const noexcept { return suspect_readings_; }
    /// Whether stopping and starting may help the failed sensor.
    [[nodiscard]] bool can_restart() const noexcept;
    /// The deviation of the measured period from the configured one; 0 until measured.
    [[nodiscard]] std::int32_t period_error_permille() const noexcept;

  private:
    enum class Step : std::uint8_t {
        idle,
        setting_period,
        checking_period,
        awaiting_phase,
        starting,
        awaiting_data,
        reading,
        writing_zone,
        checking_zone,
        checking_steering,
        stopping,
        draining,      ///< the range under way at the stop may still end with a result
        reading_last,  ///< reading that result, if there is one
    };

    void start_step(Step step, NodeTime now);
    void start_due_step(NodeTime now);
    [[nodiscard]] bool is_waiting() const noexcept;
    [[nodiscard]] bool is_too_late_to_start(NodeTime now) const noexcept;
    [[nodiscard]] Event on_step_done(NodeTime now);
    [[nodiscard]] Event on_step_failed(vl53l1x::Error error, NodeTime now);
    void drain(NodeTime now);
    [[nodiscard]] Event on_drained(NodeTime now);
    void start_anew(NodeTime now);
    [[nodiscard]] Event on_read(NodeTime now);
    [[nodiscard]] Event on_last_read(NodeTime now);
    [[nodiscard]] Admission judge_result(NodeTime now);
    [[nodiscard]] Event refuse(wire::SensorFault fault, NodeTime now);
    [[nodiscard]] Event fail(wire::SensorFault fault);
    void on_started(NodeTime now);
    void after_result(NodeTime now);
    [[nodiscard]] bool is_restart_wanted(NodeTime now) noexcept;
    [[nodiscard]] bool is_between_ranges(NodeTime now) const noexcept;
    [[nodiscard]] NodeTime stop_time(NodeTime now) const noexcept;
    void check_or_await(NodeTime now);
    [[nodiscard]] NodeTime repoll(NodeTime now) const noexcept;
    void await_next_result(NodeTime now);
    void await_data(NodeTime due) noexcept;
    void note_announcement() noexcept;
    [[nodiscard]] NodeTime next_poll(const TimeBracket& predicted) const noexcept;
    [[nodiscard]] bool is_zone_write_due(NodeTime now) const noexcept;
    [[nodiscard]] NodeTime next_phase(NodeTime now) const noexcept;
    [[nodiscard]] Microseconds budget() const noexcept;

    vl53l1x::Device& device_;
    const SensorConfig& config_;
    RangingRules rules_;
    const Policy& policy_;
    const PhaseClock& clock_;
    PollPlan polls_;
    Acceptance acceptance_;
    PeriodTrim trim_;
    PhaseHold phase_;
    RangeLength range_length_;
    ZoneCycle zones_;
    SteeringChecks checks_;

    NodeTime first_start_;
    // The next two are computed once for each poll, because they are needed in every turn on the bus.
    bool is_poll_punctual_ = false;    ///< the poll must be punctual
    bool is_early_ = false;            ///< the poll comes before the first data is expected
    NodeTime phase_due_;               ///< when the sensor was to start, even if the bus was not free then
    std::uint8_t starts_put_off_ = 0;  ///< late starts in a row that were put off by a period
    Microseconds start_off_{0};        ///< offset of the planned start from the sensor's phase
    std::uint32_t ranges_ = 0;         ///< results since the start
    Step step_ = Step::idle;
    NodeTime step_due_;
    NodeTime step_began_;
    NodeTime ready_from_;         ///< while data is awaited: none is ready before this
    TimeBracket first_expected_;  ///< where the first data after the start is most likely ready
    NodeTime early_until_;        ///< a poll before this most likely finds no data
    bool has_hint_ = false;       ///< a hint came since the newest poll began
    bool is_hinted_ = false;      ///< the poll under way follows a hint
    bool has_confirmed_ = false;  ///< `take_confirmation` will return true
    bool was_announced_ = false;  ///< the line announced the last data
    bool is_stop_requested_ = false;
    bool is_trim_due_ = false;
    bool is_period_set_ = false;      ///< the sensor has the commanded period
    bool comes_as_expected_ = false;  ///< the first data of the last run came when it was expected
    NodeTime stop_began_;
    /// While the result of the range under way at the stop is looked for: when it would be ready.
    TimeBracket last_expected_;
    std::uint8_t looks_left_ = 0;
    wire::SensorFault fault_ = wire::SensorFault::none;
    std::uint32_t suspect_readings_ = 0;
};

}  // namespace octoskin::node
