// Measures the offset of a sensor, or the crosstalk of its cover glass, from 50 ranges to a target at a known
// distance. Method: ST's ULD 3.5.2 (VL53L1X_CalibrateOffset, _CalibrateXtalk; UM2510 section 4), without its
// waits and its 16-bit overflows. The results have the units of `Settings`; a rig file holds them as
// device_offset_mm and crosstalk_kcps.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/drivers/vl53l1x/device.hpp"

namespace octoskin::vl53l1x {

enum class CalibrationError : std::uint8_t {
    device,              ///< an operation of the device failed; see its `error()`
    unsupported_target,  ///< 0, or beyond `CalibrationRun::kTargetMax_mm`
    no_result,           ///< no range for 2 s, or for 3 periods if that is longer
    no_target,           ///< too many ranges without a valid result
    out_of_range,        ///< the offset exceeds its 13 bits, or the crosstalk 127 kcps
};

/// Calibrates one device, which must be configured and stopped. Calibrate the offset before the crosstalk. No
/// call waits; not thread-safe. A run ends within 60 ranges; each range may take 2 s, or 3 periods if that is
/// longer. An implausible read is dropped and repeated, at most `kReadsDroppedMax` times. After success the
/// sensor ranges with the new value, after a failure with 0.
class CalibrationRun {
  public:
    static constexpr std::uint16_t kTargetMax_mm = 4'000;
    static constexpr std::uint8_t kRanges = 50;
    static constexpr std::uint8_t kRangesInvalidMax =
        10;  ///< the first range, without wrap check, is not counted
    static constexpr std::uint8_t kReadsDroppedMax = 10;

    /// `period`: time between the ranges of the device, as configured.
    CalibrationRun(Device& device, Microseconds period) noexcept;

    [[nodiscard]] static constexpr bool is_target_supported(std::uint16_t target_mm) noexcept {
        return target_mm > 0 && target_mm <= kTargetMax_mm;
    }

    /// UM2510: a grey target (17 %) at 140 mm, in the dark. `target_mm`: distance from the front of the
    /// sensor.
    void begin_offset(std::uint16_t target_mm);
    /// UM2510: a grey target (17 %) at the distance where ranges begin to be too short, in the dark.
    /// Crosstalk cannot lengthen a range: if the ranges are too long, the result is 0.
    void begin_crosstalk(std::uint16_t target_mm);

    /// Ends the run without a result, for a device that is or will be abandoned.
    void abandon() noexcept;

    /// As `Device::poll`. During a run, do not poll the device itself.
    [[nodiscard]] Progress poll(NodeTime now);
    [[nodiscard]] CalibrationError error() const noexcept { return error_; }
    /// The earliest time at which `poll` has work to do; empty: as soon as the bus is free.
    [[nodiscard]] std::optional<NodeTime> wake_time() const noexcept {
        return resume_at_ ? resume_at_ : device_.wake_time();
    }

    /// Valid after `done`. The value that was not calibrated is 0.
    [[nodiscard]] std::int16_t offset_quarter_mm() const noexcept { return offset_quarter_mm_; }
    [[nodiscard]] std::uint16_t crosstalk_raw() const noexcept { return crosstalk_raw_; }

  private:
    enum class Quantity : std::uint8_t { offset, crosstalk };
    enum class Step : std::uint8_t {
        zeroing,
        checking,
        starting,
        ranging,
        checking_again,
        stopping,
        applying
    };

    void begin(Quantity quantity, std::uint16_t target_mm);
    void start_step(Step step);
    [[nodiscard]] Progress on_step_done(NodeTime now);
    [[nodiscard]] Progress on_range(NodeTime now);
    [[nodiscard]] bool drops_read() noexcept;
    [[nodiscard]] Progress pause(NodeTime now);
    void write(std::int16_t offset_quarter_mm, std::uint16_t crosstalk_raw);
    [[nodiscard]] bool add(const Measurement& measurement) noexcept;
    [[nodiscard]] bool compute() noexcept;
    [[nodiscard]] Progress stop_and_fail(CalibrationError error);
    [[nodiscard]] Progress end(Progress progress) noexcept;

    Device& device_;
    Microseconds range_within_;
    Quantity quantity_ = Quantity::offset;
    std::uint16_t target_mm_ = 0;
    Step step_ = Step::zeroing;
    Progress progress_ = Progress::idle;
    bool has_failed_ = false;
    bool has_waited_ = false;
    NodeTime last_result_{};
    std::optional<NodeTime> resume_at_;  ///< time of the next poll for a range

    std::uint8_t ranges_ = 0;
    std::uint8_t ranges_invalid_ = 0;
    std::uint8_t reads_dropped_ = 0;
    std::uint8_t stream_last_ = 0;
    std::int64_t range_sum_mm_ = 0;
    std::int64_t signal_sum_ = 0;  ///< 9.7 Mcps
    std::int64_t spads_sum_ = 0;   ///< 8.8

    CalibrationError error_ = CalibrationError::device;
    std::int16_t offset_quarter_mm_ = 0;
    std::uint16_t crosstalk_raw_ = 0;
};

}  // namespace octoskin::vl53l1x
