// The node core's own times and limits. What a rig may choose is in NodeConfig; these are choices of the
// firmware, passed in so that a test can change one. The node holds the only copy; all others refer to it.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "firmware/core/run_record.hpp"

namespace octoskin::node {

struct Policy {
    /// How late the port may notice the end of an I2C transfer: a delayed interrupt, or a thread of an
    /// operating system.
    Microseconds i2c_lateness{1'000};

    // --- bring-up. Datasheet DS12385: boots within 1.2 ms of XSHUT high; it states no minimum low time.
    Microseconds xshut_low{1'000};
    Microseconds xshut_boot{2'000};
    /// The first range takes one period: 103 ms at the defaults, by the part's own oscillator. No poll for it
    /// comes before this time.
    Microseconds first_range{85'000};

    /// A sensor that was stopped for longer than this is brought up again before it ranges. Its temperature
    /// may have changed by 8 degrees, and it adapts only while it ranges (ST UM2510 7.41).
    Microseconds rest_max{60'000'000};

    /// No sensor starts to range sooner than this after the node's start. By then all sensors are brought up,
    /// and no bring-up occupies the bus when another sensor's data is ready.
    Microseconds first_starts{250'000};

    // --- reading
    /// How far one ready time may stray from the sensor's even grid, either way: the timer's share, plus half
    /// of the difference in length between its ranges.
    Microseconds ready_jitter{30};
    Microseconds timer_jitter{30};
    /// By how much ranges differ in length. The place of the measuring window within a range is not known
    /// better than this.
    [[nodiscard]] Microseconds length_spread() const noexcept { return 2 * (ready_jitter - timer_jitter); }
    /// Where ranges differ in length, the next ready time is never known better than this: the grid is
    /// derived from ready times that stray, and the next one strays again. Decisions that depend on the width
    /// of a bracket subtract this first.
    [[nodiscard]] Microseconds width_of_jitter() const noexcept { return 2 * length_spread(); }
    /// A poll is read once. If it was altered in transit it reads "not ready" although data was ready. A
    /// single poll is trusted only where the rhythm predicts the ready time to within this, which bounds the
    /// possible error.
    Microseconds lone_poll_accepted{1'000};
    /// A poll is also trusted if another one with the same answer was at most this long before. That bounds
    /// the error for its range to this.
    Microseconds close_polls_accepted{500};
    /// If the next ready time is known less well than this, it needs a punctual poll.
    Microseconds punctual_above{300};
    /// A sensor whose ready time is known this well is polled within the bracket. Only after
    /// `unproven_readings_max` readings is it polled before the bracket, to check its rhythm.
    Microseconds known_width_max{1'000};
    /// The longest time for which a sensor waits for its turn on the bus, or for the rest of an interrupted
    /// one, while others must be punctual.
    Microseconds bus_wait_max{3'000};
    /// The uncertainty of the real period before it is measured. The driver requests 1.075 times the part's
    /// own oscillator value (ST's ULD); drivers for other parts were correct with factors from 1.0 on.
    std::int32_t period_expected_permille = 80;
    /// The same, once the sensor's rhythm was lost.
    std::int32_t period_unknown_permille = 120;
    /// So many readings in a row may have their data ready at the first poll; then the rhythm needs proof.
    std::uint8_t unproven_readings_max = 3;
    /// Time between two polls: the minimum while data may become ready or has just become overdue, the
    /// maximum while the ready time is unknown.
    Microseconds repoll_min{20};
    Microseconds repoll_max{1'000};
    /// A reading whose capture time is less certain than this is not sent.
    Microseconds capture_bound_max{10'000};
    std::int32_t stale_after_periods = 3;
    std::uint8_t rejections_until_degraded = 10;
    /// Undated results in a row until the sensor is brought up again: a second at 30 Hz.
    std::uint8_t undated_until_failure = 30;
    /// Ranges in a row that the sensor itself reports as a hardware failure, until it is brought up again.
    std::uint8_t hardware_fails_until_failure = 10;
    /// After this many readings, one of the three groups of steering registers is read back. Each group is
    /// thus read back within 10 readings.
    std::uint8_t readings_per_steering_check = 3;

    // --- the data-ready line of a bus that has one
    /// Time between two hints: for one poll, and as much for other transfers.
    Microseconds hint_interval{250};
    /// The line is ignored after so many more spurious falls than confirmed ones offset.
    std::uint16_t hint_doubt_max = 100;
    /// If the line announced a sensor's last data, and the next ready time is known this well, the next poll
    /// waits for the line.
    Microseconds hinted_width_max{560};

    // --- trimming the inter-measurement register to the configured period
    std::int32_t trim_tolerance_permille = 5;
    std::uint8_t trims_at_start = 2;
    Microseconds trim_after{1'056'000};      ///< a run is measured for this long before its period is judged
    Microseconds trim_interval{60'000'000};  ///< between trims once those at the start are used up
    std::uint32_t trim_edges_min = 8;        ///< ready times observed before a period counts as measured

    // --- holding sensors in their phases, where the rig asks for it
    Microseconds phase_tolerance{170};
    /// A ready time that is known less well than this is not used to measure the phase.
    Microseconds phase_known_within{500};
    /// The drift of a run is counted from its first ready time. If that is known less well than this, a
    /// better one is awaited for some periods.
    Microseconds phase_first_known_within{150};
    /// The most by which a sensor is started off its phase, against its direction of drift. The rest of the
    /// tolerance covers the uncertainty of ready times.
    Microseconds phase_start_off{130};
    /// A start is due this long before its time. If the bus delays it to more than this after its time, the
    /// sensor starts a period later.
    Microseconds phase_start_slack{75};
    /// A sensor whose next range may already have begun is stopped this much later than possible. If the stop
    /// shows that no range had begun, later stops may come this much sooner without a wait (RangeLength).
    Microseconds phase_stop_delay{1'000};
    std::int64_t phase_periods_min = 16;  ///< between two starts for the phase; each costs a reading

    // --- recovery of one sensor: restart, XSHUT cycle, then XSHUT cycles at growing intervals
    std::uint8_t proven_readings_until_healthy = 10;
    Microseconds backoff_first{100'000};
    Microseconds backoff_max{10'000'000};
    Microseconds bus_isolation{2'000};  ///< time with all sensors in reset before the bus is freed
    Microseconds bus_retry{1'000'000};  ///< between further attempts to free it

    // --- frames out
    Microseconds company_wait{3'000};  ///< a reading waits this long for others to share its CAN FD frame
    Microseconds reading_age_max{50'000};
    Microseconds report_age_max{50'000};  ///< of a REFLEX or SYNC_REPORT: neither is sent late
    Microseconds heartbeat_period{100'000};
    Microseconds status_period{1'000'000};  ///< NODE_INFO's pages and every sensor's health, once each

    /// Between two looks, alternately at the sensors' health and at the node's faults.
    Microseconds health_look_interval{500};

    Microseconds black_box_period{50'000};     ///< between two pieces of a dump
    Microseconds black_box_pause{60'000'000};  ///< between two dumps of a bus that faults cause

    // --- the reflex: an event is over once no range was below the limit plus the margin for `reflex_rearm`
    Microseconds reflex_rearm{200'000};
    std::int32_t reflex_margin_mm = 20;
    std::int32_t reflex_margin_permille = 100;

    // --- the CAN controller: ISO 11898-1 does not specify when to return from bus-off
    Microseconds bus_off_first{100'000};
    Microseconds bus_off_longest{800'000};
    Microseconds can_proven{1'000'000};  ///< after this long on the bus the next bus-off counts as the first

    // --- the node as a whole
    Microseconds watchdog_feed{20'000};  ///< the watchdog resets the node after 200 ms
    RunRules run_rules;                  ///< when resets are too many
    std::uint32_t retry_proven_s = 60;   ///< after this long a retry has succeeded and safe mode is over

    // --- frames in
    Microseconds command_repeat{500'000};  ///< the same command within this time is a duplicate frame
    Microseconds id_conflict_clear{5'000'000};
    /// NODE_INFO reports refused commands for this long after the last one.
    Microseconds refusal_reported{2'000'000};
};

}  // namespace octoskin::node
