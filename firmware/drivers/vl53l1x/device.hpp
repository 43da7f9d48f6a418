// The VL53L1X driver: a state machine without waits. The caller begins an operation, then polls until it is
// done or has failed. Each poll starts at most one transfer, and only if the bus is free, so any number of
// devices share a bus. method.hpp defines each operation as a table; device.cpp runs the tables.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/time.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"
#include "firmware/drivers/vl53l1x/default_configuration.hpp"
#include "firmware/drivers/vl53l1x/measurement.hpp"
#include "firmware/drivers/vl53l1x/options.hpp"
#include "firmware/drivers/vl53l1x/read_back.hpp"
#include "firmware/drivers/vl53l1x/registers.hpp"
#include "firmware/drivers/vl53l1x/result_block.hpp"
#include "firmware/drivers/vl53l1x/settings.hpp"
#include "firmware/drivers/vl53l1x/timing.hpp"

namespace octoskin::vl53l1x {

inline constexpr i2c::Address kDefaultAddress = 0x29;

enum class Progress : std::uint8_t { idle, busy, done, failed };

/// One sensor. Not thread-safe; no call waits. One operation at a time: precondition of every `begin_...` is
/// not busy. Every operation ends (done or failed) within its stated time if `poll` is called at least every
/// millisecond and the bus is free. A failed transfer is repeated once; the second failure ends the
/// operation. The stated times hold for 400 kHz and a working bus.
class Device {
  public:
    /// `bus` must outlive the device.
    Device(i2c::Bus& bus, const Options& options) noexcept
        : bus_(bus), options_(options), read_back_(*options.verification) {}
    // A transfer in flight points into the device.
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    // --- bring-up
    /// Reads the identification at `address`, which becomes the live address. <= 5 ms.
    void begin_probe(i2c::Address address);
    /// Writes the new address, then reads the identification there. <= 10 ms.
    void begin_set_address(i2c::Address address);
    /// Resets the sensor without XSHUT. The sensor loses all settings, including its address, and returns to
    /// 0x29, where the identification is checked. No other device may be at 0x29. <= 500 ms, typically 3 ms.
    void begin_soft_reset();
    /// Waits at 0x29 for the end of the firmware's boot: <= 5 ms, or <= 100 ms if `is_patient`. Fails with
    /// `boot_timeout` after that. Is `done`, too, if no device answers: the probe that follows detects that.
    void begin_await_boot_at_default(bool is_patient);
    /// Waits for the end of the firmware's boot, <= 500 ms. Tests bit 0 of the status only, since real
    /// sensors first answer 0x02.
    void begin_await_boot();
    /// Writes the default configuration and starts the first range, without waiting for boot. <= 10 ms in
    /// bursts, 100 ms otherwise.
    void begin_load_configuration();
    /// Waits for the end of the boot, reads the factory offset if the options request it, and loads the
    /// configuration. Ends when the first range has started. `begin_finish_initialise` collects that range
    /// about 100 ms later, so that many sensors range at the same time.
    void begin_initialise();
    /// Waits for the first data (<= 1 s), clears the interrupt, stops, and bounds the VHV search.
    void begin_finish_initialise();

    // --- settings, while stopped. An operation whose argument breaks a limit fails with `unsupported_config`
    // and writes nothing.
    /// Stops, and applies all settings in ST's order: mode, budget, period, ROI, limits, offset, crosstalk.
    /// Later measurements have the gain factor applied if the settings request it. <= 20 ms.
    void begin_configure(const Settings& settings);
    /// The budget does not change; the new mode must support it.
    void begin_set_distance_mode(DistanceMode mode);
    void begin_set_timing_budget(std::uint16_t budget_ms);
    /// Writes `nominal * 1.075` in units of the sensor's oscillator. Also used to correct the period after it
    /// was measured, in finer steps than the milliseconds of `Settings`. For that reason the period is not
    /// checked against the budget.
    void begin_set_inter_measurement(Microseconds nominal);
    void begin_set_sigma_limit(std::uint16_t quarter_mm);
    void begin_set_signal_limit(std::uint16_t mcps_9_7);
    void begin_set_offset(std::int16_t quarter_mm);
    void begin_set_crosstalk(std::uint16_t kcps_per_spad_7_9);
    void begin_set_interrupt_polarity(bool is_active_low);
    /// Interrupts only for ranges in a window. Whether the window also gates the results is not documented.
    void begin_set_range_threshold(const RangeThreshold& threshold);
    /// Interrupts for every sample again, as after initialising.
    void begin_set_interrupt_on_every_sample();
    /// ST's SetROI: sets the size. The centre becomes the sensor's own optical centre, or SPAD 199 for a side
    /// over 10.
    void begin_set_roi_size(std::uint8_t width, std::uint8_t height);
    void begin_set_roi_centre(std::uint8_t spad);
    /// Writes the centre and, if it changed, the size of the region of interest. Allowed while ranging: takes
    /// effect with the next range. One transfer; two for a new size without bursts.
    void begin_set_zone(const Roi& roi);

