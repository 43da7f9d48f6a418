// A register-level model of a VL53L1X as a driver sees it over I2C, XSHUT and GPIO1. As strict as the public
// documents; the code names the source of each behaviour. Advanced lazily: every access has its time.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "hw/sim/i2c/i2c_target.hpp"
#include "hw/sim/vl53l1x/ranging_result.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"
#include "hw/sim/vl53l1x/register_map.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// A register that keeps its value at every write.
struct StuckRegister {
    std::uint16_t index = 0;
    std::uint8_t value = 0;
};

/// Faults of a part.
struct SensorFaults {
    bool is_absent = false;  ///< never acknowledges
    bool never_boots = false;
    bool has_wrong_id = false;
    bool ignores_xshut = false;    ///< the line is not wired: XSHUT is pulled up
    bool freezes_stream = false;   ///< the stream count stops advancing
    bool never_ready = false;      ///< ranges, but its interrupt never fires
    bool is_always_ready = false;  ///< its interrupt cannot be cleared
    std::optional<std::uint8_t>
        device_status{};  ///< every result carries this RESULT__RANGE_STATUS byte, high bits included
    std::optional<StuckRegister> stuck_register{};  ///< from its next write on
    Microseconds status_two_for{0};  ///< 0xE5 reads 0x02 for this time after boot, as observed on real parts
    std::uint32_t holds_sda_clocks = 0;  ///< holds SDA low until this number of clocks, or XSHUT
};

/// The true data of one finished ranging, for tests and for comparison with the node's reports.
struct RangingRecord {
    std::uint32_t index = 0;
    SimTime window_middle{};
    SimTime ready{};
    Roi roi{};  ///< in force when the range began
    RangingResult result{};
};

class SensorModel final : public I2cTarget {
  public:
    /// Starts powered, with XSHUT low.
    SensorModel(const SensorPart& part, RangingScene scene);

    void set_xshut(bool is_high, SimTime time);
    void set_faults(const SensorFaults& faults) { faults_ = faults; }
    [[nodiscard]] const SensorFaults& faults() const noexcept { return faults_; }
    /// A dip of the supply: all state is lost and, with XSHUT high, the part boots at 0x29.
    void brown_out(SimTime time);

    /// A register changes by itself, as by radiation or a misdirected write.
    void alter_register(std::uint16_t index, std::uint8_t value) { registers_.at(index) = value; }

    /// Level of the GPIO1 pin.
    [[nodiscard]] bool gpio1_level(SimTime time);
    /// The next time after `now` at which it boots, or begins or ends a ranging. Empty if never.
    [[nodiscard]] std::optional<SimTime> next_event(SimTime now) const;
    /// Number of reads of the data-ready status (0x31).
    [[nodiscard]] std::uint64_t poll_count() const noexcept { return poll_count_; }
    /// Number of forbidden writes: a start or an abort during a ranging, and a changed period between start
    /// and stop, counted per byte (UM2356 2.5.2). A start without effect is not counted.
    [[nodiscard]] std::uint32_t disturbance_count() const noexcept { return disturbance_count_; }
    /// Finishes the rangings that end by `time`.
    void advance(SimTime time);
    /// The newest finished rangings, oldest first, at most 64.
    [[nodiscard]] const std::deque<RangingRecord>& history() const noexcept { return history_; }
    [[nodiscard]] const Registers& registers() const noexcept { return registers_; }

    bool on_start(std::uint8_t address, bool is_read, SimTime time) override;
    bool on_write(std::uint8_t byte, SimTime time) override;
    std::uint8_t on_read(SimTime time) override;
    void on_stop(SimTime time) override;
    bool holds_sda(SimTime time) override;
    void on_clocks(std::uint32_t count, SimTime time) override;

  private:
    enum class Power : std::uint8_t { shut_down, booting, soft_reset, running };
    enum class Mode : std::uint8_t { idle, timed, single, back_to_back, waiting_for_clear };
    struct Ranging {
        SimTime start{};
        bool is_latched = false;  ///< has begun: the following values are from the registers at that time
        RangingTiming timing{};
        RangingConfig config{};
        std::optional<RangingReturn> seen{};  ///< once its window is over
        Microseconds extra{0};                ///< set with `seen`: the time it takes beyond its window
        [[nodiscard]] SimTime window() const { return {start.us + timing.overhead.count()}; }
        [[nodiscard]] SimTime window_end() const { return {window().us + timing.budget.count()}; }
        [[nodiscard]] SimTime window_middle() const { return {window().us + timing.budget.count() / 2}; }
        [[nodiscard]] SimTime end() const { return {window_end().us + extra.count()}; }
    };

    void boot(SimTime time);
    void load_registers();
    [[nodiscard]] SimTime loaded_at() const { return {booted_at_.us + part_.traits.boot_load.count()}; }
    void write_register(std::uint16_t index, std::uint8_t value, SimTime time);
    void write_soft_reset(std::uint8_t value, SimTime time);
    void write_interrupt_clear(std::uint8_t value, SimTime time);
    void start_mode(std::uint8_t value, SimTime time);
    void latch_ranging();
    void look();
    void finish_ranging();
    void schedule_next(const Ranging& finished);
    void step_stream_count();
    [[nodiscard]] bool pin_level() const;

    SensorPart part_;
    RangingScene scene_;
    SensorFaults faults_;
    Registers registers_{};
    Power power_ = Power::shut_down;
    SimTime booted_at_{};
    bool is_loaded_ = false;
    Mode mode_ = Mode::idle;
    bool stops_after_this_ = false;
    std::optional<Ranging> ranging_;
    std::uint32_t ranging_index_ = 0;
    std::uint8_t stream_count_ = 0;
    bool is_first_of_run_ = true;
    bool is_held_ = false;  ///< a group of parameters is being changed: no result is written
    SimTime soft_reset_since_{};
    bool is_interrupt_asserted_ = false;
    std::uint16_t index_ = 0;
    std::uint8_t index_bytes_ = 0;
    std::uint64_t poll_count_ = 0;
    std::uint32_t disturbance_count_ = 0;
    std::deque<RangingRecord> history_;
};

}  // namespace octoskin::sim
