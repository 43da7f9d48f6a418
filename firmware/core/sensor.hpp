// The life of one sensor: brought up, ranging, stopped by order, or in recovery after a failure; and what the
// node reports about it.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/bring_up.hpp"
#include "firmware/core/bus_use.hpp"
#include "firmware/core/calibration.hpp"
#include "firmware/core/default_address.hpp"
#include "firmware/core/phase_clock.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/core/ranging.hpp"
#include "firmware/core/reading.hpp"
#include "firmware/core/recovery.hpp"
#include "firmware/drivers/vl53l1x/calibration.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

/// The surroundings that a sensor needs; all of them outlive the sensor.
struct SensorSurroundings {
    i2c::Bus& bus;
    DefaultAddress& default_address;
    XshutLines& xshut;
    const PhaseClock& clock;
};

/// Since start; on the wire they are modulo or saturated.
struct SensorCounts {
    std::uint32_t rejected = 0;         ///< results that did not become readings, for any reason
    std::uint32_t reads_disagreed = 0;  ///< of these: the two reads never agreed
    std::uint32_t undated = 0;          ///< of these: time or zone not known well enough
    std::uint32_t withheld = 0;  ///< of these: a register that decides the range does not keep its value
    std::uint32_t suspect = 0;   ///< readings sent while a register may have been wrong
    std::uint32_t restarts = 0;  ///< attempts to recover it
};

class Sensor {
  public:
    Sensor(const SensorConfig& config, const SensorSurroundings& surroundings,
           const vl53l1x::Options& options, const RangingRules& rules, const Policy& policy, NodeTime now);
    Sensor(const Sensor&) = delete;
    Sensor& operator=(const Sensor&) = delete;

    // --- orders; they take effect once the transfers under way have ended
    /// After a long rest the sensor is brought up again: a part follows its temperature only while it ranges.
    void order_start(NodeTime now);
    void order_stop(NodeTime now);
    void order_reinitialise(NodeTime now);
    /// The verification of the node's sensors overlooks more than before. A sensor that failed or was
    /// withheld only for this reason is brought up, or ranges, at once.
    void on_overlooking_more(NodeTime now);
    /// Brings the sensor up, calibrates it, and brings it up again as configured: nothing of the calibration
    /// is kept. False if the driver refuses the target, if its readings are withheld, or if a calibration is
    /// already ordered.
    [[nodiscard]] bool order_calibration(const CalibrationOrder& order, NodeTime now);
    /// Empty: the configured period. False, and nothing is changed, if the period does not fit the timing
    /// budget.
    [[nodiscard]] bool order_period(std::optional<Microseconds> period, NodeTime now);

    // --- work
    /// The bus's data-ready line fell, perhaps for this sensor.
    void on_hint(NodeTime now) noexcept {
        if (mode_ == Mode::ranging) ranging_.on_hint(now);
    }
    /// Whether it ranges without being read by hints: while it is brought up or calibrated. Its data also
    /// pulls the line.
    [[nodiscard]] bool ranges_unasked() const noexcept {
        return mode_ == Mode::bringing_up || mode_ == Mode::calibrating;
    }
    /// Whether a hint was followed and data was there; true once.
    [[nodiscard]] bool take_confirmation() noexcept { return ranging_.take_confirmation(); }
    /// When the bus is needed; empty while there is nothing to wait for. Called for every sensor in every
    /// turn.
    [[nodiscard]] std::optional<NodeTime> due() const noexcept {
        const bool is_only_ranging = mode_ == Mode::ranging && !reinitialise_ordered_;
        return is_only_ranging ? ranging_.due() : due_otherwise();
    }
    /// When it is due for something that must not come late; empty if it is due for something else, or for
    /// nothing. Called for every sensor in every turn.
    [[nodiscard]] std::optional<NodeTime> deadline_due() const noexcept {
        if (mode_ != Mode::ranging) return std::nullopt;
        return ranging_.deadline_due();
    }
    /// Whether it must be punctual for its start.
    [[nodiscard]] bool awaits_start() const noexcept { return ranging_.awaits_start(); }
    /// Whether what it is due for can wait while others must be punctual.
    [[nodiscard]] bool is_deferrable(NodeTime now) const noexcept {
        return mode_ == Mode::ranging && ranging_.is_early(now);
    }
    /// Whether a sensor that must be punctual may come between its transfers.
    [[nodiscard]] bool is_preemptible() const noexcept { return ranging_.is_preemptible(); }
    /// One step, while the bus is free or used by this sensor's own transfer.
    [[nodiscard]] BusUse advance(NodeTime now);
    /// The reading that the last step accepted; returned once.
    [[nodiscard]] std::optional<Reading> take_reading() noexcept {
        return reading_ ? std::exchange(reading_, std::nullopt) : std::nullopt;
    }
    /// How the ordered calibration ended; returned once.
    [[nodiscard]] std::optional<CalibrationResult> take_calibration() noexcept;
    /// Whether it failed for the first time, or after it had worked; true once.
    [[nodiscard]] bool take_failure() noexcept { return std::exchange(has_failed_, false); }
    /// Whether the last failure may be one of the whole bus; true once.
    [[nodiscard]] bool take_bus_suspicion() noexcept;

