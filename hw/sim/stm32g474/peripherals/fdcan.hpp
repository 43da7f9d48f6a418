// FDCAN1 (RM0440 44): modes, bit timing, filters, FIFOs, error counting, bus-off, bus monitoring; the
// restricted mode only as the result of a message RAM failure. The test modes are not modelled.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <optional>

#include "hw/sim/stm32g474/nets/can_link.hpp"
#include "hw/sim/stm32g474/peripheral.hpp"
#include "hw/sim/stm32g474/peripherals/fdcan_ram.hpp"
#include "hw/sim/stm32g474/register_bank.hpp"

namespace octoskin::sim::stm32 {

class Fdcan final : public Peripheral {
  public:
    struct Hooks {
        std::function<std::uint32_t()> kernel_hz;
        std::function<bool()> is_clock_from_crystal;
        std::function<bool()> has_pins;
    };
    /// `rates`: bit rates of the bus; other settings are reported and behave as a broken link.
    Fdcan(const Surroundings& surroundings, FdcanRam& ram, CanBusSide& bus, const wire::BitRates& rates,
          Hooks hooks);

    [[nodiscard]] std::string_view name() const override { return "FDCAN1"; }
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    void reset() override;
    void advance() override;
    [[nodiscard]] BoardTime next_event() const override;

    // --- the bus's side
    void set_link(CanLink link);
    /// The offered frame, or the one offered until just before, has begun: it can no longer be withdrawn.
    void on_started(const wire::CanFrame& frame);
    /// The frame that began ended without an error.
    void on_sent(const wire::CanFrame& frame);
    /// The frame that began was destroyed by an error on the bus.
    void on_disturbed();
    void on_received(const wire::CanFrame& frame);
    [[nodiscard]] bool is_bus_off() const noexcept { return is_bus_off_; }

    // --- for tests
    /// The message RAM does not answer in time, once.
    void lose_ram();
    /// While set, INIT does not follow the written value: the controller does not start.
    void set_deaf(bool is_deaf) { is_deaf_ = is_deaf; }

  private:
    static constexpr std::uint32_t kPlaces = FdcanRam::kFifoElements;
    struct RxFifo {
        std::uint32_t fill = 0;
        std::uint32_t get = 0;
        std::uint32_t put = 0;
        bool has_lost = false;
    };
    struct FilterMatch {
        int fifo = -1;  ///< none: rejected
        int filter = -1;
    };

    [[nodiscard]] bool is_set(std::uint32_t offset, std::uint32_t bit) const {
        return (bank_.get(offset) >> bit & 1U) != 0;
    }
    [[nodiscard]] bool is_configurable() const;
    [[nodiscard]] bool is_on_bus() const;
    [[nodiscard]] std::uint32_t nominal_bitrate() const;
    [[nodiscard]] std::uint32_t data_bitrate() const;
    [[nodiscard]] std::int64_t bits_ps(std::uint32_t bits) const;

    void write_mode(std::uint32_t value);
    void begin_operation();
    void check_bit_timing();
    void check_delay_compensation();
    void clear_for_configuration();
    void request(std::uint32_t places);
    void check_order(const wire::CanFrame& requested);
    [[nodiscard]] std::optional<std::uint32_t> place_of(const wire::CanFrame& frame) const;
    void cancel(std::uint32_t places);
    void acknowledge_rx(RxFifo& fifo, std::uint32_t index, const char* what);
    [[nodiscard]] std::uint32_t tx_status() const;
    [[nodiscard]] std::uint32_t rx_status(const RxFifo& fifo) const;
    [[nodiscard]] std::uint32_t event_status() const;
    [[nodiscard]] std::uint32_t read_protocol_status();
    [[nodiscard]] std::uint32_t error_counters() const;
    [[nodiscard]] std::optional<std::uint32_t> next_place() const;
    void update_offer();
    void finish(std::uint32_t place, bool is_sent);
    void fail_attempt();
    void count_errors(int transmit, int receive);
    void enter_bus_off();
    void on_overheard(const wire::CanFrame& frame);
    void store(const wire::CanFrame& frame);
    [[nodiscard]] FilterMatch judge(const wire::CanFrame& frame) const;
    [[nodiscard]] FilterMatch judge_standard(std::uint32_t id) const;
    [[nodiscard]] FilterMatch judge_extended(std::uint32_t id) const;
    [[nodiscard]] std::uint16_t timestamp() const;
    void raise(std::uint32_t flags);
    void update_lines();

    Surroundings env_;
    FdcanRam& ram_;
    CanBusSide& bus_;
    wire::BitRates rates_;
    Hooks hooks_;
    RegisterBank bank_;

    CanLink link_ = CanLink::good;
    bool has_wrong_timing_ = false;
    bool has_wrong_data_timing_ = false;
    BoardTime joins_at_ = kNever;  ///< 11 recessive bits, or 129 times that after bus-off
    BoardTime init_follows_at_ = kNever;
    BoardTime attempt_fails_at_ = kNever;
    bool is_joined_ = false;
    bool is_bus_off_ = false;
    bool is_deaf_ = false;
    int transmit_errors_ = 0;
    int receive_errors_ = 0;
    std::uint32_t last_error_ = 7;
    std::uint32_t pending_ = 0;  ///< TXBRP
    std::uint32_t cancelling_ = 0;
    std::deque<std::uint32_t> order_;  ///< of requests
    std::uint32_t put_ = 0;
    std::optional<std::uint32_t> offered_;
    bool has_started_ = false;
    std::array<RxFifo, 2> rx_{};
    RxFifo events_{};
    BoardTime timestamp_zero_{};
};

}  // namespace octoskin::sim::stm32
