// The last check before a reading becomes a measurement: certainty of its time, place in the sequence, age,
// status, zone and values.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/beams/range_measurement.hpp"
#include "host/core/ingest/cadence.hpp"
#include "host/core/ingest/fate_history.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/ingest/said_numbers.hpp"
#include "host/core/ingest/sender_watch.hpp"
#include "host/core/ingest/sent_count.hpp"
#include "host/core/ingest/sequence_tracker.hpp"
#include "host/core/ingest/stretch.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/rig/sensor_id.hpp"
#include "host/core/time/clock_map.hpp"

namespace octoskin {

/// Everything that is known about one sensor, for reports to the user.
struct SensorRecord {
    std::uint64_t received = 0;                     ///< readings that arrived, each counted once
    std::optional<wire::RangeReading> newest;       ///< the newest of them, whatever its result
    Stretch arrivals;                               ///< arrivals of readings without a break (`break_after`)
    std::optional<ReadingReason> newest_rejected;   ///< why it was not accepted, or not put into the map
    FateHistory fates;                              ///< results of the newest readings
    std::array<std::uint64_t, 32> device_status{};  ///< how often each code came
    SequenceTracker sequence;
    std::optional<wire::SensorHealth> health;
    std::optional<wire::SignalReading> signal;
    /// Bound on the error of its capture times, from the node's newest report since it started.
    std::optional<Nanoseconds> capture_bound;
    std::uint64_t reflexes = 0;          ///< how often something came closer than the sensor's limit
    std::optional<wire::Reflex> reflex;  ///< the newest
    SentCount sent;                      ///< readings sent and lost
    /// Arrivals of its readings and SENSOR_HEALTH; begins when its node becomes usable (RangeGate::expect).
    Stretch words;
    static constexpr Nanoseconds kUnheardAfter{3'000'000'000};
    /// Losses during complete silence do not predict the losses that follow.
    void note_word(std::optional<HostTime> now) noexcept {
        const auto& before = words.newest();
        if (!now || !before || *now - *before > kUnheardAfter) sent.forget_steps();
        words.note(now, kUnheardAfter);
    }
    /// A sensor of this configured period has stopped delivering if no reading arrives for this time.
    [[nodiscard]] static constexpr Nanoseconds break_after(Nanoseconds period) noexcept {
        return std::max(Nanoseconds{500'000'000}, 2 * period);
    }
};

class RangeGate {
  public:
    /// `uses_no_return`: beams without return may clear space; otherwise they are rejected here. `now_early`:
    /// the host time may be this much behind (ClockMapConfig::now_slack).
    explicit RangeGate(const HostRig& rig, bool uses_no_return,
                       Nanoseconds now_early = ClockMapConfig{}.now_slack);

    [[nodiscard]] bool knows(wire::NodeId node, std::uint8_t sensor) const {
        return sensors_.contains({node, sensor});
    }
    /// For every reading of a known sensor, whatever its result.
    void on_arrival(wire::NodeId node, const wire::RangeReading& reading, std::optional<HostTime> now);
    /// Result of the newest reading, at this gate or before it.
    void on_fate(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected);
    /// Result, in the map, of a reading that was accepted here.
    void on_fate_in_map(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected);
    /// Call after `on_arrival`, for a reading whose node is usable and whose time is known.
    /// `is_clock_questioned`: other readings of its node have impossible times, so that its own time must
    /// show that the clock continues.
    [[nodiscard]] Result<RangeMeasurement, ReadingReason> check(wire::NodeId node,
                                                                const wire::RangeReading& reading,
                                                                const MappedTime& captured, HostTime now,
                                                                bool is_clock_questioned = false);

