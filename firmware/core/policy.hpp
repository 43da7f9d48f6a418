// The node core's own times and limits, in one place. What a rig may choose is in NodeConfig; these are
// choices of the firmware, passed in so that a test can change one. The node keeps the one copy; everybody
// else refers to it.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "firmware/core/run_record.hpp"

namespace octoskin::node {

struct Policy {
    /// How late the port may come to know of the end of an I2C transfer: an interrupt that is kept waiting,
    /// or a thread of an operating system.
    Microseconds i2c_lateness{1'000};

    // --- bring-up. Datasheet DS12385: boots within 1.2 ms of XSHUT high; it states no minimum low time.
    Microseconds xshut_low{1'000};
    Microseconds xshut_boot{2'000};
    /// The first range takes one period, 103 ms at the defaults by the part's own oscillator: before this it
    /// is not asked for.
    Microseconds first_range{85'000};

    /// A sensor that was stopped for longer than this is brought up anew before it ranges. Its temperature
    /// may have moved by 8 degrees, which it follows only while it ranges (ST UM2510 7.41).
    Microseconds rest_max{60'000'000};

    /// Nobody ranges sooner after the node began: a whole fleet is up by then, and nobody's bring-up has the
    /// bus when another one's data is ready.
    Microseconds first_starts{250'000};

    // --- reading
    /// How far one ready time may stray from the sensor's even grid, either way: the timer's share, and half
    /// of what its ranges differ by in length.
    Microseconds ready_jitter{30};
    Microseconds timer_jitter{30};
    /// What ranges differ by. Where in them the light was is not known any better.
    [[nodiscard]] Microseconds length_spread() const noexcept { return 2 * (ready_jitter - timer_jitter); }
    /// Where ranges differ in length no more is ever known of the next ready time than this: of the grid,
    /// from ready times that stray from it, and of the next one, which does so again. What a bracket's width
    /// decides is decided by what it is wider than that.
    [[nodiscard]] Microseconds width_of_jitter() const noexcept { return 2 * length_spread(); }
    /// A poll is read once: one that was altered on its way says "not ready" of data that was. Alone it is
    /// believed only where the rhythm tells the ready time to within this, which bounds what it can spoil.
    Microseconds lone_poll_believed{1'000};
    /// Nor can it spoil more than this, of the range it belongs to, if another one said the same so shortly
    /// before.
    Microseconds close_polls_believed{500};
    /// Known less well than within this, the next ready time is worth a poll that is punctual.
    Microseconds punctual_above{300};
    /// A sensor whose ready time is known this well is asked early, to see that it keeps its rhythm, only
    /// after `unproven_readings_max`.
    Microseconds known_width_max{1'000};
    /// So long may a sensor wait for its turn, or for the rest of it, while others must be punctual.
    Microseconds bus_wait_max{3'000};
    /// How uncertain the real period is before it was measured. The driver asks for 1.075 times the part's
    /// own oscillator value (ST's ULD); drivers for other parts were right with factors from 1.0 on.
    std::int32_t period_expected_permille = 80;
    /// And once a sensor has contradicted what was expected of it.
    std::int32_t period_unknown_permille = 120;
    /// Readings in a row whose data was ready when it was first asked for.
    std::uint8_t unproven_readings_max = 3;
    /// Between two polls: where data may become ready or has just become overdue, and where nothing is known.
    Microseconds repoll_min{20};
    Microseconds repoll_max{1'000};
    /// A reading whose capture time is less certain than this is not sent.
    Microseconds capture_bound_max{10'000};
    std::int32_t stale_after_periods = 3;
    std::uint8_t rejections_until_degraded = 10;
    /// Results in a row of which nobody knows the time, until the sensor is brought up anew: a second at 30
    /// Hz.
    std::uint8_t undated_until_failure = 30;
    /// Ranges in a row that a sensor itself calls a failure of its hardware, until it is brought up anew.
    std::uint8_t hardware_fails_until_failure = 10;
    /// One of the three groups of steering registers is read back after so many readings: each group
    /// within 10.
    std::uint8_t readings_per_steering_check = 3;

    // --- the data-ready line of a bus that has one
    /// Between two hints: one poll of the bus, and as much again for others.
    Microseconds hint_interval{250};
    std::uint16_t hint_doubt_max = 100;  ///< so many more spurious falls than confirmed ones make up for
    /// A sensor whose data the line announced is left to the line, as long as its ready time is known this
    /// well.
    Microseconds hinted_width_max{560};

    // --- trimming the inter-measurement register to the configured period
    std::int32_t trim_tolerance_permille = 5;
    std::uint8_t trims_at_start = 2;
    Microseconds trim_after{1'056'000};      ///< so long a run is measured before its period is judged
    Microseconds trim_interval{60'000'000};  ///< between trims once those at the start are used up
    std::uint32_t trim_edges_min = 8;        ///< ready times observed before a period counts as measured

    // --- holding sensors in their phases, where the rig asks for it
    Microseconds phase_tolerance{170};
    /// A ready time that is known less well says nothing about it.
    Microseconds phase_known_within{500};
    /// All of a run is counted from its first ready time: that should be known better.
    Microseconds phase_first_known_within{150};
    /// On which side of its phase a sensor is started, against the way that it walks: the rest is for how
    /// badly ready times are known.
    Microseconds phase_start_off{130};
    /// So early a sensor wants to start. One that the bus keeps waiting until it is so late starts a period
    /// later.
    Microseconds phase_start_slack{75};
    /// A sensor of which nobody knows whether its next range has begun is stopped so much later than it could
    /// be: what that tells then holds for those stops, too, that come as soon as they can.
    Microseconds phase_stop_delay{1'000};
    std::int64_t phase_periods_min = 16;  ///< between two starts for it, at least: each costs a reading

    // --- recovery of one sensor: restart, XSHUT cycle, then XSHUT cycles at growing distance
    std::uint8_t proven_readings_until_healthy = 10;
    Microseconds backoff_first{100'000};
    Microseconds backoff_max{10'000'000};
    Microseconds bus_isolation{2'000};  ///< all sensors in reset, before the first attempt to free the bus
    Microseconds bus_retry{1'000'000};  ///< between further attempts

    // --- frames out
    Microseconds company_wait{3'000};  ///< a reading waits this long for others to share its CAN FD frame
    Microseconds reading_age_max{50'000};
    Microseconds report_age_max{50'000};  ///< of a REFLEX or SYNC_REPORT: neither goes out late
    Microseconds heartbeat_period{100'000};
    Microseconds status_period{1'000'000};  ///< NODE_INFO's pages and every sensor's health, once each

    /// Between two looks, in turns at the sensors' health and at what is wrong with the node.
    Microseconds health_look_interval{500};

    Microseconds black_box_period{50'000};     ///< between two pieces of it
    Microseconds black_box_pause{60'000'000};  ///< between two dumps of a bus for faults

    // --- the reflex: an event is over once nothing came so near the limit for so long
    Microseconds reflex_rearm{200'000};
    std::int32_t reflex_margin_mm = 20;
    std::int32_t reflex_margin_permille = 100;

    // --- the CAN controller: ISO 11898-1 leaves it to us when to come back from bus-off
    Microseconds bus_off_first{100'000};
    Microseconds bus_off_longest{800'000};
    Microseconds can_proven{1'000'000};  ///< so long on the bus, and the next bus-off counts as the first

    // --- the node as a whole
    Microseconds watchdog_feed{20'000};  ///< the watchdog bites after 200 ms
    RunRules run_rules;                  ///< when resets are too many
    std::uint32_t retry_proven_s = 60;   ///< so long after safe mode, and it is over for good

    // --- frames in
    Microseconds command_repeat{500'000};  ///< the same command within this time is a duplicate frame
    Microseconds id_conflict_clear{5'000'000};
    /// NODE_INFO says for so long after the last one that commands are refused.
    Microseconds refusal_told{2'000'000};
};

}  // namespace octoskin::node
