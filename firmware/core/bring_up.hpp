// Brings one sensor from reset to configured. Sensors of a bus use the default address one after the other
// and do all the rest side by side, so that the 100 ms of the first range are waited for once:
//
//   XSHUT low >= 1 ms | 0x29 and its own address must be silent | XSHUT high, 2 ms | boot, 5 ms at most |
//   identify | new address, verified | 0x29 must be silent again ||
//   boot, default configuration, first range | collect it | settings | all of it read back
//
// A device that answers where all should be silent is parked (default_address.hpp), and the bring-up
// continues. If then no sensor answers when XSHUT rises, the parked device is this sensor: its line is stuck.
//
// ST AN5776 section 2.2 has the order up to the new address.
#pragma once

#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/bus_use.hpp"
#include "firmware/core/default_address.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::node {

class BringUp {
  public:
    enum class Outcome : std::uint8_t { under_way, done, failed };

    BringUp(vl53l1x::Device& device, DefaultAddress& default_address, XshutLines& xshut,
            const SensorConfig& config, const Policy& policy) noexcept;

    /// Puts the sensor in reset and begins. Not while the device is busy.
    void begin(NodeTime now);
    /// Puts the sensor in reset and keeps it there.
    void hold_in_reset();

    /// The verification overlooks more than before: a verification under way starts again.
    void on_overlooking_more() noexcept { is_verified_anew_ = step_ == Step::verifying; }

    /// When the bus is needed; empty while another sensor is at the default address, or if nothing is under
    /// way.
    [[nodiscard]] std::optional<NodeTime> due() const noexcept;
    /// One step, while the bus is free or used by this sensor's own transfer.
    [[nodiscard]] BusUse advance(NodeTime now);

    [[nodiscard]] Outcome outcome() const noexcept { return outcome_; }
    /// After `failed`.
    [[nodiscard]] wire::SensorFault fault() const noexcept { return fault_; }
    /// Whether the sensor, at any attempt, had not reported the end of its boot when it was given its
    /// address. Later attempts wait longer for it, since the end of the boot may take the address back.
    [[nodiscard]] bool was_boot_late() const noexcept { return was_boot_late_; }
    /// Whether the sensor identified itself in this attempt.
    [[nodiscard]] bool has_answered() const noexcept { return has_answered_; }

  private:
    enum class Step : std::uint8_t {
        idle,
        held_low,
        checking_silence,
        checking_own_address,
        parking,
        checking_parked,
        booting,
        awaiting_boot,
        identifying,
        addressing,
        confirming_silence,
        initialising,
        collecting,
        configuring,
        verifying,
    };

    [[nodiscard]] vl53l1x::Device& active_device() noexcept;
    [[nodiscard]] bool is_watching() const noexcept;
    void on_any_answer(NodeTime now);
    void on_silence(NodeTime now);
    void on_no_answer();
    void start_step(Step step, NodeTime now);
    void on_step_done(NodeTime now);
    void on_step_failed(vl53l1x::Error error, NodeTime now);
    void on_run_verified(NodeTime now);
    void fail(wire::SensorFault fault);

    vl53l1x::Device& device_;
    DefaultAddress& default_address_;
    XshutLines& xshut_;
    const SensorConfig& config_;
    const Policy& policy_;

    Step step_ = Step::idle;
    NodeTime step_due_;
    Outcome outcome_ = Outcome::under_way;
    wire::SensorFault fault_ = wire::SensorFault::none;
    bool has_answered_ = false;
    bool was_boot_late_ = false;
    std::size_t run_ = 0;  ///< the run of registers that is being read back
    bool is_mismatched_ = false;
    bool is_verified_anew_ = false;

    Step parked_from_ = Step::idle;  ///< the check that found a device
    std::uint8_t parkings_ = 0;      ///< in this attempt
    bool is_known_stuck_ = false;    ///< answered at its own address while XSHUT was low; parked since
    std::uint32_t cleared_ = 0;      ///< parkings on the bus when this sensor last came up with XSHUT
};

}  // namespace octoskin::node
