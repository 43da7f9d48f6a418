// The VL53L1X driver: a state machine that never waits. An operation is begun, then polled until it is done
// or has failed; each poll starts at most one transfer, and only if the bus is free, so any number of devices
// share a bus. method.hpp says what each operation does, as a table; device.cpp runs the tables.
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

/// One sensor. Not thread-safe; no call waits; every operation ends (done or failed) within a stated time if
/// `poll` is called at least every millisecond and the bus is free. One operation at a time: beginning one
/// while busy is a programmer's mistake. A transfer that fails is repeated once; the second failure ends the
/// operation. The times are for 400 kHz and a bus that works.
class Device {
  public:
    /// `bus` must outlive the device.
    Device(i2c::Bus& bus, const Options& options) noexcept
        : bus_(bus), options_(options), read_back_(*options.verification) {}
    // Transfers in flight point into the device.
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    // --- bring-up
    /// Reads the identification at `address` and remembers it as the live address. <= 5 ms.
    void begin_probe(i2c::Address address);
    /// Writes the new address at the live one, then reads the id back at the new address. <= 10 ms.
    void begin_set_address(i2c::Address address);
    /// Resets the part without XSHUT: it forgets everything, its address too, and is back at 0x29 with
    /// `probe`'s check passed. Nobody else may be at 0x29. <= 500 ms, about 3 ms.
    void begin_soft_reset();
    /// Waits at 0x29 for the firmware's boot, <= 5 ms, or if `is_patient` <= 100 ms: `boot_timeout` if it is
    /// not over by then. `done` also if nobody answers there: that is for whoever probes to say.
    void begin_await_boot_at_default(bool is_patient);
    /// Waits for the firmware's boot, <= 500 ms: bit 0 of the status, since real parts answer 0x02 first.
    void begin_await_boot();
    /// Writes the default configuration and starts the first range, without waiting for boot. <= 10 ms in
    /// bursts, 100 ms otherwise.
    void begin_load_configuration();
    /// Both of these, and the factory's offset read in between if so set. Ends once the first range is
    /// started: about 100 ms later it is collected by `begin_finish_initialise`, so that a fleet ranges at
    /// once.
    void begin_initialise();
    /// Waits for the first data ready (<= 1 s), clears, stops, sets the VHV loop bound and start.
    void begin_finish_initialise();

    // --- settings, while stopped; each fails with `unsupported_config` before anything is written if it
    // breaks a limit
    /// Stops, and applies all settings, in ST's order: mode, budget, period, ROI, limits, offset, crosstalk;
    /// readings carry the gain factor from then on if it is set. <= 20 ms.
    void begin_configure(const Settings& settings);
    /// The budget stays, and must be one that the new mode supports.
    void begin_set_distance_mode(DistanceMode mode);
    void begin_set_timing_budget(std::uint16_t budget_ms);
    /// `nominal * 1.075` of the part's own oscillator value; also for trimming it to what the part really
    /// does, finer than the milliseconds of `Settings`, for which reason the budget is not compared.
    void begin_set_inter_measurement(Microseconds nominal);
    void begin_set_sigma_limit(std::uint16_t quarter_mm);
    void begin_set_signal_limit(std::uint16_t mcps_9_7);
    void begin_set_offset(std::int16_t quarter_mm);
    void begin_set_crosstalk(std::uint16_t kcps_per_spad_7_9);
    void begin_set_interrupt_polarity(bool is_active_low);
    /// Interrupts only for ranges in a window. Whether the results are gated too is not documented.
    void begin_set_range_threshold(const RangeThreshold& threshold);
    /// Interrupts for every sample again, as after initialising.
    void begin_set_interrupt_on_every_sample();
    /// ST's SetROI: the size, with the centre put to the part's own optical centre, or to 199 for a side over
    /// 10.
    void begin_set_roi_size(std::uint8_t width, std::uint8_t height);
    void begin_set_roi_centre(std::uint8_t spad);
    /// Writes centre and, if it differs from the last one written, size of the region of interest. Allowed
    /// while ranging: it takes effect with the next range. One transfer, two for a new size without bursts.
    void begin_set_zone(const Roi& roi);

    // --- ranging
    /// Clears, then starts timed ranging.
    void begin_start();
    /// Clears, then starts one range.
    void begin_start_single();
    /// Stops after the current range: one more result may come.
    void begin_stop();
    /// Stops at once.
    void begin_abort();
    /// Polls data ready once, if it is ready reads the result block (twice if so set) and clears the
    /// interrupt; done with or without a measurement: see `has_measurement`. <= 5 ms. `confirms_ready`: if it
    /// is ready, asks once more, where nothing else would tell a bit flipped in one poll: of the first result
    /// of a run, and while little is known of when data becomes ready.
    void begin_read(bool confirms_ready = false);
    /// The last `begin_read` found data ready, and asked again not ready: one answer was altered, and nobody
    /// knows which.
    [[nodiscard]] bool have_polls_disagreed() const noexcept { return have_polls_disagreed_; }
    /// From such a `begin_read` until data was ready twice: what comes in between is doubt about when.
    [[nodiscard]] bool is_confirming_ready() const noexcept { return is_confirming_ready_; }
    /// Ranges once with a full search of the VHV voltage; for a part that was stopped while its temperature
    /// moved by more than 8 degrees. <= 1 s + one period; only while stopped.
    void begin_update_temperature();
    /// Reads 1 <= count <= 4 bytes at `index` for supervision; `register_bytes()` afterwards.
    void begin_read_register(reg::Index index, std::uint8_t count);