    // --- ranging
    /// Clears the interrupt, then starts timed ranging.
    void begin_start();
    /// Clears the interrupt, then starts one range.
    void begin_start_single();
    /// Stops after the current range: one more result may follow.
    void begin_stop();
    /// Stops at once.
    void begin_abort();
    /// Polls data ready once. If ready, reads the result block (twice if the options say so) and clears the
    /// interrupt. Done with or without a measurement: see `has_measurement`. <= 5 ms.
    /// `confirms_ready`: a positive poll is repeated, to detect a bit flipped on the bus. Needed where no
    /// other check exists: for the first result of a run, and while the time of data ready is not well known.
    void begin_read(bool confirms_ready = false);
    /// In the last `begin_read`, the first poll found data and the repeated poll did not: one of the two
    /// answers was altered on the bus.
    [[nodiscard]] bool have_polls_disagreed() const noexcept { return have_polls_disagreed_; }
    /// From a `begin_read` with `confirms_ready` until a positive poll has been repeated. Meanwhile the time
    /// of data ready is uncertain.
    [[nodiscard]] bool is_confirming_ready() const noexcept { return is_confirming_ready_; }
    /// Ranges once with a full search of the VHV voltage, for a sensor that was stopped while its temperature
    /// changed by more than 8 degrees. <= 1 s + one period; only while stopped.
    void begin_update_temperature();
    /// Reads 1 <= count <= 4 bytes at `index`, for supervision. Result: `register_bytes()`.
    void begin_read_register(reg::Index index, std::uint8_t count);

    // --- supervision
    /// Reads back one of `kRegisterRuns`. Compares it with the values written since the configuration was
    /// loaded and with the factory offset; registers never written are recorded. A difference is read again.
    /// If it persists, the operation fails with `config_mismatch`: initialise the sensor. Allowed while
    /// ranging. <= 3 ms: one transfer, two if it differs, none if the verification is off.
    void begin_verify(std::size_t run);
    /// As `begin_verify`, for the registers of the last `begin_set_zone`.
    void begin_verify_zone();

    // --- progress
    /// Advances the operation. `done` and `failed` are returned once, then `idle`.
    [[nodiscard]] Progress poll(NodeTime now);
    /// Ends the operation without a result, for a sensor that was taken away. Precondition: no transfer in
    /// flight.
    void abandon() noexcept { progress_ = Progress::idle; }
    /// From `begin_...` until `poll` has returned the end.
    [[nodiscard]] bool is_busy() const noexcept { return progress_ != Progress::idle; }
    /// Valid after `failed`.
    [[nodiscard]] Error error() const noexcept { return error_; }
    /// Reason of the last failed transfer.
    [[nodiscard]] i2c::TransferError transfer_error() const noexcept { return transfer_error_; }
    /// The earliest time at which `poll` has work to do; empty: as soon as the bus is free.
    [[nodiscard]] std::optional<NodeTime> wake_time() const noexcept;

    // --- results; a failed operation changes none of them
    /// The last `begin_read` succeeded and found data ready.
    [[nodiscard]] bool has_measurement() const noexcept { return has_measurement_; }
    /// The newest measurement; `has_measurement` says whether the last read delivered it.
    [[nodiscard]] const Measurement& measurement() const noexcept { return reading_.measurement; }
    /// Time at which the answer of the poll that found data was collected. The data was ready no later than
    /// this.
    [[nodiscard]] NodeTime ready_seen() const noexcept { return reading_.ready_seen; }
    /// The latest time at which the data was certainly not ready: the start of the transfer that found no
    /// data, or that cleared the interrupt. Empty if there was no such transfer.
    [[nodiscard]] std::optional<NodeTime> not_ready_seen() const noexcept { return reading_.not_ready_seen; }
    /// Expected register values, and the differences found.
    [[nodiscard]] const ReadBack& read_back() const noexcept { return read_back_; }
    /// Call after the verification was extended to ignore more differences.
    void forget_overlooked() noexcept { read_back_.forget_overlooked(); }
    /// Bytes of the last `begin_read_register`.
    [[nodiscard]] std::span<const std::uint8_t> register_bytes() const noexcept {
        return std::span(register_bytes_).first(register_count_);
    }
    /// Whether measurements have the gain factor applied.
    [[nodiscard]] bool applies_gain_factor() const noexcept { return settings_.applies_gain_factor; }
    /// Change of the period per step of the inter-measurement register; empty before a period was set.
    [[nodiscard]] std::optional<Nanoseconds> period_step() const noexcept {
        return vl53l1x::period_step(oscillator_);
    }
    [[nodiscard]] i2c::Address live_address() const noexcept { return live_address_; }
    /// Failed transfers, including retried ones, and read-backs contradicted by the second read. Saturates.
    [[nodiscard]] std::uint16_t i2c_error_count() const noexcept { return i2c_error_count_; }

  private:
    /// How the operation continues after the answer to a transfer.
    enum class NextStep : std::uint8_t { proceed, repeat_stage, end };
    using Judge = NextStep (*)(Device&, NodeTime now);

