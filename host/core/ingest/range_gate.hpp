// The last check before a reading becomes a measurement: how certain its time is, its place in the sequence,
// its age, its status, its zone, its figures.
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

/// What is known of one sensor, for a person to read.
struct SensorRecord {
    std::uint64_t received = 0;                     ///< readings that came, each counted once
    std::optional<wire::RangeReading> newest;       ///< of those, whatever became of it
    Stretch arrivals;                               ///< of readings, without breaks (`break_after`)
    std::optional<ReadingReason> newest_rejected;   ///< why it was not accepted, or not put into the map
    FateHistory fates;                              ///< of the newest readings
    std::array<std::uint64_t, 32> device_status{};  ///< how often each code came
    SequenceTracker sequence;
    std::optional<wire::SensorHealth> health;
    std::optional<wire::SignalReading> signal;
    /// Bound on the error of its capture times, as the node told it last in its present life.
    std::optional<Nanoseconds> capture_bound;
    std::uint64_t reflexes = 0;          ///< times that something came closer than the sensor's limit
    std::optional<wire::Reflex> reflex;  ///< the newest
    SentCount sent;                      ///< and what of it was lost
    /// Its readings and SENSOR_HEALTH; begun when its node became usable (RangeGate::expect).
    Stretch words;
    static constexpr Nanoseconds kUnheardAfter{3'000'000'000};
    /// What was lost while nothing at all came is no sign of what is lost from here on.
    void note_word(std::optional<HostTime> now) noexcept {
        const auto& before = words.newest();
        if (!now || !before || *now - *before > kUnheardAfter) sent.forget_steps();
        words.note(now, kUnheardAfter);
    }
    /// Of a sensor of this period, configured, the readings do not come while none does for so long.
    [[nodiscard]] static constexpr Nanoseconds break_after(Nanoseconds period) noexcept {
        return std::max(Nanoseconds{500'000'000}, 2 * period);
    }
};

class RangeGate {
  public:
    /// `uses_no_return`: beams without return may clear space; if not, they are rejected here. `now_early`:
    /// "now" may be this much behind (ClockMapConfig::now_slack).
    explicit RangeGate(const HostRig& rig, bool uses_no_return,
                       Nanoseconds now_early = ClockMapConfig{}.now_slack);

    [[nodiscard]] bool knows(wire::NodeId node, std::uint8_t sensor) const {
        return sensors_.contains({node, sensor});
    }
    /// Any reading of a known sensor, whatever becomes of it.
    void on_arrival(wire::NodeId node, const wire::RangeReading& reading, std::optional<HostTime> now);
    /// What became of the newest reading, at this gate or before it.
    void on_fate(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected);
    /// What became of a reading that was accepted here.
    void on_fate_in_map(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected);
    /// After `on_arrival`, for a reading whose node is usable and whose time is known.
    /// `is_clock_questioned`: others of its node have impossible times, so that it must show by its own that
    /// the clock goes on.
    [[nodiscard]] Result<RangeMeasurement, ReadingReason> check(wire::NodeId node,
                                                                const wire::RangeReading& reading,
                                                                const MappedTime& captured, HostTime now,
                                                                bool is_clock_questioned = false);

    /// Until when a reading that was accepted has to wait, because a second sender may speak under its node's
    /// name: until its true twin would have come. Empty: not at all.
    [[nodiscard]] std::optional<HostTime> held_until(const RangeMeasurement& measurement, HostTime now) const;
    /// For so long after a contradiction the readings of its node wait.
    static constexpr Nanoseconds kSuspicion{60'000'000'000};
    /// No reading waits longer after its capture: less than a map in the order of capture waits for it.
    static constexpr Nanoseconds kHeldMax{240'000'000};

    /// After `on_arrival`, for a reading that cannot be checked: its node is not usable, or its time not
    /// known. Its number is compared and taken all the same: else another sender, that has the node's
    /// readings refused for what the node seems to tell, could send its own under their numbers. Returns what
    /// is wrong with its number. `now`: empty while unknown, and then there is nothing to compare by.
    [[nodiscard]] std::optional<ReadingReason> skip(wire::NodeId node, const wire::RangeReading& reading,
                                                    std::optional<HostTime> now);

    /// `now`: empty while unknown.
    void on_health(wire::NodeId node, const wire::SensorHealth& health,
                   std::optional<HostTime> now = std::nullopt);
    /// By what its node told last, its capture times alone are within what the rig allows.
    [[nodiscard]] bool is_certain(wire::NodeId node, std::uint8_t sensor) const {
        return is_certain(sensors_.at({node, sensor}), MappedTime{});
    }
    void on_signal(wire::NodeId node, std::uint8_t sensor, const wire::SignalReading& signal);
    /// Counted whoever the node is: it is for people and for arms, and does not touch the map.
    void on_reflex(wire::NodeId node, const wire::Reflex& reflex);
    /// The node was not usable so far, or "now" is another than before: what its sensors say is expected from
    /// here on.
    void expect(wire::NodeId node, std::optional<HostTime> now);
    /// The node began anew: its sequences, its counts, and what it told.
    void forget(wire::NodeId node);
    /// The times of the newest readings were wrong: their order says nothing.
    void forget_order(wire::NodeId node);
    /// An exchange with the node agrees with those before: its clock goes on.
    void on_clock_confirmed(wire::NodeId node);
    /// One does not: what was refused for its time was no second sender's.
    void on_clock_contradicted(wire::NodeId node);
    /// Its node's newest heartbeat: its sensors range at another period than configured, or as configured.
    /// The former counts once all heartbeats of a second have said so: one alone may be another sender's,
    /// which wants room for its readings between those of a slow sensor.
    void on_rate(wire::NodeId node, bool is_overridden, std::optional<HostTime> now);
    static constexpr Nanoseconds kOverriddenFor{1'000'000'000};

    /// A frame under this node's id did not fit its checksum.
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
    /// One reading, with all that its place depends on.
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
    std::map<wire::NodeId, HostTime> rate_overridden_since_;  ///< all heartbeats have said so
    std::map<wire::NodeId, HostTime> contradicted_;  ///< the newest contradiction of any of its sensors
};

}  // namespace octoskin
