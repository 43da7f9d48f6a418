// The NUCLEO-G474RE with the sensor carrier: chip, crystal, four I2C buses, XSHUT lines, CAN, the virtual COM
// port and the light. Pins: docs/hardware/wiring.md, hw/boards.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/image/elf_image.hpp"
#include "hw/sim/data_ready/data_ready_line.hpp"
#include "hw/sim/stm32g474/cpu/cortex_m4.hpp"
#include "hw/sim/stm32g474/nets/shift_register_chain.hpp"
#include "hw/sim/stm32g474/peripherals/exti.hpp"
#include "hw/sim/stm32g474/peripherals/fdcan.hpp"
#include "hw/sim/stm32g474/peripherals/flash_interface.hpp"
#include "hw/sim/stm32g474/peripherals/gpio.hpp"
#include "hw/sim/stm32g474/peripherals/i2c.hpp"
#include "hw/sim/stm32g474/peripherals/iwdg.hpp"
#include "hw/sim/stm32g474/peripherals/lpuart.hpp"
#include "hw/sim/stm32g474/peripherals/plain_registers.hpp"
#include "hw/sim/stm32g474/peripherals/pwr.hpp"
#include "hw/sim/stm32g474/peripherals/rcc.hpp"
#include "hw/sim/stm32g474/peripherals/syscfg.hpp"
#include "hw/sim/stm32g474/peripherals/timer2.hpp"
#include "hw/sim/stm32g474/system_bus.hpp"

namespace octoskin::sim::stm32 {

using image::ElfImage;

inline constexpr std::uint32_t kConfigurationPage = 0x0807'F800;  ///< the last page of flash

struct NucleoOptions {
    Crystal crystal{};
    double drift_ppm = 0.0;  ///< of all the board's clocks relative to true time
    std::uint32_t lsi_hz = 32'000;
    std::uint32_t cycles_per_instruction = 1;
    BusEdges edges = BusEdges::typical;
    wire::BitRates bit_rates{};
    std::array<std::uint8_t, 12> unique_id{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    /// Address of 8 bytes of flash whose check bits do not fit (a write of them was cut short): each read of
    /// them is a double error.
    std::optional<std::uint32_t> damaged_flash{};
    std::uint64_t seed = 1;  ///< of the RAM content at power-up
};

class NucleoBoard final : private InterruptLines, private CanBusSide {
  public:
    static constexpr std::size_t kI2cBuses = 4;

    /// Powered at true time 0. `configuration` goes to its page of flash; empty leaves the page erased.
    NucleoBoard(const NucleoOptions& options, const ElfImage& image,
                std::span<const std::uint8_t> configuration);
    ~NucleoBoard();

    /// Runs the program up to `time`, or to the end of the basic block that reaches it.
    void run_until(SimTime time);
    [[nodiscard]] SimTime now() const { return true_time(now_); }
    [[nodiscard]] BoardTime board_time() const noexcept { return now_; }
    /// The true time of an instant of the board's clock.
    [[nodiscard]] SimTime true_time(BoardTime time) const;
    [[nodiscard]] BoardTime to_board_time(SimTime time) const;
    /// The user presses the reset button.
    void press_reset() { reset(ResetFlag::pin); }
    /// Power off and on: RAM is lost.
    void cycle_power();

    [[nodiscard]] I2cWire& wire(std::size_t bus) { return wires_.at(bus); }
    /// The line at the bus's data-ready input. A fault of it applies from the next sample on.
    [[nodiscard]] DataReadyLine& data_ready(std::size_t bus) { return data_ready_.at(bus); }
    [[nodiscard]] std::int64_t i2c_busy_ps(std::size_t bus) const { return i2c_.at(bus)->busy_ps(); }
    /// `listener` is called for each XSHUT line that changes: 0 to 39 are the chain's outputs, 40 to 47 pins
    /// with a pull-up each.
    void on_xshut(ShiftRegisterChain::Listener listener) { on_xshut_ = std::move(listener); }
    [[nodiscard]] bool is_xshut_high(std::uint32_t line) const;
    /// Called at every change of the frame that the CAN controller offers next.
    void on_offer(std::function<void(const std::optional<wire::CanFrame>&)> listener) {
        on_offer_ = std::move(listener);
    }
    [[nodiscard]] Fdcan& can() noexcept { return *fdcan_; }
    [[nodiscard]] bool is_led_lit() const { return ports_[0]->drives_high(5); }
    [[nodiscard]] const std::string& serial_text() const noexcept { return serial_text_; }
    [[nodiscard]] const Timer2& timer2() const noexcept { return *timer2_; }