    // --- supervision
    /// Reads one of `kRegisterRuns` back and compares it with what was written since the configuration was
    /// loaded, and with the factory's offset; what else was not written it learns. A difference is read
    /// again; if it is still there, the end is `config_mismatch`: initialise the sensor. Also while ranging.
    /// One transfer, two if it differs, none if the verification is switched off: <= 3 ms.
    void begin_verify(std::size_t run);
    /// The same of what the last `begin_set_zone` wrote.
    void begin_verify_zone();

    // --- progress
    /// Advances the operation. `done` and `failed` are told once, then `idle`.
    [[nodiscard]] Progress poll(NodeTime now);
    /// The operation is over, and its end will not be told: for a part that was taken away. Not while a
    /// transfer is in flight.
    void abandon() noexcept { progress_ = Progress::idle; }
    /// From `begin_...` until its end has been told.
    [[nodiscard]] bool is_busy() const noexcept { return progress_ != Progress::idle; }
    /// After `failed`.
    [[nodiscard]] Error error() const noexcept { return error_; }
    /// Why the last transfer that failed did.
    [[nodiscard]] i2c::TransferError transfer_error() const noexcept { return transfer_error_; }
    /// The earliest time at which `poll` has something to do; empty if as soon as the bus is free.
    [[nodiscard]] std::optional<NodeTime> wake_time() const noexcept;

    // --- results; an operation that fails changes none of them
    /// The last `begin_read` ended well and found data ready.
    [[nodiscard]] bool has_measurement() const noexcept { return has_measurement_; }
    /// The newest one; `has_measurement` tells whether the last read brought it.
    [[nodiscard]] const Measurement& measurement() const noexcept { return reading_.measurement; }
    /// The poll that saw its data ready, told at this time; it was ready no later.
    [[nodiscard]] NodeTime ready_seen() const noexcept { return reading_.ready_seen; }
    /// The latest time at which it was surely not ready yet: the start of the transfer that found no data, or
    /// that cleared the interrupt. Empty if there was none.
    [[nodiscard]] std::optional<NodeTime> not_ready_seen() const noexcept { return reading_.not_ready_seen; }
    /// What the sensor's registers should hold, and which were found to differ.
    [[nodiscard]] const ReadBack& read_back() const noexcept { return read_back_; }
    /// The verification overlooks more than before.
    void forget_overlooked() noexcept { read_back_.forget_overlooked(); }
    /// What the last `begin_read_register` read.
    [[nodiscard]] std::span<const std::uint8_t> register_bytes() const noexcept {
        return std::span(register_bytes_).first(register_count_);
    }
    /// Whether measurements carry the gain factor.
    [[nodiscard]] bool applies_gain_factor() const noexcept { return settings_.applies_gain_factor; }
    /// What one step of the inter-measurement register makes of the period; empty before one was set.
    [[nodiscard]] std::optional<Nanoseconds> period_step() const noexcept {
        return vl53l1x::period_step(oscillator_);
    }
    [[nodiscard]] i2c::Address live_address() const noexcept { return live_address_; }
    /// Transfers that failed, retried ones included, and read-backs that a second one contradicted;
    /// saturates.
    [[nodiscard]] std::uint16_t i2c_error_count() const noexcept { return i2c_error_count_; }

  private:
    /// What the answer to a transfer means for the operation.
    enum class Verdict : std::uint8_t { proceed, repeat_stage, end };
    using Judge = Verdict (*)(Device&, NodeTime now);

    /// One transfer, or a run of equal ones at consecutive indices.
    struct Step {
        enum class Kind : std::uint8_t { read, write, write_defaults };
        Kind kind = Kind::read;
        reg::Index index = 0;
        std::uint8_t count = 0;      ///< bytes a transfer
        std::uint8_t transfers = 1;  ///< the index advances by one from each to the next
        std::array<std::uint8_t, 4> bytes{};
        Judge judge = nullptr;  ///< looks at the last answer; none: proceed
        /// For a silence that may be in order: says what to do if nobody acknowledges the address. `proceed`:
        /// try again. None: as any failure.
        Judge on_refused = nullptr;
    };

    /// A named part of an operation: it lines up its transfers when its turn comes. If a judge asks for it,
    /// it is repeated `every` so often `within` a time, and ends in `otherwise`.
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

    // The runner of tables (device.cpp).
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
    void follow(Verdict verdict, NodeTime now);
    void count_i2c_error() noexcept;
    Verdict fail(Error error);

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
    std::size_t stage_ = 0;  ///< the current one is the one before
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

    // What is known of the sensor.
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

    // What the operation is about to set or has read so far.
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
    RegisterRun run_;               ///< being verified
    bool is_run_of_write_ = false;  ///< just made
    bool is_run_steering_ = false;  ///< one of the steering groups, whole

    // Results.
    bool has_measurement_ = false;
    Reading reading_;
    std::array<std::uint8_t, 4> register_bytes_{};
    std::uint8_t register_count_ = 0;
};

}  // namespace octoskin::vl53l1x