    /// The time until which an accepted reading is held, because a second sender may use its node's id. By
    /// then, the true reading with the same number would have arrived. Empty: the reading is not held.
    [[nodiscard]] std::optional<HostTime> held_until(const RangeMeasurement& measurement, HostTime now) const;
    /// The readings of a node are held for this time after a contradiction.
    static constexpr Nanoseconds kSuspicion{60'000'000'000};
    /// Maximum hold after capture: shorter than the delay of a map that takes readings in order of capture.
    static constexpr Nanoseconds kHeldMax{240'000'000};

    /// Call after `on_arrival`, for a reading that cannot be checked: its node is not usable, or its time is
    /// unknown. Its number is still compared and recorded. Otherwise, a second sender that causes the node's
    /// readings to be refused could send its own under their numbers. Returns the fault of its number.
    /// `now`: empty while unknown; then nothing is compared.
    [[nodiscard]] std::optional<ReadingReason> skip(wire::NodeId node, const wire::RangeReading& reading,
                                                    std::optional<HostTime> now);

    /// `now`: empty while unknown.
    void on_health(wire::NodeId node, const wire::SensorHealth& health,
                   std::optional<HostTime> now = std::nullopt);
    /// True if, by its node's newest report, the capture times alone are within the rig's limit.
    [[nodiscard]] bool is_certain(wire::NodeId node, std::uint8_t sensor) const {
        return is_certain(sensors_.at({node, sensor}), MappedTime{});
    }
    void on_signal(wire::NodeId node, std::uint8_t sensor, const wire::SignalReading& signal);
    /// Counted in every state of the node, because a REFLEX does not affect the map.
    void on_reflex(wire::NodeId node, const wire::Reflex& reflex);
    /// The node was not usable until now, or the host time has jumped: data of its sensors are expected from
    /// now on.
    void expect(wire::NodeId node, std::optional<HostTime> now);
    /// The node restarted: clears its sequences, its counts and its reports.
    void forget(wire::NodeId node);
    /// The times of the newest readings were wrong: clears the order of the readings.
    void forget_order(wire::NodeId node);
    /// An exchange with the node agrees with earlier ones: its clock continues.
    void on_clock_confirmed(wire::NodeId node);
    /// An exchange disagrees: readings refused for their time do not show a second sender.
    void on_clock_contradicted(wire::NodeId node);
    /// The node's newest heartbeat: its sensors range at another period than configured (`is_overridden`), or
    /// as configured. An override counts once all heartbeats of a second have reported it. A single heartbeat
    /// may come from a second sender, whose readings would then fit between those of a slow sensor.
    void on_rate(wire::NodeId node, bool is_overridden, std::optional<HostTime> now);
    static constexpr Nanoseconds kOverriddenFor{1'000'000'000};

    /// A frame under this node's id had a wrong checksum.
    void on_damage(wire::NodeId node, HostTime now);

    [[nodiscard]] const SensorRecord& record(wire::NodeId node, std::uint8_t sensor) const {
        return sensors_.at({node, sensor}).record;
    }
    [[nodiscard]] const SenderWatch& senders(wire::NodeId node, std::uint8_t sensor) const {
        return sensors_.at({node, sensor}).senders;
    }

  private:
    struct Sensor {
        explicit Sensor(const HostSensor& sensor);
        HostSensor expected;
        SensorRecord record;
        SaidNumbers said;
        Cadence cadence;
        SenderWatch senders;
    };
    template <class Do>
    void for_each_of(wire::NodeId node, const Do& act) {
        for (auto& [id, sensor] : sensors_)
            if (id.node_id == node) act(sensor);
    }
    /// One reading, with everything that its place depends on.
    struct Arrival {
        wire::NodeId node = 0;
        const wire::RangeReading& reading;
        HostTime captured;
        HostTime now;
        bool is_clock_questioned = false;
    };
    [[nodiscard]] bool is_certain(const Sensor& sensor, const MappedTime& captured) const;
    [[nodiscard]] Nanoseconds spacing_min(const Sensor& sensor, wire::NodeId node, HostTime now) const;
    [[nodiscard]] std::optional<ReadingReason> place_fault(Sensor& sensor, const Arrival& arrival);
    [[nodiscard]] std::optional<ReadingReason> number_fault(Sensor& sensor, wire::NodeId node,
                                                            const wire::RangeReading& reading, HostTime now);
    void note_misplaced(Sensor& sensor, const Arrival& arrival, SequenceFault fault);
    void on_contradiction(Sensor& sensor, wire::NodeId node, HostTime now);
    [[nodiscard]] std::optional<ReadingReason> figure_fault(double range_m, double sigma_m) const;

    HostRangeLimits limits_;
    bool uses_no_return_;
    Nanoseconds now_early_;
    SensorTable<Sensor> sensors_;
    /// The time since which all heartbeats have reported an override.
    std::map<wire::NodeId, HostTime> rate_overridden_since_;
    /// The time of the newest contradiction of any of the node's sensors.
    std::map<wire::NodeId, HostTime> contradicted_;
};

}  // namespace octoskin