    /// One transfer, or a run of equal transfers at consecutive indices.
    struct Step {
        enum class Kind : std::uint8_t { read, write, write_defaults };
        Kind kind = Kind::read;
        reg::Index index = 0;
        std::uint8_t count = 0;      ///< bytes per transfer
        std::uint8_t transfers = 1;  ///< the index increases by one per transfer
        std::array<std::uint8_t, 4> bytes{};
        Judge judge = nullptr;  ///< evaluates the last answer; none: proceed
        /// Decides how to continue if the address is not acknowledged, where that is not an error. `proceed`:
        /// try again. None: a failure like any other.
        Judge on_refused = nullptr;
    };

    /// A named part of an operation. `line_up` queues its transfers when the stage begins. If a judge returns
    /// `repeat_stage`, the stage is repeated every `every_us`. After `within_us` the operation fails with the
    /// error `otherwise`.
    struct Stage {
        void (*line_up)(Device&) = nullptr;
        std::uint32_t every_us = 0;
        std::uint32_t within_us = 0;
        Error otherwise = Error::not_ready;
    };
    struct Method;  // method.hpp: all stages, judges and tables

    struct Reading {
        Measurement measurement;
        NodeTime ready_seen{};
        std::optional<NodeTime> not_ready_seen;
    };

    // Running the tables (device.cpp).
    void begin(std::span<const Stage> stages);
    void begin_refused();
    void proceed(NodeTime now);
    void enter_stage(NodeTime now);
    void repeat_stage(NodeTime now);
    void submit(NodeTime now);
    [[nodiscard]] i2c::Transfer compose(const Step& step);
    void collect(NodeTime now);
    void on_transfer_done(NodeTime now);
    void on_transfer_failed(i2c::TransferError error, NodeTime now);
    void follow(NextStep verdict, NodeTime now);
    void count_i2c_error() noexcept;
    NextStep fail(Error error);

    // For the stages.
    void line_up(const Step& step);
    void read(reg::Index index, std::uint8_t count, Judge judge);
    void write8(reg::Index index, std::uint8_t value, Judge judge = nullptr);
    void write16(reg::Index index, std::uint16_t value, Judge judge = nullptr);
    void write32(reg::Index index, std::uint32_t value);
    [[nodiscard]] std::uint16_t answer16() const;
    [[nodiscard]] ResultBlock answered_block() const;

    static constexpr std::size_t kIndexBytes = 2;
    static constexpr std::size_t kStepsMax = 8;

    i2c::Bus& bus_;
    Options options_;

    // The operation.
    std::span<const Stage> stages_;
    std::size_t stage_ = 0;  ///< index of the next stage
    NodeTime stage_deadline_{};
    std::optional<NodeTime> resume_at_;
    std::array<Step, kStepsMax> steps_{};
    std::size_t step_count_ = 0;
    std::size_t step_ = 0;
    std::uint8_t transfers_done_ = 0;  ///< of the current step
    bool was_retried_ = false;
    Progress progress_ = Progress::idle;
    Error error_ = Error::no_answer;

    // The transfer.
    bool is_in_flight_ = false;
    NodeTime submitted_{};
    NodeTime transfer_deadline_{};
    std::optional<NodeTime> bus_awaited_since_;
    i2c::TransferError transfer_error_ = i2c::TransferError::timeout;
    std::array<std::uint8_t, kIndexBytes + kDefaultConfiguration.size()> sent_{};
    std::array<std::uint8_t, kRunBytesMax> answer_{};
    static_assert(ResultBlock{}.size() <= kRunBytesMax);

    // State of the sensor.
    i2c::Address live_address_ = kDefaultAddress;
    std::uint16_t i2c_error_count_ = 0;
    ReadBack read_back_;
    DistanceMode mode_ = DistanceMode::long_range;
    std::uint16_t budget_ms_ = 0;
    std::optional<Roi> written_roi_;
    bool is_active_low_ = true;
    bool is_confirming_ready_ = false;
    bool have_polls_disagreed_ = false;
    std::optional<NodeTime> not_ready_seen_;

    // Arguments and intermediate results of the operation.
    Settings settings_;
    Microseconds period_{0};
    std::uint16_t oscillator_ = 0;
    Roi roi_;
    RangeThreshold threshold_;
    std::uint8_t mode_start_ = 0;
    i2c::Address new_address_ = kDefaultAddress;
    bool is_polarity_low_ = true;
    reg::Index register_index_ = 0;
    std::uint8_t register_bytes_wanted_ = 0;
    ResultBlock block_{};
    NodeTime ready_seen_{};
    bool has_read_again_ = false;
    RegisterRun run_;               ///< the run being verified
    bool is_run_of_write_ = false;  ///< the run is that of the write just made
    bool is_run_steering_ = false;  ///< the run is a whole steering group

    // Results.
    bool has_measurement_ = false;
    Reading reading_;
    std::array<std::uint8_t, 4> register_bytes_{};
    std::uint8_t register_count_ = 0;
};

}  // namespace octoskin::vl53l1x