    /// Puts the sensor in reset, whatever its state, because a device holds the bus; no transfer may be in
    /// flight. The sensor counts as failed, and comes back through XSHUT once it is advanced again. Call this
    /// at every failed attempt to free the bus, at least every 35 minutes.
    void isolate(NodeTime now);

    // --- health
    [[nodiscard]] wire::SensorState state() const noexcept { return state_; }
    [[nodiscard]] wire::SensorFault fault() const noexcept { return fault_; }
    /// Not ranging as configured, though it should, except while it is brought up by order or for the first
    /// time. Also while a register does not keep its value.
    [[nodiscard]] bool is_degraded() const noexcept;
    /// Whether its first bring-up has ended, successfully or not.
    [[nodiscard]] bool is_settled() const noexcept { return is_settled_; }
    [[nodiscard]] i2c::Address address() const noexcept { return config_.address; }
    [[nodiscard]] bool is_period_overridden() const noexcept { return is_period_overridden_; }
    [[nodiscard]] bool is_ordered_to_range() const noexcept { return is_ordered_to_range_; }
    [[nodiscard]] std::int32_t period_error_permille() const noexcept {
        return ranging_.period_error_permille();
    }
    /// The register to report: one that does not keep its value, or the newest that differed in three or more
    /// attempts in a row, alike or not. Empty if there is none.
    [[nodiscard]] std::optional<vl53l1x::RegisterDifference> register_to_report() const noexcept;
    /// What a person at the node is shown of a degraded sensor.
    struct Trouble {
        wire::SensorFault fault = wire::SensorFault::none;
        std::optional<vl53l1x::RegisterDifference> difference;
        friend constexpr bool operator==(const Trouble&, const Trouble&) = default;
    };
    [[nodiscard]] std::optional<Trouble> trouble() const noexcept {
        if (!is_degraded()) return std::nullopt;
        return Trouble{.fault = fault_, .difference = register_to_report()};
    }
    /// Whether it was ever given its address before the end of its boot.
    [[nodiscard]] bool was_boot_late() const noexcept { return bring_up_.was_boot_late(); }
    [[nodiscard]] const SensorCounts& counts() const noexcept { return counts_; }
    [[nodiscard]] const vl53l1x::ReadBack& read_back() const noexcept { return device_.read_back(); }
    [[nodiscard]] std::uint16_t i2c_error_count() const noexcept { return device_.i2c_error_count(); }

  private:
    enum class Mode : std::uint8_t { bringing_up, calibrating, ranging, stopped, awaiting_recovery };

    [[nodiscard]] BusUse advance_bring_up(NodeTime now);
    [[nodiscard]] BusUse advance_calibrating(NodeTime now);
    [[nodiscard]] BusUse advance_ranging(NodeTime now);
    void begin_calibration(NodeTime now);
    void end_calibration(const CalibrationResult& result);
    void begin_bring_up(NodeTime now);
    void range_or_rest(NodeTime now);
    void on_result(NodeTime now);
    void on_reading();
    void on_refused();
    void on_withheld();
    void on_undated(NodeTime now);
    void give_up_ranging(wire::SensorFault fault, NodeTime now);
    void on_failure(wire::SensorFault fault, bool can_restart, NodeTime now);
    void recover(NodeTime now);
    [[nodiscard]] std::optional<NodeTime> due_otherwise() const noexcept;
    [[nodiscard]] bool is_reinitialisation_due() const noexcept;

    const SensorConfig& config_;
    const Policy& policy_;
    vl53l1x::Device device_;
    BringUp bring_up_;
    Ranging ranging_;
    Recovery recovery_;

    vl53l1x::CalibrationRun calibration_;
    std::optional<CalibrationOrder> calibration_ordered_;
    std::optional<CalibrationResult> calibration_result_;
    NodeTime calibration_due_;

    Mode mode_ = Mode::bringing_up;
    RecoveryPlan plan_;
    bool is_ordered_to_range_ = true;
    std::optional<NodeTime> reinitialise_ordered_;
    NodeTime rest_due_;             ///< when a rest becomes long, or when an order ended a long rest
    bool has_rested_long_ = false;  ///< its temperature may have changed; recorded before the clock wraps
    bool is_period_overridden_ = false;

    wire::SensorState state_ = wire::SensorState::starting;
    wire::SensorFault fault_ = wire::SensorFault::none;
    bool is_settled_ = false;
    bool has_ever_answered_ = false;
    bool is_bus_suspect_ = false;
    bool has_failed_ = false;
    std::uint8_t refused_in_row_ = 0;
    std::uint8_t hardware_fails_in_row_ = 0;
    std::uint8_t undated_in_row_ = 0;
    std::uint8_t mismatches_in_row_ = 0;  ///< attempts that ended with a register difference
    SensorCounts counts_;
    std::optional<Reading> reading_;
};

}  // namespace octoskin::node