    [[nodiscard]] ViolationLog& log() noexcept { return log_; }
    [[nodiscard]] const CortexM4& core() const noexcept { return *core_; }
    void forget_longest_awake() { core_->forget_longest_awake(); }
    [[nodiscard]] const ElfImage& image() const noexcept { return image_; }
    [[nodiscard]] std::uint32_t reset_count() const noexcept { return reset_count_; }
    [[nodiscard]] std::uint32_t ram_word(std::uint32_t address) const;
    /// For tests: the core continues at `symbol`.
    void jump(const std::string& symbol);
    void jump(std::uint32_t address) { core_->jump(address); }
    /// For tests: replaces instructions in flash and returns the previous ones.
    std::vector<std::uint16_t> patch(std::uint32_t address, const std::vector<std::uint16_t>& instructions);
    /// For tests: a write as by a debugger.
    void poke(std::uint32_t address, std::uint32_t value) { bus_->write(address, value, 4); }
    void refuse_pll() { rcc_->refuse_pll(); }

  private:
    struct Pin {
        std::uint32_t port;  ///< 0 is A
        std::uint32_t number;
    };
    struct I2cPins {
        Pin scl;
        Pin sda;
        std::uint32_t function;
    };
    static const std::array<I2cPins, kI2cBuses> kI2cPins;
    static const std::array<Pin, 8> kXshutPins;

    void load(const ElfImage& image, std::span<const std::uint8_t> configuration);
    void fill_ram(std::uint64_t seed);
    void make_peripherals(const NucleoOptions& options);
    void make_external_interrupts(const Surroundings& env);
    void place_peripherals();
    void connect_pins();
    void reset(ResetFlag flag);
    void drive_chain();
    void drive_xshut_pins();
    void drive_i2c(std::size_t bus);
    [[nodiscard]] bool has_function(const Pin& pin, std::uint32_t function) const;
    [[nodiscard]] BoardTime next_pin_change(std::uint32_t lines) const;
    void after_clock_change();

    void set_line(std::uint32_t irq, bool is_high) override;
    void pend_nmi() override;
    void offer(const std::optional<wire::CanFrame>& frame) override;

    BoardTime now_{};
    ViolationLog log_{now_};
    double rate_;  ///< board seconds per true second
    ElfImage image_;
    std::vector<std::uint8_t> flash_;
    std::vector<std::uint8_t> ram_;
    std::vector<std::uint8_t> system_memory_;

    std::array<I2cWire, kI2cBuses> wires_{};
    std::array<DataReadyLine, kI2cBuses> data_ready_{};
    std::unique_ptr<SystemControl> control_;
    std::unique_ptr<Rcc> rcc_;
    std::unique_ptr<Pwr> pwr_;
    std::unique_ptr<FlashInterface> flash_interface_;
    std::array<std::unique_ptr<GpioPort>, 7> ports_{};
    std::unique_ptr<Timer2> timer2_;
    std::unique_ptr<Iwdg> iwdg_;
    std::unique_ptr<Lpuart> lpuart_;
    std::array<std::unique_ptr<I2c>, kI2cBuses> i2c_{};
    std::unique_ptr<FdcanRam> fdcan_ram_;
    std::unique_ptr<Fdcan> fdcan_;
    std::unique_ptr<Syscfg> syscfg_;
    std::unique_ptr<Exti> exti_;
    std::unique_ptr<PlainRegisters> debug_;
    std::unique_ptr<SystemBus> bus_;
    std::unique_ptr<CortexM4> core_;
    std::unique_ptr<ShiftRegisterChain> chain_;
    std::array<bool, 8> xshut_pin_levels_{};

    ShiftRegisterChain::Listener on_xshut_;
    std::function<void(const std::optional<wire::CanFrame>&)> on_offer_;
    std::string serial_text_;
    std::optional<ResetFlag> wanted_reset_;
    std::uint32_t reset_count_ = 0;
};

}  // namespace octoskin::sim::stm32
